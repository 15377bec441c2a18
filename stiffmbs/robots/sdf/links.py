"""Masses and inertias of the links of SDFormat files."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...elements.spatial.marker import ORIGIN
from ...elements.spatial.orientation import matrix
from ...reading.files.xml_nodes import Node
from ..robot import RobotFault
from .poses import flag, number, pose_of
from .scopes import Scope
from .solids import of_shapes

PRODUCTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
OFF = ("self_collide", "enable_wind", "kinematic", "must_be_base_link")
"""Flags of a link without effect if they are false."""


@dataclass(frozen=True)
class Body:
    """Mass, kg, centre of mass, m, and inertia about it, kg m^2, in the frame of a link.

    `lifted`: fraction of its weight that does not act. `assumed`: True if the file gives no mass or inertia.
    """

    mass: float = 1.0
    center_of_mass: tuple[float, ...] = ORIGIN
    inertia: np.ndarray | None = None
    lifted: float = 0.0
    assumed: bool = False


def body_of(where: str, name: str, link: Node, scope: Scope) -> Body:
    """Return the mass and inertia of a ``<link>``; 1 kg and 1 kg m^2 are the format's defaults."""
    link.without_effect(*(tag for tag in OFF if link.unrecorded(tag) in ("0", "false")))
    lifted = 0.0 if flag(where, link, "gravity", True) else 1.0
    inertial = link.find("inertial")
    if inertial is None:
        return Body(inertia=np.eye(3), lifted=lifted, assumed=True)
    if (inertial.get("auto") or "").lower() in ("1", "true"):
        mass, centre, tensor = of_shapes(where, name, link, inertial, scope)
        return Body(mass, tuple(map(float, centre)), tensor, lifted)
    pose = pose_of(where, inertial.find("pose"))
    mass = number(where, inertial, "mass", 1.0)
    if mass < 0:
        raise RobotFault(f"{where}: found a mass of {mass:g}, expected 0 or more")
    moments = inertial.find("inertia")
    xx, xy, xz, yy, yz, zz = (number(where, moments, key, float(key[1] == key[2])) for key in PRODUCTS)
    A = matrix(pose.orientation)
    with np.errstate(over="ignore", invalid="ignore"):  # moments that are not finite are refused with the body
        tensor = A @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ A.T
        tensor = (tensor + tensor.T) / 2
    return Body(mass, pose.position, tensor, lifted, assumed=moments is None or inertial.find("mass") is None)
