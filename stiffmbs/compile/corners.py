"""Instants at which an input begins, ends or bends: integrators stop there and start anew.

At rest a BDF code takes ever longer steps and would jump over a short pulse without seeing it; a step across a corner
loses its order.
"""

from __future__ import annotations

import ast
import math
from collections.abc import Callable, Iterator
from functools import partial, reduce
from typing import Any, get_args

import numpy as np

from ..describe.element import Element
from ..describe.formula import UNIT, evaluate
from ..describe.formula_field import TIME, Formula, FormulaOf, is_measure, reading_order
from ..describe.formula_value import branch_value, step5_value, step_value
from ..describe.table import Table
from ..errors import InputError
from .enclosure import FUNCTIONS as ENCLOSED
from .enclosure import Enclosure
from .system import System
from .zeros import TooMany, zeros

FLAT = 1e-12
"""Change between two points of a table, in parts of its largest value, up to which it is flat there."""
STEADY = 1e-12
"""How far the argument of a table may be from a straight line in time, in parts of its size."""


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
    yield from metadata
    yield from getattr(annotation, "__metadata__", ())
    for part in get_args(annotation):
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
        match node:
            case ast.Call(ast.Name(name), [argument]) if name in formula.tables:
                yield from _of_called_table(formula, formula.tables[name], argument, start, end)
        for condition in _conditions(node):
            if _depends_on_time_alone(condition, formula):
                try:
                    yield from zeros(partial(_at, formula, condition), partial(_within, formula, condition), start, end)
                except TooMany as error:
                    raise InputError(f"'{formula.text}': {error}") from None


def _of_called_table(formula: Formula, table: Table, argument: ast.expr, start: float, end: float) -> Iterator[float]:
    """The corners of a table whose argument goes steadily with time; other arguments are left to the step control."""
    if not _depends_on_time_alone(argument, formula):
        return
    sample = np.array([start, (start + end) / 2, end])
    first, middle, last = _at(formula, argument, sample)
    rate = (last - first) / (end - start)
    if rate and abs(first + last - 2 * middle) <= STEADY * max(abs(first), abs(last)):
        low, high = sorted((first, last))
        yield from (start + (knot - first) / rate for knot in _of_table(table, low, high))


def _conditions(node: ast.expr) -> list[ast.expr]:
    """What is zero at the corners of a function (as `stiffmbs.compile.symbols.CORNERED` says for the state)."""
    match node:
        case ast.Call(ast.Name("abs" | "sign"), [x]) | ast.Call(ast.Name("branch"), [x, _, _, _]):
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
        if isinstance(part, ast.Name) and part.id in (*formula.variables, *formula.tables):
            return False
        used = used or (isinstance(part, ast.Name) and part.id == TIME)
    return used


def _at(formula: Formula, condition: ast.expr, t: np.ndarray) -> np.ndarray:
    """A condition's values at many instants."""
    values = evaluate(condition, lambda name: t if name == TIME else formula.values[name], _OF_ARRAYS)
    return np.broadcast_to(np.asarray(values, dtype=float), t.shape)


def _within(formula: Formula, condition: ast.expr, low: np.ndarray, high: np.ndarray) -> Enclosure:
    """The ranges of a condition and of its slope over many stretches of time."""
    t = Enclosure.of_time(low, high)
    return evaluate(condition, lambda name: t if name == TIME else formula.values[name], _OF_ENCLOSURES)


def _by_argument(of_numbers: Callable[..., Any], of_enclosures: Callable[..., Any]) -> Callable[..., Any]:
    """A function of formulas, also of the constants in them."""
    return lambda *x: (of_enclosures if any(isinstance(part, Enclosure) for part in x) else of_numbers)(*x)


_SAME_NAME = ("sin", "cos", "tan", "sinh", "cosh", "tanh", "exp", "log", "sqrt", "abs", "sign")
_OF_ARRAYS: dict[str, Callable[..., Any]] = {
    **{name: getattr(np, name) for name in _SAME_NAME},
    "asin": np.arcsin, "acos": np.arccos, "atan": np.arctan, "atan2": np.arctan2,
    "min": lambda *values: reduce(np.minimum, values), "max": lambda *values: reduce(np.maximum, values),
    "step": step_value, "step5": step5_value, "branch": branch_value,
}  # fmt: skip
_OF_ENCLOSURES = {name: _by_argument(of_arrays, ENCLOSED[name]) for name, of_arrays in _OF_ARRAYS.items()}
