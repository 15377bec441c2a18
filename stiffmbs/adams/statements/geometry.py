"""Frames of parts and markers."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from .arguments import Arguments

IDENTITY = np.eye(3)
ROUNDING = 1e-9
"""Relative difference of lengths, and sine or cosine of an angle, that counts as rounding."""
PRECISION = 1e-6
"""Relative precision of a dataset's numbers, which are often written with few digits."""


@dataclass(frozen=True, eq=False)
class Frame:
    """Point and axes relative to an outer frame."""

    point: np.ndarray  # m, shape (3,)
    axes: np.ndarray  # shape (3, 3): x, y and z axis as columns

    def within(self, outer: Frame) -> Frame:
        """Return this frame, given relative to `outer`, in the axes to which `outer` refers."""
        return Frame(outer.point + outer.axes @ self.point, outer.axes @ self.axes)

    def seen_from(self, other: Frame) -> Frame:
        """Return this frame relative to another one; both refer to the same axes."""
        return Frame(other.axes.T @ (self.point - other.point), other.axes.T @ self.axes)


def read_frame(found: Arguments, origin: str, x_point: str, z_point: str, length: float) -> Frame:
    """Return the frame of a statement, given by a point and Euler angles, or by points on its axes.

    `origin`, `x_point`, `z_point`: names of the three points: QP, XP, ZP of a marker, QG, XG, ZG of a part. `length`:
    the dataset's unit of length, m. Raises DatasetFault if both angles and points are given, or points coincide with
    the origin or are collinear with it.
    """
    point = np.array(found.numbers(origin, 3) or (0.0, 0.0, 0.0)) * length
    angles = found.numbers("REULER", 3)
    given = [name for name in (x_point, z_point) if name in found]
    if angles is not None and given:
        raise found.fault(f"found REULER and {given[0]}, expected one or the other", given[0])
    if angles is not None:
        return Frame(point, _turned(angles[0], 2) @ _turned(angles[1], 0) @ _turned(angles[2], 2))
    offsets = {name: np.array(found.numbers(name, 3)) * length - point for name in given}
    for name, offset in offsets.items():
        if not np.linalg.norm(offset) > 0:
            raise found.fault(f"found {name} at {origin}, expected a point apart from it", name)
    if not offsets:
        return Frame(point, IDENTITY)
    x, z = offsets.get(x_point), offsets.get(z_point)
    axes = _from_x(x, z) if "USEXP" in found and x is not None else _from_z(z, x)
    if axes is None:
        raise found.fault(f"found {' and '.join(given)} on one line with {origin}, expected a point off that line")
    return Frame(point, axes)


def _turned(angle: float, about: int) -> np.ndarray:
    """Return axes rotated about one of their own by an angle."""
    axes, (i, j), (c, s) = np.eye(3), ((about + 1) % 3, (about + 2) % 3), _cos_and_sin(angle)
    axes[i, i], axes[i, j], axes[j, i], axes[j, j] = c, -s, s, c
    return axes


def _cos_and_sin(angle: float) -> tuple[float, float]:
    """Return cosine and sine, exact for multiples of 90 degrees."""
    quarters = angle / (math.pi / 2)
    if abs(quarters - round(quarters)) < 1e-15 * max(1.0, abs(quarters)):
        return ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[round(quarters) % 4]
    return math.cos(angle), math.sin(angle)


def _from_z(z: np.ndarray | None, x: np.ndarray | None) -> np.ndarray | None:
    """Return axes with exact z and with x in the half-plane of a second point; defaults are the outer axes."""
    if z is None:
        z = IDENTITY[2]
    if x is None:
        x = IDENTITY[0] if abs(z[0]) < 0.999 * np.linalg.norm(z) else IDENTITY[1]
    z = z / np.linalg.norm(z)
    y = np.cross(z, x)
    if not np.linalg.norm(y) > ROUNDING * np.linalg.norm(x):
        return None
    y = y / np.linalg.norm(y)
    return np.column_stack([np.cross(y, z), y, z])


def _from_x(x: np.ndarray, z: np.ndarray | None) -> np.ndarray | None:
    """Return axes with exact x and with z in the half-plane of a second point."""
    if z is None:
        z = IDENTITY[2]
    x = x / np.linalg.norm(x)
    y = np.cross(z, x)
    if not np.linalg.norm(y) > ROUNDING * np.linalg.norm(z):
        return None
    y = y / np.linalg.norm(y)
    return np.column_stack([x, y, np.cross(x, y)])
