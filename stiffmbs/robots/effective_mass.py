"""Effective masses of the links of a robot against a force on them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from ..elements.spatial.orientation import matrix, rotated
from .pose import Placed, frames
from .robot import Link, LinkJoint, Robot

Column = tuple[int, np.ndarray, np.ndarray, np.ndarray]
"""Index of a joint rate; angular velocity of a link for the unit rate, its point at rest or on the axis, m, and the velocity there."""


def inverse_masses(robot: Robot, coordinates: Mapping[str, float]) -> dict[str | None, float]:
    """Return the acceleration of each link's centre of mass by a unit force there, averaged over directions, 1/kg.

    It is a third of the trace of J M^-1 J^T at the given coordinates. M is the mass matrix of the tree, and J the
    Jacobian of the point. Couplings, loops and contacts are ignored, as in MuJoCo's ``body_invweight0``.
    """
    placed, columns, armatures = frames(robot, coordinates, {}), dict[str, list[Column]](), list[float]()
    for link in robot.links:
        own: list[Column] = []
        for joint, frame in zip(link.joints, placed[link.name], strict=False):
            for omega, point, velocity in _rates(joint, frame):
                own.append((len(armatures), omega, point, velocity))
                armatures.append(joint.armature)
        columns[link.name] = [*columns.get(link.parent or "", ()), *own]
    M, at_centre = np.diag(armatures), {}
    for link in robot.links:
        J, turning = _jacobian(columns[link.name], placed[link.name][-1], link, len(armatures))
        M += link.mass * J.T @ J + turning.T @ link.inertia @ turning
        at_centre[link.name] = J
    # The solution of least squares ignores joints that move no mass.
    inverse = np.linalg.lstsq(M, np.eye(len(M)), rcond=None)[0] if armatures else M
    return {None: 0.0} | {name: float(np.sum((J @ inverse) * J)) / 3.0 for name, J in at_centre.items()}


def _jacobian(columns: list[Column], frame: Placed, link: Link, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the Jacobians of a link's centre of mass, and of its angular velocity in its axes."""
    J, turning = np.zeros((3, count)), np.zeros((3, count))
    centre, own = frame.point(link.center_of_mass), np.array(matrix(frame.orientation)).T
    for index, omega, point, velocity in columns:
        J[:, index] = velocity + np.cross(omega, centre - point)
        turning[:, index] = own @ omega
    return J, turning


def _rates(joint: LinkJoint, frame: Placed) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Yield the angular velocity, a point, and its velocity, for each unit rate of a joint; its link's frame before it is given."""
    axis, point, still = np.array(rotated(frame.orientation, joint.axis)), frame.point(joint.point), np.zeros(3)
    if joint.kind == "slide":
        yield still, point, axis
    elif joint.is_rotary:
        yield axis, point, axis * joint.pitch / (2.0 * np.pi)
    else:
        yield from ((direction, point, still) for direction in np.eye(3))
        if joint.kind == "free":
            yield from ((still, point, direction) for direction in np.eye(3))
