"""Breakpoints of inputs: times where integrators stop and restart.

At rest a BDF integrator takes ever longer steps and would miss a short pulse; a step across a breakpoint loses its
order.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from functools import partial

import numpy as np

from ...errors import InputError
from ...reading.formula.functions import EACH, IN_FORMULAS, Breakpoints
from ...reading.formula.nodes import TIME, reading_order
from .of_time import Input
from .zeros import FIRST_STRETCHES, SHORTEST_STRETCH, ZERO, TooMany, zeros


def breakpoint_times(inputs: Sequence[Input], start: float, end: float) -> np.ndarray:
    """Return the breakpoints in time of some inputs, strictly between start and end, in ascending order.

    Parameters
    ----------
    start, end : float
        s.
    """
    found = np.concatenate([np.empty(0), *(times for each in inputs for times in _of_input(each, start, end))])
    found = np.sort(found[(found > start) & (found < end)])
    apart = SHORTEST_STRETCH * max(abs(start), abs(end), np.finfo(float).tiny)
    return found[np.diff(found, prepend=-np.inf) > apart]


def _of_input(given: Input, start: float, end: float) -> Iterator[np.ndarray]:
    try:
        yield from _passages(given, start, end)
    except TooMany as error:
        raise InputError(f"'{given.text}': {error}") from None


def _passages(given: Input, start: float, end: float) -> Iterator[np.ndarray]:
    seen = set()
    for node in reading_order(given.tree):
        for condition, levels in _conditions(given, node, start, end):
            key = ast.dump(condition), levels.tobytes()
            if (
                key in seen
                or not len(levels)
                or not any(isinstance(part, ast.Name) and part.id == TIME for part in ast.walk(condition))
            ):
                continue
            seen.add(key)
            values, ranges = partial(given.at, part=condition), partial(given.within, part=condition)
            yield zeros(values, ranges, start, end, levels)


def _conditions(given: Input, node: ast.expr, start: float, end: float) -> Iterator[tuple[ast.expr, np.ndarray]]:
    """Yield expressions and the levels that they cross at the breakpoints of a function or table."""
    match node:
        case ast.Call(ast.Name(name), [argument]) if name in given.tables:
            yield argument, given.tables[name].breakpoints_between(*_range(given, argument, start, end))
        case ast.Call(ast.Name(name)):
            yield from ((condition, ZERO) for condition in _breakpoints(node, IN_FORMULAS[name].breakpoints))


def _breakpoints(call: ast.Call, breakpoints: Breakpoints) -> Iterator[ast.expr]:
    """Yield the expressions whose zeros are the breakpoints of a function."""
    first, *others = call.args
    if breakpoints == EACH:
        for k, other in enumerate(others):
            before = ast.Call(call.func, [first, *others[:k]], []) if k else first
            yield ast.BinOp(before, ast.Sub(), other)
        return
    for i, j in breakpoints:
        yield call.args[i] if j is None else ast.BinOp(call.args[i], ast.Sub(), call.args[j])


def _range(given: Input, part: ast.expr, start: float, end: float) -> tuple[float, float]:
    edges = np.linspace(start, end, FIRST_STRETCHES + 1)
    with np.errstate(all="ignore"):
        low, high = given.within(edges[:-1], edges[1:], part=part).value
    return float(np.nanmin(low, initial=np.inf)), float(np.nanmax(high, initial=-np.inf))
