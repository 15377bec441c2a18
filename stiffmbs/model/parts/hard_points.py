"""Checks of the hard points of a suspension for wrong units and for the wrong side of the car."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from ...errors import InputError
from ...reading.units.units import UNITS, Quantity
from .frame import Use
from .vectors import COMPONENTS, Vectors

WHEEL = "wheel_centre"
"""Name of the point by which the others are checked; parts without it are not suspensions of a wheel."""
FARTHEST = 5.0
"""Largest distance of a hard point from the centre of its wheel, m; those in millimetres lie farther away."""


def check_hard_points(use: Use, where: str, vectors: Vectors, own: Mapping[str, Quantity]) -> None:
    """Refuse hard points that are far from the wheel, or that lie on the other side of the car.

    The sides of points that the use does not set are those of the part: a twist beam has points on both.
    """
    points = dict(_points(vectors, own))
    wheel = points.get(WHEEL)
    if wheel is None:
        return
    for name, point in points.items():
        place = f"{where}.parameters.{name}: found ({', '.join(f'{x:g}' for x in point)}) m"
        centre = f"{WHEEL} ({', '.join(f'{x:g}' for x in wheel)}) m"
        if math.dist(point, wheel) > FARTHEST:
            raise InputError(
                f"{place}, which is {math.dist(point, wheel):.3g} m from {centre}, expected {FARTHEST:g} m or less"
            )
        given = any(f"{name}_{axis}" in use.parameters for axis in COMPONENTS)
        if given and point[1] * wheel[1] < -(wheel[1] ** 2) / 2:
            raise InputError(f"{place}, on the other side of the car from {centre}, expected the side of the wheel")


def _points(vectors: Vectors, own: Mapping[str, Quantity]) -> Iterator[tuple[str, tuple[float, ...]]]:
    """Yield the vectors in space whose components are lengths."""
    for name in (name for name, count in vectors.items() if count == len(COMPONENTS)):
        parts = [own[f"{name}_{axis}"] for axis in COMPONENTS]
        if any(part.dimension == UNITS["m"].dimension for part in parts):
            yield name, tuple(part.value for part in parts)
