"""Axis of a beam: straight pieces, or an arc, with a frame at every point."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import cast

import numpy as np

NEARLY = 1e-9
"""Relative tolerance for coincident points and parallel directions."""
ACROSS = 0.1
"""Sine of the angle from the vertical below which the x axis of the ground replaces it as upward direction."""


@dataclass(frozen=True)
class Straight:
    """Straight piece between two points."""

    start: np.ndarray
    end: np.ndarray

    @property
    def length(self) -> float:
        """Distance of its ends, m."""
        return float(np.linalg.norm(self.end - self.start))

    def at(self, s: float) -> tuple[np.ndarray, np.ndarray]:
        """Return point and unit tangent at an arc length."""
        tangent = (self.end - self.start) / self.length
        return self.start + s * tangent, tangent


@dataclass(frozen=True)
class Arc:
    """Circular arc.

    `first`, `second`: vectors of the radius's length: from the centre to the start, and a quarter turn further along
    the arc. `angle`: rad.
    """

    centre: np.ndarray
    first: np.ndarray
    second: np.ndarray
    angle: float

    @property
    def length(self) -> float:
        """Radius times angle, m."""
        return self.angle * float(np.linalg.norm(self.first))

    def at(self, s: float) -> tuple[np.ndarray, np.ndarray]:
        """Return point and unit tangent at an arc length."""
        radius = float(np.linalg.norm(self.first))
        c, sine = np.cos(s / radius), np.sin(s / radius)
        return self.centre + c * self.first + sine * self.second, (c * self.second - sine * self.first) / radius


Piece = Straight | Arc
"""Smooth piece of an axis."""


def pieces_through(points: Sequence[np.ndarray]) -> list[Piece]:
    """Return straight pieces through points.

    Raises ValueError if two consecutive points coincide, or a piece leads straight back.
    """
    size = max(float(np.max(np.abs(np.array(points)))), 1e-300)
    found: list[Piece] = []
    for k, (a, b) in enumerate(itertools.pairwise(points)):
        if np.linalg.norm(b - a) <= NEARLY * size:
            raise ValueError(
                f"found the points {k + 1} and {k + 2} at the same place, expected a piece of non-zero length"
            )
        found.append(Straight(np.asarray(a, dtype=float), np.asarray(b, dtype=float)))
        if k and found[-2].at(0)[1] @ found[-1].at(0)[1] < NEARLY - 1:
            raise ValueError(f"found a beam that reverses its direction at point {k + 1}, expected another direction")
    return found


def arc_through(start: np.ndarray, middle: np.ndarray, end: np.ndarray) -> Piece:
    """Return the arc through three points; a straight piece if they are on one line.

    Raises ValueError if two of the points coincide, or the middle one is on the line but not between the others.
    """
    pieces_through([start, middle, end])
    a, b = middle - start, end - start
    normal = np.cross(a, b)
    square = float(normal @ normal)
    if square <= (NEARLY * (a @ a + b @ b)) ** 2:
        if a @ b <= 0 or a @ a >= b @ b:
            raise ValueError(
                "found the middle point on the line through the ends but not between them, expected a point of an arc"
            )
        return Straight(start, end)
    to_centre = (np.cross(normal, a) * (b @ b) + np.cross(b, normal) * (a @ a)) / (2 * square)
    first = -to_centre
    second = np.cross(normal / np.sqrt(square), first)
    last = b - to_centre
    angle = float(np.arctan2(last @ second, last @ first)) % (2 * np.pi)
    return Arc(start + to_centre, first, second, angle)


def frame(tangent: np.ndarray, up: np.ndarray) -> np.ndarray:
    """Return the rotation matrix whose x axis is the tangent and whose z axis is nearest to `up`.

    Raises ValueError if the two are parallel.
    """
    across = np.cross(up, tangent)
    size = float(np.linalg.norm(across))
    if size <= NEARLY * float(np.linalg.norm(up)):
        raise ValueError("found no direction across the beam, expected one for axis 3 of its section")
    y = across / size
    return cast(np.ndarray, np.column_stack([tangent, y, np.cross(tangent, y)]))


def upward(piece: Piece) -> np.ndarray:
    """Return z, or x if the piece is nearly vertical somewhere: the default direction of axis 3."""
    z = np.array([0.0, 0.0, 1.0])
    tangents = [piece.at(share * piece.length)[1] for share in np.linspace(0, 1, 9)]
    vertical = any(np.linalg.norm(np.cross(z, tangent)) < ACROSS for tangent in tangents)
    return np.array([1.0, 0.0, 0.0]) if vertical else z
