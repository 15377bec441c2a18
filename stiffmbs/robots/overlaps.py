"""Overlaps of the shapes of a robot at the start."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..elements.spatial.orientation import matrix
from .contact import BOX, CAPSULE, CYLINDER, PLANE, Shape
from .pose import WORLD, frames
from .robot import Robot


class Overlaps:
    """Depths by which shapes overlap at given coordinates."""

    def __init__(self, robot: Robot, coordinates: Mapping[str, float]) -> None:
        placed = frames(robot, coordinates, {})
        self._frames = {None: WORLD} | {name: each[-1] for name, each in placed.items()}

    def of(self, first: Shape, second: Shape) -> float:
        """Return the depth by which two shapes between which there is a contact overlap, m; negative if they are apart.

        `second`: a plane, or a solid with `first` a sphere or capsule.
        """
        at, axes = self._placed(first)
        base, turned = self._placed(second)
        local = turned.T @ (at - base)
        if second.kind == PLANE:
            return _reach(first, axes.T @ turned[:, 2]) - float(local[2])
        if second.kind == BOX:
            return first.size[0] - _length(np.maximum(np.abs(local) - np.array(second.size) / 2.0, 0.0))
        if second.kind == CYLINDER:
            across, along = float(np.hypot(local[0], local[1])), float(abs(local[2]))
            outside = np.array([across - second.size[0], along - second.size[1] / 2.0])
            return first.size[0] - _length(np.maximum(outside, 0.0))
        return first.size[0] + second.size[0] - _between(first, second, local, turned.T @ axes[:, 2])

    def _placed(self, shape: Shape) -> tuple[np.ndarray, np.ndarray]:
        """Return the middle of a shape in the world, m, and its axes as columns."""
        frame = self._frames[shape.link]
        return frame.point(shape.position), np.array(matrix(frame.orientation)) @ np.array(matrix(shape.orientation))


def _reach(shape: Shape, normal: np.ndarray) -> float:
    """Return the distance of a shape's middle from a plane that it touches, with the normal along its axes."""
    size = np.array(shape.size)
    if shape.kind == BOX:
        return float(np.abs(normal) @ size) / 2.0
    if shape.kind == CYLINDER:
        return float(size[0] * np.hypot(normal[0], normal[1]) + size[1] / 2.0 * abs(normal[2]))
    return _length(normal * size)


def _between(first: Shape, second: Shape, local: np.ndarray, axis: np.ndarray) -> float:
    """Return the distance of the axes of two capsules or spheres, in the axes of the second one."""
    half, other = (shape.size[1] / 2.0 if shape.kind == CAPSULE else 0.0 for shape in (first, second))
    lean, along = float(axis[2]), float(axis @ local)
    apart = 1.0 - lean**2
    s = float(np.clip((lean * local[2] - along) / apart, -half, half)) if apart > 0.0 else 0.0
    t = float(np.clip(lean * s + local[2], -other, other))
    s = float(np.clip(lean * t - along, -half, half))
    return _length(local + s * axis - np.array([0.0, 0.0, t]))


def _length(offset: np.ndarray) -> float:
    return float(np.linalg.norm(offset))
