"""Checks of parts for wrong units of hard points, angles and springs, for the wrong side of the car, and for points in one place."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import combinations
from typing import Any

from ...errors import InputError
from ...reading.names import GROUND
from ...reading.units.units import UNITS, Quantity
from .frame import Use
from .vectors import COMPONENTS, Vectors

WHEEL = "wheel_centre"
"""Name of the point by which the others are checked; parts without it are not suspensions of a wheel."""
SAME_PLACE = 1e-3
"""Largest distance between two wheels, or two hard points, in one place, m."""
FARTHEST = 5.0
"""Largest distance of a hard point from the centre of its wheel, m; those in millimetres lie farther away."""
STATIC_ANGLES = ("toe", "camber")
STEEPEST = math.radians(20)
"""Largest toe and camber, rad: twice those of drift and speedway cars; degrees read as radians lie beyond it."""


def check_hard_points(
    use: Use, where: str, vectors: Vectors, own: Mapping[str, Quantity], default: Mapping[str, Quantity]
) -> tuple[float, ...] | None:
    """Return the centre of the wheel in the frame of a part; None for a part without one.

    Hard points that are far from the wheel, or that lie on the other side of the car, are refused, and two in one place:
    points of one arm, rod or strut, and both ball joints of an upright. So are toe and camber of more than 20 deg, and
    springs that their load compresses by more than 5 m. The
    sides of points that the use does not set are those of the part: a twist beam has points on both. `default`:
    parameters of the part.
    """
    _check_spring(where, own)
    points = dict(_points(vectors, own))
    wheel = points.get(WHEEL)
    if wheel is None:
        return None
    for name in STATIC_ANGLES:
        angle = own[name].value if name in own else 0.0
        if abs(angle) > STEEPEST:
            raise InputError(
                f"{where}.parameters.{name}: found {angle:g} rad, which is {math.degrees(angle):.3g} deg, expected "
                f"{math.degrees(STEEPEST):g} deg or less: plain numbers are in rad"
            )
    if wheel[1] * default[f"{WHEEL}_y"].value < 0:
        raise InputError(
            f"{where}.parameters.{WHEEL}: found ({', '.join(f'{x:g}' for x in wheel)}) m, on the other side of the car than "
            f"in '{use.part}', expected the points of that side, and mirror: 'y' for the other one"
        )
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
    for (name, point), (other, there) in combinations(points.items(), 2):
        if math.dist(point, there) < SAME_PLACE and _on_one_member(name, other):
            raise InputError(
                f"{where}.parameters.{other}: found ({', '.join(f'{x:g}' for x in there)}) m, in the place of {name}, "
                "expected two points apart"
            )
    return wheel


def _check_spring(where: str, own: Mapping[str, Quantity]) -> None:
    """Refuse a spring that its load compresses by more than the size of a car, as one in N/mm read as N/m."""
    load, rate = (own[name].value if name in own else 0.0 for name in ("strut_load", "spring"))
    if rate > 0 and abs(load) > FARTHEST * rate:
        raise InputError(
            f"{where}.parameters.spring: found {rate:g} N/m, by which strut_load = {load:g} N compresses the spring by "
            f"{abs(load) / rate:.3g} m, expected {FARTHEST:g} m or less: plain numbers are in N/m"
        )


def _on_one_member(name: str, other: str) -> bool:
    """Return True for points such as `lower_front` and `lower_ball`, and for `lower_ball` and `upper_ball`."""
    (member, _, end), (second, _, other_end) = name.rpartition("_"), other.rpartition("_")
    return bool(member and second) and (member == second or end == other_end == "ball")


def check_sides(wheels: Iterable[tuple[str, tuple[float, ...], str, Any]]) -> None:
    """Refuse suspensions of the left side of a car on its right side without a mirror, and the reverse.

    `wheels`: names of the instances, centres of the wheels in their frames, bodies that they are mounted on, and their
    frames in the axes of these bodies.
    """
    seen: list[tuple[str, str, tuple[float, ...]]] = []
    for name, wheel, body, frame in wheels:
        place = frame.to_outside(wheel)
        found = f"use.{name}: found the wheel at ({', '.join(f'{x:g}' for x in place)}) m on {body}"
        for other, mount, taken in seen:
            nested = name.startswith(f"{other}.")
            if mount == body and math.dist(place, taken) < SAME_PLACE and not nested:
                raise InputError(
                    f"{found}, in the place of the wheel of {other}, expected another place: mirror: 'y' makes a left suspension a right one"
                )
        outwards = frame.turned((0.0, wheel[1], 0.0))
        if body != GROUND and sum(a * b for a, b in zip(place, outwards, strict=True)) < -(wheel[1] ** 2) / 2:
            raise InputError(
                f"{found}, with its suspension on the outer side of the car, expected it on the inner side: "
                "mirror: 'y' makes a left suspension a right one"
            )
        seen.append((name, body, place))


def check_left_and_right(
    where: str, mounts: Mapping[str, str], centre: Callable[[str], Sequence[float]], to_left: Sequence[float]
) -> None:
    """Refuse mounts `left` and `right`, as of an anti-roll bar or a driver, whose bodies are on the other sides.

    `mounts`: bodies by local name. `centre`: returns the centre of mass of a body. `to_left`: direction of the part's y
    axis, like the centres in ground axes.
    """
    for name, body in mounts.items():
        opposite = re.sub(r"(?<![^_])left(?![^_])", "right", name)
        other = mounts.get(opposite, body)
        apart = _along(to_left, centre(body)) - _along(to_left, centre(other)) if other != body else 0.0
        if apart < -SAME_PLACE:
            raise InputError(
                f"{where}.mounts.{name}: found '{body}', to the right of '{other}' of the mount {opposite}, "
                "expected them the other way round"
            )


def _along(direction: Sequence[float], point: Sequence[float]) -> float:
    return sum(a * b for a, b in zip(direction, point, strict=True))


def _points(vectors: Vectors, own: Mapping[str, Quantity]) -> Iterator[tuple[str, tuple[float, ...]]]:
    """Yield the vectors in space whose components are lengths."""
    for name in (name for name, count in vectors.items() if count == len(COMPONENTS)):
        parts = [own[f"{name}_{axis}"] for axis in COMPONENTS]
        if any(part.dimension == UNITS["m"].dimension for part in parts):
            yield name, tuple(part.value for part in parts)
