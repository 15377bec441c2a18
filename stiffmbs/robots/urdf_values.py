"""Numbers and poses in the attributes of URDF files."""

from __future__ import annotations

import numpy as np

from ..elements.spatial.marker import ORIGIN
from ..elements.spatial.orientation import IDENTITY, about, product
from ..reading.files.xml_nodes import Node
from .robot import RobotFault


def origin(where: str, element: Node) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return position and orientation of an <origin>: roll, pitch and yaw about the fixed axes x, y and z."""
    found = element.find("origin")
    if found is None:
        return ORIGIN, IDENTITY
    roll, pitch, yaw = numbers(where, "rpy", found.get("rpy") or "0 0 0")
    turned = product(product(about(2, yaw), about(1, pitch)), about(0, roll))
    return tuple(numbers(where, "xyz", found.get("xyz") or "0 0 0")), turned


def numbers(where: str, key: str, text: str) -> list[float]:
    """Return the three finite numbers in the text of an attribute."""
    try:
        found = [float(word) for word in text.split()]
    except ValueError:
        found = []
    if len(found) != 3 or not np.all(np.isfinite(found)):
        raise RobotFault(f"{where}: found {key}='{text}', expected three numbers")
    return found


def value_of(where: str, element: Node | None, key: str, default: float) -> float:
    """Return the finite number in an attribute, or the default if there is none."""
    text = None if element is None else element.get(key)
    if text is None:
        return default
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not np.isfinite(value):
        raise RobotFault(f"{where}: found {key}='{text}', expected a number")
    return value
