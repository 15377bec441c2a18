"""Section `path` of a spatial scene: the course of a driver, as tables over its arc length."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal, Self

import numpy as np
from pydantic import Field, model_validator

from ...errors import InputError
from ...reading.fields import Described, located
from ...reading.files.yaml_text import Content
from ...reading.units import si
from .curves import Curve, circle, curve_through, straightened
from .lanes import LENGTH, STANDARDS, path_through

PATH = "path"
OF_COURSE = tuple(f"{PATH}_{name}" for name in ("x", "y", "cos", "sin", "curvature"))
"""Names of the tables of a course."""
COURSES = ("points", "circle", "lanes")
Station = tuple[si.Length, si.Velocity]


class Path(Described):
    """Section ``path``: one course on the road's x-y plane, which the part `driver` follows with ``path: course``.

    The course is a spline through `points`, or a `circle`, or leads through the `lanes` of a standard. Beyond the ends of
    an open one its curvature falls to zero over 20 m, and straight lines follow. It becomes the
    tables ``path_x path_y path_cos path_sin path_curvature`` over the arc length, for use in formulas.
    """

    points: tuple[si.Point2, ...] = Field((), description="points of a cubic spline: x and y, m")
    closed: bool = Field(False, description="whether the spline is a lap that returns to its first point and repeats")
    circle: si.Length | None = Field(None, description="radius of a circle, m, positive to the left")
    entry: si.LengthOrZero = Field(20.0, description="straight line before the circle, m")
    transition: si.LengthOrZero = Field(
        30.0, description="length over which the curvature grows to that of the circle, m"
    )
    turns: si.PositiveNumber = Field(3.0, description="turns on the circle")
    lanes: Literal["iso3888-1", "iso3888-2"] | None = Field(
        None, description="the standard whose lanes it leads through"
    )
    width: si.PositiveLength = Field(1.8, description="of the vehicle, which determines the lanes, m")
    length: si.PositiveLength = Field(LENGTH, description="of the vehicle, whose corners stay within the lanes, m")
    start: si.LengthOrZero = Field(30.0, description="straight line before the first lane, m")
    speed: tuple[Station, ...] = Field(
        (), description="speed profile: arc length, m, and speed, m/s; the table path_speed"
    )

    @model_validator(mode="after")
    def _one_course(self) -> Self:
        given = [name for name in COURSES if getattr(self, name)]
        if len(given) != 1 and self.circle != 0.0:
            raise ValueError(f"found {' and '.join(given) or 'no course'}, expected one of {', '.join(COURSES)}")
        if self.circle == 0.0:
            raise ValueError("circle: found 0, expected a radius that is not zero")
        if self.speed and any(b[0] <= a[0] for a, b in zip(self.speed, self.speed[1:], strict=False)):
            raise ValueError("speed: found arc lengths that do not increase, expected increasing ones")
        return self

    def curve(self) -> Curve:
        """Return the course over its arc length; ValueError if two points coincide, or lanes are too narrow."""
        if self.circle is not None:
            return circle(self.circle, self.entry, self.transition, self.turns)
        if self.lanes is not None:
            lanes = tuple(lane.shifted(self.start) for lane in STANDARDS[self.lanes](self.width))
            return curve_through(path_through(lanes, self.width, self.start, 100.0, self.length))
        return curve_through(np.array(self.points, dtype=float), self.closed)


def with_path(raw: dict[str, object], parameters: Mapping[str, object]) -> dict[str, object]:
    """Return a scene with the tables of its section ``path``.

    Raises InputError if the section is invalid, or a table of the scene has the name of one of its tables.
    """
    with located(PATH):
        path = Path.model_validate(raw[PATH], context={"parameters": parameters})
    with located(f"{PATH}.{'lanes' if path.lanes else 'points'}"):
        curve = path.curve()
    tables = raw.get("tables") or {}
    own = tables_of(curve)
    if path.speed:
        own[f"{PATH}_speed"] = {"table": [list(station) for station in path.speed], "beyond": "hold"}
        if len(path.speed) == 1:
            own[f"{PATH}_speed"]["table"].append([path.speed[0][0] + 1.0, path.speed[0][1]])
    for name in own:
        if isinstance(tables, dict) and name in tables:
            raise InputError(f"tables.{name}: found the name of a table of the section {PATH}, expected another")
    return {**raw, PATH: path, "tables": {**tables, **own} if isinstance(tables, dict) else tables}


def tables_of(curve: Curve) -> Content:
    """Return position, direction and curvature over the arc length, by the names of their tables."""
    curve = curve if curve.closed else straightened(curve)
    places = OF_COURSE[:2]
    return {
        name: {
            "table": np.stack([curve.s, getattr(curve, name.removeprefix(f"{PATH}_"))], axis=1).tolist(),
            "ends": "periodic" if curve.closed else "not-a-knot" if name in places else "clamped",
        }
        for name in OF_COURSE
    }
