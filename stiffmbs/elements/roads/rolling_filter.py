"""Filters of road heights: the rolling radius, a rigid disc on the road, and an elliptical cam.

A rigid disc of radius R on a profile h has its centre at the height max over s of h(x + s) + sqrt(R^2 - s^2). That
height minus R is the road height for a tyre with a single contact point. The disc bridges narrow gaps, and a step
becomes a circular arc. Captain, Boghani, Wormley, Analytical tire models for dynamic vehicle simulation, Vehicle System
Dynamics 8 (1979) 1-32. A cam (`stiffmbs.elements.roads.envelope`) does the same with another shape.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache, partial
from typing import Literal

import numpy as np

from ...errors import InputError
from ...reading.formula.formula import Formula
from ...reading.table import Table

FINE, COARSE = 50, 20
"""Points per radius, and the fewest on a long road; the errors are then at most R/20000 and R/3200."""
BETWEEN = 8
"""Subdivisions of a step at which the profile of a short road is sampled, for its edges."""
MOST = 40000
"""Largest number of points of a profile."""
MARGIN = 1.5
"""Distance from a profile, in radii, at which the disc no longer touches it."""


@dataclass(frozen=True)
class Cam:
    """Lower half of a superellipse with horizontal and vertical half axes, m, that touches the road."""

    length: float
    height: float
    order: float


Shape = float | Cam
"""Radius of a disc, m, or a cam."""


def through_filter(table: Table, shape: Shape | None) -> Table:
    """Return the filtered heights for a disc or a cam; the profile itself without one."""
    return table if shape is None else rolled(table, shape)


def _reach(shape: Shape) -> float:
    """Return the largest horizontal distance at which a shape touches the road, m."""
    return shape.length if isinstance(shape, Cam) else shape


def _height(shape: Shape) -> float:
    """Return the height of the shape's centre above its lowest point, m."""
    return shape.height if isinstance(shape, Cam) else shape


@lru_cache(maxsize=64)
def rolled(table: Table, shape: Shape) -> Table:
    """Return the filtered heights over x. Raises InputError if the profile is longer than 2000 radii."""
    points = np.array(table.table)
    x, centre = _centres(partial(heights_of, table), (points[0, 0], points[-1, 0]), shape)
    _take_in(centre, x, points, shape)
    if table.repeats:
        centre[-1] = centre[0]
    filtered = table_of(x, centre - _height(shape), "periodic" if table.repeats else None)
    return filtered.model_copy(update={"beyond": table.beyond})


def rolled_profile(heights: Callable[[np.ndarray], np.ndarray], extent: tuple[float, float], shape: Shape) -> Table:
    """Return the filtered heights of a profile given by a function, level outside its extent; errors as `rolled`."""
    around_it = MARGIN * _reach(shape)
    x, centre = _centres(heights, (extent[0] - around_it, extent[1] + around_it), shape)
    return table_of(x, centre - _height(shape))


def _centres(
    heights: Callable[[np.ndarray], np.ndarray], extent: tuple[float, float], shape: Shape
) -> tuple[np.ndarray, np.ndarray]:
    """Return positions along an extent, and the height of the centre of the disc or cam there."""
    from scipy.ndimage import grey_dilation

    (first, last), radius = extent, _reach(shape)
    radii = (last - first) / radius
    if radii * COARSE > MOST:
        raise InputError(
            f"found a road of {last - first:g} m and a filter's radius of {radius:g} m, expected a road of at most "
            f"{MOST // COARSE} radii"
        )
    count = max(int(np.ceil(min(radii * FINE, MOST))), 2)
    parts = min(max(MOST // count, 1), BETWEEN)
    x, step = np.linspace(first, last, count * parts + 1, retstep=True)
    margin = int(np.floor(radius / step))
    around_it = step * np.arange(1, margin + 1)
    around = heights(np.concatenate([first - around_it[::-1], x, last + around_it]))
    disc = _disc(step * np.arange(-margin, margin + 1), shape)
    centre = grey_dilation(around, footprint=np.ones(len(disc)), structure=disc, mode="nearest")
    return x[::parts], centre[margin : margin + len(x) : parts]


def _take_in(centre: np.ndarray, x: np.ndarray, points: np.ndarray, shape: Shape) -> None:
    """Raise the centre of the disc or cam where it touches a point of the table between samples."""
    radius = _reach(shape)
    ends = np.searchsorted(x, points[:, :1] + np.array([-radius, radius]))
    for (at, height), (begin, end) in zip(points, ends, strict=True):
        np.maximum(centre[begin:end], height + _disc(x[begin:end] - at, shape), out=centre[begin:end])


def heights_of(table: Table, x: np.ndarray) -> np.ndarray:
    """Return the heights of the profile, with the extrapolation or periodicity of the equations."""
    from scipy.interpolate import Akima1DInterpolator, CubicSpline, PchipInterpolator

    at, heights = np.array(table.table).T
    if table.repeats:
        x = at[0] + np.mod(x - at[0], at[-1] - at[0])
        heights = np.append(heights[:-1], heights[0])
    inside = np.clip(x, at[0], at[-1])
    outside = 0.0 if table.beyond == "hold" else x - inside
    if table.lines:
        slope = np.diff(heights) / np.diff(at)
        ends = np.where(x < at[0], slope[0], slope[-1])
        return np.interp(inside, at, heights) + ends * outside
    if table.smoothing is not None:
        raise InputError("found a road with smoothing and a filter, expected one of them")
    local = {"akima": Akima1DInterpolator, "monotone": PchipInterpolator}.get(table.interpolation)
    if local and table.repeats:
        count, length = len(at) - 1, at[-1] - at[0]
        at = np.concatenate([at[:-1] - length, at[:-1], at + length])
        heights = np.concatenate([heights[:count], heights[:count], heights])
    ends = "periodic" if table.repeats else table.ends or "natural"
    found = local(at, heights) if local else CubicSpline(at, heights, bc_type=ends)
    return np.asarray(found(inside) + found(inside, 1) * outside)


def of_arrays(value: object) -> object:
    """Return a field of a road with functions of arrays for tables and formulas."""
    match value:
        case Table():
            return partial(heights_of, value)
        case Formula():
            return partial(_formula_of_arrays, value)
        case tuple():
            return tuple(map(of_arrays, value))
    return value


def _formula_of_arrays(formula: Formula, *arguments: np.ndarray) -> object:
    from ...reading.formula.functions import IN_FORMULAS
    from ...reading.formula.text import evaluate

    functions = {name: function.array for name, function in IN_FORMULAS.items()}
    tables = {name: partial(heights_of, table) for name, table in formula.tables.items()}
    values = {**formula.values, **dict(zip(formula.variables, arguments, strict=True))}
    return evaluate(formula.tree, values.__getitem__, functions | tables)


def _disc(s: np.ndarray, shape: Shape) -> np.ndarray:
    """Return the depth of the shape's lower edge below its centre, m, at horizontal distances."""
    if isinstance(shape, Cam):
        part = np.minimum(np.abs(s) / shape.length, 1.0)
        return np.asarray(shape.height * (1 - part**shape.order) ** (1 / shape.order))
    return np.sqrt(np.maximum(shape**2 - s**2, 0.0))


def table_of(
    x: np.ndarray, values: np.ndarray, ends: Literal["natural", "clamped", "periodic", "not-a-knot"] | None = None
) -> Table:
    """Return the table of arrays, which are not checked again."""
    return Table.model_construct(table=tuple(zip(x.tolist(), values.tolist(), strict=True)), ends=ends)
