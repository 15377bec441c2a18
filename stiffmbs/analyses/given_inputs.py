"""Input values given to a run."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import SupportsFloat, TypeAlias

import numpy as np

from ..elements.states.amount import Amount
from ..errors import InputError, prefixed
from ..model.model_data import ModelData
from ..model.settings import DEFAULT_POINTS, RunSettings
from ..reading.did_you_mean import instead_of
from ..reading.files.quoted import written
from ..reading.table import Table
from ..solve.settings import output_grid

Given: TypeAlias = float | Callable[[float], float] | tuple[Sequence[float], Sequence[float]] | Table
"""Constant, function of t in s, or times and values with linear interpolation."""
FEWEST, MOST = 257, 40_000
"""Initial number of points of a spline through a function, and the number at which refinement stops."""
FOLLOWED = 1e-11
"""Tolerated error of that spline halfway between its points, relative to the largest value."""
JUMP, ROUNDINGS = 0.5, 1e-12
"""Part of a change that remains at a jump; distance of both sides of a jump, relative to the time."""


def with_inputs(data: ModelData, inputs: Mapping[str, Given] | None, settings: RunSettings) -> ModelData:
    """Return a model with other input values; raise an InputError for an unknown input or a value that is not a finite number.

    A smooth callable is approximated by a spline with a relative error of 1e-11.  A callable with jumps or kinks is
    sampled at the output times and on both sides of jumps, with linear interpolation.
    """
    if not inputs:
        return data
    for name in inputs:
        if name not in data.inputs:
            raise InputError(f"inputs: found no input '{name}'{instead_of(name, data.inputs)}")
    return data.model_copy(
        update={"inputs": {**data.inputs, **{name: _value(name, given, settings) for name, given in inputs.items()}}}
    )


def _value(name: str, given: Given, settings: RunSettings) -> Amount | Table:
    if isinstance(given, Table):
        return given
    if callable(given):
        return _followed(name, given, settings)
    if isinstance(given, tuple | list):
        if len(given) != 2 or len(given[0]) != len(given[1]):
            raise InputError(
                f"inputs: found {written(given)} for '{name}', expected as many values as times: (times, values)"
            )
        return _table(name, given[0], [_number(name, value) for value in given[1]])
    return Amount(_number(name, given))


def _followed(name: str, given: Callable[[float], float], settings: RunSettings) -> Table:
    """Approximate a function by a spline that is refined, or else by linear interpolation between output times."""
    from scipy.interpolate import CubicSpline

    grid = output_grid(settings)
    outputs = grid.times if grid.times is not None else np.linspace(grid.start, grid.end, DEFAULT_POINTS)
    times = np.linspace(grid.start, grid.end, max(FEWEST, len(outputs)))
    values = np.array([_number(name, given(float(t))) for t in times])
    while len(times) < MOST:
        between = (times[1:] + times[:-1]) / 2
        there = np.array([_number(name, given(float(t))) for t in between])
        spline = CubicSpline(times, values, bc_type="not-a-knot")
        followed = np.max(np.abs(spline(between) - there)) <= FOLLOWED * np.max(np.abs(values))
        at = np.arange(1, len(times))
        times, values = np.insert(times, at, between), np.insert(values, at, there)
        if followed:
            return Table(table=list(zip(times.tolist(), values.tolist(), strict=True)), ends="not-a-knot")
    points = {float(t): _number(name, given(float(t))) for t in outputs}
    for t, value in _jumps(name, given, list(points.items())):
        points[t] = value
    known = sorted(points.items())
    return _table(name, [t for t, _ in known], [value for _, value in known])


def _jumps(
    name: str, given: Callable[[float], float], points: list[tuple[float, float]]
) -> Iterator[tuple[float, float]]:
    """Yield both sides of the jumps between neighbouring points, found by bisection, at most one per interval."""
    largest = max(abs(value) for _, value in points)
    apart = ROUNDINGS * max(abs(points[0][0]), abs(points[-1][0]))
    for before, after in itertools.pairwise(points):
        low, high = before, after
        while high[0] - low[0] > apart:
            t = (low[0] + high[0]) / 2
            middle = t, _number(name, given(t))
            low, high = (low, middle) if abs(middle[1] - low[1]) > abs(high[1] - middle[1]) else (middle, high)
        if abs(high[1] - low[1]) > max(JUMP * abs(after[1] - before[1]), FOLLOWED * largest):
            yield from (low, high)


def _table(name: str, times: Iterable[float], values: list[float]) -> Table:
    with prefixed(f"inputs: {name}: "):
        return Table(table=[(float(t), value) for t, value in zip(times, values, strict=True)], lines=True)


def _number(name: str, found: SupportsFloat) -> float:
    try:
        value = float(found)
    except (TypeError, ValueError):
        value = np.nan
    if not np.isfinite(value):
        raise InputError(f"inputs: found {written(found)} for '{name}', expected a finite number")
    return value
