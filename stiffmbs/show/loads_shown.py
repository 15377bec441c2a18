"""Tables and charts of the loads of a run for its report."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..evaluation.bearing_loads import DrivingAngle, driving_angle, in_body_axes
from ..evaluation.loads import Load
from ..model.scene import Scene
from ..results.solution import Solution
from ..results.verification_words import has_reruns
from .curves import Curve, curve_chart, polar_chart, round_step, spark_line
from .loads import Column, LoadRow, load_rows

TITLES = {"N": "Loads", "N m": "Torques"}
MOST_SHOWN, MOST_CURVES = 20, 4
"""Numbers of elements in a table before it is folded, and in a chart."""


@dataclass(frozen=True)
class Chart:
    """Chart as SVG, and the names of its curves."""

    drawing: str
    names: tuple[str, ...]


@dataclass(frozen=True)
class Group:
    """Forces or torques: a table and charts."""

    title: str
    unit: str
    rows: list[tuple[LoadRow, str]]  # with a small curve each
    folded: list[LoadRow]
    charts: list[Chart]
    not_unique: bool


@dataclass(frozen=True)
class Polar:
    """Paths of loads in the axes of bodies, and the value of their outer circle in words."""

    outer: str
    drawings: list[str]


@dataclass(frozen=True)
class Tile:
    """Large number with its name, unit and place."""

    name: str
    number: str
    unit: str
    place: str


def loads_shown(scene: Scene, solution: Solution, loads: Sequence[Load]) -> dict[str, object]:
    """Return the values of the report's template on loads."""
    angle = driving_angle(scene, solution)
    about = {name: _about(element) for name, element in {**scene.joints, **scene.forces}.items()}
    of_unit = {unit: [load for load in loads if load.unit == unit] for unit in TITLES}
    return {
        "groups": [_group(unit, found, about, angle) for unit, found in of_unit.items() if found],
        "tiles": [_tile(found[0]) for found in of_unit.values() if found],
        "polar": _polar(scene, solution, of_unit["N"], angle), "angle": angle,
        "bars_words": _bars_words(solution, loads),
    }  # fmt: skip


def _bars_words(solution: Solution, loads: Sequence[Load]) -> str:
    if not solution.errors:
        return "Each peak is the largest magnitude at an output instant."
    reruns = (
        "from reruns at a smaller tolerance and with another integrator"
        if has_reruns(solution.verification)
        else "as estimated with the run"
    )
    return f"The bar \N{PLUS-MINUS SIGN} bounds the error of a peak, {reruns}."


def _about(element: object) -> str:
    """Return the kind of an element and its bodies in words."""
    bodies = [getattr(getattr(element, end, None), "body", "") for end in "ij"]
    between = " on ".join(body for body in bodies if body)
    kind = str(getattr(element, "kind", "")).replace("_", " ")
    return f"{kind}, {between}" if between else kind


def _group(unit: str, loads: Sequence[Load], about: dict[str, str], angle: DrivingAngle | None) -> Group:
    column = Column.of(unit, loads[0].peak, loads[0].display)
    rows = list(load_rows(loads, column, about))
    sparks = [spark_line(load.magnitude, load.time) for load in loads[:MOST_SHOWN]]
    return Group(
        TITLES[unit], column.unit, list(zip(rows, sparks, strict=False)), rows[MOST_SHOWN:], _charts(loads[:MOST_CURVES], column, angle),
        not all(load.unique for load in loads),
    )  # fmt: skip


def _charts(loads: Sequence[Load], column: Column, angle: DrivingAngle | None) -> list[Chart]:
    """Return the largest loads over time, and over the driving angle."""
    first, names = loads[0], tuple(load.element for load in loads)
    if len(first.time) < 2:
        return []
    curves = [Curve(load.element, load.time, load.magnitude * column.factor) for load in loads]
    peak = f"{column.words(first.peak, first.bar).partition(' ')[0]} {column.unit}"
    charts = [Chart(curve_chart(curves, _quantity(first, column), "time, s", peak), names)]
    if angle is not None and np.isfinite(first.magnitude[angle.rows]).any():
        charts.append(Chart(_over_angle(loads, angle), names))
    return charts


def _over_angle(loads: Sequence[Load], angle: DrivingAngle) -> str:
    """Return the chart of loads over the driving angle, with a unit of its own: the start is not in it."""
    sizes = [load.magnitude[angle.order] for load in loads]
    column = Column.of(loads[0].unit, float(np.nanmax(sizes)), loads[0].display)
    curves = [
        Curve(load.element, angle.sorted_degrees, size * column.factor) for load, size in zip(loads, sizes, strict=True)
    ]
    k = int(np.nanargmax(sizes[0]))
    words = f"{curves[0].y[k]:.4g} {column.unit} at {curves[0].x[k]:.0f}\N{DEGREE SIGN}"
    abscissa = f"angle of {angle.joint}, deg, last revolution"
    return curve_chart(curves, _quantity(loads[0], column), abscissa, words, 60.0)


def _quantity(load: Load, column: Column) -> str:
    return f"{'load' if load.unit == 'N' else 'torque'}, {column.unit}"


def _tile(load: Load) -> Tile:
    column = Column.of(load.unit, load.peak, load.display)
    name = "Largest force" if load.unit == "N" else "Largest torque"
    return Tile(
        name,
        column.words(load.peak, load.bar).partition(" ")[0],
        column.unit,
        f"{load.element}, at {load.time[load.peak_row]:.4g} s",
    )


def _polar(scene: Scene, solution: Solution, loads: Sequence[Load], angle: DrivingAngle | None) -> Polar | None:
    """Return paths of the largest forces in the last revolution of a drive, in a mechanism in the plane."""
    if angle is None:
        return None
    planar = [load for load in loads if load.components.shape[1] == 2]
    pairs = [(load.element, found) for load in planar if len(found := in_body_axes(scene, solution, load)) == 2]
    paths = [
        (element, body, vectors[angle.rows])
        for element, found in pairs[:MOST_CURVES]
        for body, vectors in found.items()
    ]
    largest = max((float(np.nanmax(np.hypot(*vectors.T))) for *_, vectors in paths), default=0.0)
    if not largest > 0:
        return None
    step = round_step(largest)
    outer = step * np.ceil(largest / step)
    column = Column.of("N", outer, solution.display)
    words = f"{outer * column.factor:.4g} {column.unit}"
    drawings = [
        polar_chart(vectors, outer, f"{element} on {body}", f"axes of {body}", words)
        for element, body, vectors in paths
    ]
    return Polar(words, drawings)
