"""Instants at which an input begins, ends or bends: integrators stop there and start anew.

At rest a BDF code takes ever longer steps and would jump over a short pulse without seeing it; a step across a corner
loses its order.
"""

from __future__ import annotations

import ast
import math
from collections.abc import Callable, Iterator
from functools import partial, reduce
from typing import Any

import numpy as np

from ..describe.element import Element
from ..describe.formula import UNIT, evaluate
from ..describe.formula_field import TIME, Formula, FormulaOf, is_measure, reading_order
from ..describe.formula_value import step5_value, step_value
from ..describe.table import Table
from .system import System

SAMPLES = 4001
"""Instants at which a corner's condition is looked at where it is no straight line in t."""
FLAT = 1e-12
"""Change between two points of a table, in parts of its largest value, up to which it is flat there."""


def corner_times(system: System, start: float, end: float) -> np.ndarray:
    """The corners in time of all elements, strictly between start and end, in order.

    Parameters
    ----------
    system : System
    start, end : float
        s.
    """
    found = sorted(
        t for group in system.groups for element in group.elements for t in _of_element(element, start, end)
        if start < t < end
    )  # fmt: skip
    apart = 1e-12 * max(abs(start), abs(end), 1e-300)
    kept = [t for k, t in enumerate(found) if k == 0 or t - found[k - 1] > apart]
    return np.array(kept)


def _of_element(element: Element, start: float, end: float) -> Iterator[float]:
    for _, formula in element.parts(Formula):
        yield from _of_formula(formula, start, end)
    for name, table in element.parts(Table):
        if _is_of_time(element, name):
            yield from _of_table(table, start, end)


def _is_of_time(element: Element, name: str) -> bool:
    """Whether a field's formula or table is one of time: it then has no variables of its own."""
    field = type(element).model_fields[name]
    marks = [mark for mark in _marks(field.metadata, field.annotation) if isinstance(mark, FormulaOf)]
    return any(not mark.variables for mark in marks)


def _marks(metadata: list[object], annotation: object) -> Iterator[object]:
    import typing

    yield from metadata
    yield from getattr(annotation, "__metadata__", ())
    for part in typing.get_args(annotation):
        yield from _marks([], part)


def _of_table(table: Table, start: float, end: float) -> Iterator[float]:
    """Ends of a table; all its points if it is of straight lines, else those where it leaves or reaches a flat part."""
    x, y = np.array(table.table).T
    slopes = np.diff(y) / np.diff(x)
    if table.lines:
        bends = np.flatnonzero(np.diff(slopes)) + 1
    else:
        flat = np.abs(np.diff(y)) <= FLAT * np.max(np.abs(y), initial=0.0)
        bends = np.flatnonzero(flat[1:] != flat[:-1]) + 1
    knots = np.unique(np.concatenate([[0], bends, [len(x) - 1]]))
    if table.ends != "periodic":
        yield from x[knots]
        return
    period = x[-1] - x[0]
    first, last = math.floor((start - x[0]) / period), math.ceil((end - x[0]) / period)
    for turn in range(first, last + 1) if table.lines or np.any(slopes == 0) else ():
        yield from x[knots] + turn * period


def _of_formula(formula: Formula, start: float, end: float) -> Iterator[float]:
    for node in reading_order(formula.tree):
        for condition in _conditions(node):
            if _depends_on_time_alone(condition, formula):
                yield from _zeros(partial(_at, formula, condition), start, end)


def _conditions(node: ast.expr) -> list[ast.expr]:
    """What is zero at the corners of a function (as `stiffmbs.compile.symbols.CORNERED` says for the state)."""
    match node:
        case ast.Call(ast.Name("abs" | "sign"), [x]):
            return [x]
        case ast.Call(ast.Name("min" | "max"), [first, *others]):
            return [ast.BinOp(first, ast.Sub(), other) for other in others]
        case ast.Call(ast.Name("step" | "step5"), [x, x0, _, x1, _]):
            return [ast.BinOp(x, ast.Sub(), x0), ast.BinOp(x, ast.Sub(), x1)]
    return []


def _depends_on_time_alone(node: ast.expr, formula: Formula) -> bool:
    used = False
    for part in ast.walk(node):
        if is_measure(part) or (isinstance(part, ast.Attribute) and f"{UNIT}.{part.attr}" not in formula.values):
            return False
        if isinstance(part, ast.Name) and part.id in formula.variables:
            return False
        used = used or (isinstance(part, ast.Name) and part.id == TIME)
    return used


def _at(formula: Formula, condition: ast.expr, t: np.ndarray) -> np.ndarray:
    """A condition's values at many instants."""
    values = evaluate(condition, lambda name: t if name == TIME else formula.values[name], _OF_ARRAYS)
    return np.broadcast_to(np.asarray(values, dtype=float), t.shape)


_SAME_NAME = ("sin", "cos", "tan", "sinh", "cosh", "tanh", "exp", "log", "sqrt", "abs", "sign")
_OF_ARRAYS: dict[str, Callable[..., Any]] = {
    **{name: getattr(np, name) for name in _SAME_NAME},
    "asin": np.arcsin, "acos": np.arccos, "atan": np.arctan, "atan2": np.arctan2,
    "min": lambda *values: reduce(np.minimum, values), "max": lambda *values: reduce(np.maximum, values),
    "step": step_value, "step5": step5_value,
}  # fmt: skip


def _zeros(condition: Callable[[np.ndarray], np.ndarray], start: float, end: float) -> Iterator[float]:
    """Zeros of a condition in t: exact where it is a straight line, else bisected between samples of different sign."""
    times = np.linspace(start, end, SAMPLES)
    with np.errstate(all="ignore"):
        values = condition(times)
        first, last = values[0], values[-1]
        straight = first + (last - first) * np.linspace(0, 1, SAMPLES)
        if np.all(np.abs(values - straight) <= 1e-12 * max(abs(first), abs(last))):
            if first != last:
                yield start + (end - start) * first / (first - last)
            return
        yield from times[values == 0]
        for k in np.flatnonzero(values[:-1] * values[1:] < 0):
            yield _bisected(condition, times[k], times[k + 1])


def _bisected(condition: Callable[[np.ndarray], np.ndarray], low: float, high: float) -> float:
    rising = condition(np.array([high]))[0] > 0
    while low < (middle := (low + high) / 2) < high:
        if (condition(np.array([middle]))[0] > 0) == rising:
            high = middle
        else:
            low = middle
    return high
