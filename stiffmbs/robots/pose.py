"""Forward kinematics of a robot: poses of the links from joint coordinates."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from ..elements.spatial.orientation import IDENTITY, product, rotated
from .robot import Link, LinkJoint, Robot


@dataclass(frozen=True)
class Placed:
    """Frame in the world with its velocity.

    `position` of shape (3,): m. `orientation`: quaternion, scalar first. `velocity`, `omega` of shape (3,): velocity of
    its origin, m/s, and angular velocity, rad/s; both in ground axes.
    """

    position: np.ndarray
    orientation: tuple[float, ...]
    velocity: np.ndarray
    omega: np.ndarray

    def point(self, local: tuple[float, ...]) -> np.ndarray:
        """Return a point of the frame in the world, m."""
        return self.position + rotated(self.orientation, local)

    def velocity_at(self, point: np.ndarray) -> np.ndarray:
        """Return the velocity of a point that moves with the frame, m/s."""
        return self.velocity + np.cross(self.omega, point - self.position)


WORLD = Placed(np.zeros(3), IDENTITY, np.zeros(3), np.zeros(3))


def frames(robot: Robot, coordinates: Mapping[str, float], rates: Mapping[str, float]) -> dict[str, tuple[Placed, ...]]:
    """Return the frames of each link: on its parent, then after each of its joints; the last is the link's own.

    `coordinates`, `rates`: coordinates of hinges and slides by name, rad or m, and their rates; missing ones are as
    drawn, and at rest.
    """
    found: dict[str, tuple[Placed, ...]] = {}
    for link in robot.links:
        carrier = WORLD if link.parent is None else found[link.parent][-1]
        found[link.name] = tuple(_along(link, _carried(link, carrier), coordinates, rates))
    return found


def _carried(link: Link, carrier: Placed) -> Placed:
    position = carrier.point(link.position)
    return Placed(
        position, product(carrier.orientation, link.orientation), carrier.velocity_at(position), carrier.omega
    )


def _along(link: Link, start: Placed, coordinates: Mapping[str, float], rates: Mapping[str, float]) -> Iterator[Placed]:
    frame = start
    yield frame
    for joint in link.joints:
        frame = _moved(frame, joint, coordinates.get(joint.name, joint.zero) - joint.zero, rates.get(joint.name, 0.0))
        yield frame


def _moved(frame: Placed, joint: LinkJoint, s: float, rate: float) -> Placed:
    """Return the frame after a joint, with its coordinate s relative to its zero, m or rad, and its rate."""
    axis = rotated(frame.orientation, joint.axis)
    if joint.kind == "slide":
        position = frame.position + s * axis
        return Placed(position, frame.orientation, frame.velocity_at(position) + rate * axis, frame.omega)
    if not joint.is_rotary:
        return frame
    turn = (np.cos(s / 2), *(np.sin(s / 2) * np.array(joint.axis)))
    orientation, anchor = product(frame.orientation, turn), frame.point(joint.point)
    lead = joint.pitch / (2 * np.pi)
    arm = -rotated(orientation, joint.point)
    omega = frame.omega + rate * axis
    advance = lead * s * axis
    velocity = frame.velocity_at(anchor + advance) + lead * rate * axis + np.cross(omega, arm)
    return Placed(anchor + advance + arm, orientation, velocity, omega)
