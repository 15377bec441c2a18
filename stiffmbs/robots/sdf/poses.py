"""Poses of frames in other frames, and their text in SDFormat files."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ...elements.spatial.marker import ORIGIN
from ...elements.spatial.orientation import IDENTITY, ROUGH, Quaternion, about, conjugate, product, rotated
from ...reading.files.quoted import quoted
from ...reading.files.xml_nodes import Node
from ..robot import RobotFault

EULER, QUATERNION = "euler_rpy", "quat_xyzw"
"""Values of the attribute ``rotation_format``."""


@dataclass(frozen=True)
class Pose:
    """Frame in another one: its origin, m, and its orientation."""

    position: tuple[float, ...] = ORIGIN
    orientation: Quaternion = IDENTITY

    def on(self, inner: Pose) -> Pose:
        """Return the pose of a frame that is given in this one."""
        turned = np.array(self.position) + rotated(self.orientation, inner.position)
        return Pose(tuple(map(float, turned)), product(self.orientation, inner.orientation))

    def inverse(self) -> Pose:
        """Return the pose of the other frame in this one."""
        back = conjugate(self.orientation)
        return Pose(tuple(map(float, -rotated(back, self.position))), back)


HERE = Pose()


def text_of(node: Node | None) -> str:
    """Return the text of an element; empty if it is missing."""
    return "" if node is None else node.text


def numbers(where: str, what: str, text: str, count: int = 3) -> list[float]:
    """Return the finite numbers of a text; raises RobotFault if their count is another one."""
    try:
        found = [float(word) for word in text.split()]
    except ValueError:
        found = []
    if len(found) != count or not np.all(np.isfinite(found)):
        expected = "a finite number" if count == 1 else f"{count} finite numbers"
        raise RobotFault(f"{where}: found '{quoted(text)}' in <{what}>, expected {expected}")
    return found


def number(where: str, node: Node | None, tag: str, default: float) -> float:
    """Return the finite number in a child element, or the default if there is none."""
    text = text_of(None if node is None else node.find(tag))
    return numbers(where, tag, text, 1)[0] if text else default


def flag(where: str, node: Node, tag: str, default: bool = False) -> bool:
    """Return the truth value in a child element."""
    text = text_of(node.find(tag)).lower()
    if text not in ("", "0", "1", "true", "false"):
        raise RobotFault(f"{where}: found '{quoted(text)}' in <{tag}>, expected true or false")
    return text in ("1", "true") if text else default


def pose_of(where: str, pose: Node | None) -> Pose:
    """Return the pose in a ``<pose>`` element: Euler angles about the fixed axes x, y and z, or a quaternion."""
    if pose is None:
        return HERE
    form, degrees = pose.get("rotation_format") or EULER, pose.get("degrees") or "false"
    if form not in (EULER, QUATERNION):
        raise RobotFault(f"{where}: found rotation_format='{quoted(form)}' of <pose>, expected {EULER} or {QUATERNION}")
    if not pose.text:
        return HERE
    found = numbers(where, "pose", pose.text, 6 if form == EULER else 7)
    return Pose(tuple(found[:3]), _turned(where, form, found[3:], degrees.lower() in ("1", "true")))


def _turned(where: str, form: str, found: list[float], degrees: bool) -> Quaternion:
    if form == EULER:
        roll, pitch, yaw = (math.radians(angle) if degrees else angle for angle in found)
        return product(product(about(2, yaw), about(1, pitch)), about(0, roll))
    length = math.hypot(*found)
    if abs(length - 1) > ROUGH:
        raise RobotFault(f"{where}: found a quaternion of length {length:g} in <pose>, expected one of length 1")
    x, y, z, w = (part / length for part in found)
    return w, x, y, z
