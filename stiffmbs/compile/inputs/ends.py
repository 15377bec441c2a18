"""Times at which an input has a pole or ends; no motion exists beyond them.

Interval arithmetic (`stiffmbs.compile.inputs.interval_arithmetic`) bounds formulas over time intervals. Intervals without a bound
are subdivided down to the resolution of time. Nearby values then distinguish a pole from a removable singularity, as
that of sin(t)/t at zero.
"""

from __future__ import annotations

import ast
import math
from collections.abc import Callable, Iterator, Mapping
from typing import NamedTuple

import numpy as np

from ...elements.element import Element
from ...reading.formula.functions import EVERYWHERE, IN_FORMULAS
from ...reading.formula.nodes import TIME, parts_of
from ...reading.table import Table
from ..system import System
from .of_time import Given, Input, expressions_of, given_to
from .table_ranges import TableRanges
from .zeros import FIRST_STRETCHES, SHORTEST_STRETCH

MOST_DIVISIONS = 500
"""Limit of subdivisions, after which solvers have to find the end."""
FARTHER_SIDE, NEARER_SIDE = 1e-6, 1e-10
"""Distances, relative to the times, at which values on both sides are compared."""
GROWS = 3.0
"""Factor by which values must grow between these distances: that of a pole of order 1/8."""
LARGEST = 1e8
"""Growth towards a pole that solvers can follow."""
DISTANCES = np.geomspace(0.1, FARTHER_SIDE, 16)
"""Distances from a pole at which growth is checked, relative to the times."""
DOMAINS = {name: function.domain for name, function in IN_FORMULAS.items() if function.domain != EVERYWHERE}
"""Domains of functions."""
RISKY = (*DOMAINS, *(name for name, function in IN_FORMULAS.items() if function.poles))
"""Functions without a finite value for some arguments."""

Values = Callable[[float], float | None]


class InputEnd(NamedTuple):
    """End of a formula of time.

    - `t`: s.
    - `near`: distance before the end, s, within which its values are inaccurate.
    - `element`, `text`: element, and part of its formula.
    - `pole`: true if it grows without bound; False if it has no value beyond.
    """

    t: float
    near: float
    element: str
    text: str
    pole: bool

    def sentence(self) -> str:
        """Return the message that a run ends there."""
        found = "grows without bound" if self.pole else "has no value beyond"
        return (
            f"stopped at t = {self.t:.9g} s: '{self.element}' has no finite value there, as '{self.text}' {found}; "
            "expected an input with a value over the whole run: give another formula, or end the run before"
        )


def first_input_end(system: System, start: float, end: float) -> InputEnd | None:
    """Return the first time of a run at which a formula of time ends; None if all have values. `start`, `end`: s."""
    given = given_to(system)
    found = [
        each for group in system.groups if group.has_inputs for name, element in zip(group.names, group.elements, strict=True)
        for each in _of_element(name, element, given, start, end)
    ]  # fmt: skip
    return min(found, key=lambda each: each.t, default=None)


def _of_element(name: str, element: Element, given: Given, start: float, end: float) -> Iterator[InputEnd]:
    for expression, text, values, tables in expressions_of(element, given):
        risky = [node for node in _outside_tables(expression, tables) if _is_risky(node)]
        of_time = Input(expression, text, values, {table: TableRanges(tables[table]) for table in tables if risky})
        yield from filter(None, (_of_node(name, of_time, node, start, end) for node in risky))


def _outside_tables(expression: ast.expr, tables: Mapping[str, Table]) -> Iterator[ast.expr]:
    """Yield the nodes of an expression without tables and their arguments: tables extrapolate linearly."""
    if not (
        isinstance(expression, ast.Call) and isinstance(expression.func, ast.Name) and expression.func.id in tables
    ):
        yield expression
        for part in parts_of(expression):
            yield from _outside_tables(part, tables)


def _is_risky(node: ast.expr) -> bool:
    """Return True if a node depends on time and may have no finite value although its parts have one."""
    match node:
        case ast.BinOp(_, ast.Div(), part) | ast.BinOp(part, ast.Pow(), ast.UnaryOp() | ast.BinOp()):
            pass
        case ast.BinOp(part, ast.Pow(), ast.Constant(int())):
            return False
        case ast.BinOp(_, ast.Pow(), _):
            part = node
        case ast.Call(ast.Name(name), _) if name in RISKY:
            part = node
        case _:
            return False
    return any(isinstance(each, ast.Name) and each.id == TIME for each in ast.walk(part))


def _of_node(name: str, given: Input, node: ast.expr, start: float, end: float) -> InputEnd | None:
    """Return the first end of an input caused by one of its nodes, or None."""

    def value(t: float) -> float | None:
        with np.errstate(all="ignore"):  # cosh may overflow in a denominator
            found = float(given.at(np.array([t]))[0])
        return found if np.isfinite(found) else None

    for low, high in _without_bound(given, node, start, end):
        size = max(abs(low), abs(high), end - start)
        pole = _is_pole(value, low, high, size)
        if pole or all(value(high + distance * size) is None for distance in (NEARER_SIDE, 10 * NEARER_SIDE)):
            near = _pole_distance(value, low, size) if pole else NEARER_SIDE * size
            return InputEnd(low, near, name, ast.unparse(node), pole)
    return None


def _without_bound(given: Input, node: ast.expr, start: float, end: float) -> Iterator[tuple[float, float]]:
    """Yield the shortest intervals over which a node is unbounded, in ascending order and separated."""
    waiting, divisions, passed = [(start, end)], 0, start
    while waiting and divisions < MOST_DIVISIONS:
        first, last = waiting.pop()
        size = max(abs(first), abs(last), end - start)
        if last < passed:
            continue
        if last - first <= SHORTEST_STRETCH * size:
            yield first, last
            passed = last + FARTHER_SIDE * size
            continue
        edges = np.linspace(first, last, FIRST_STRETCHES + 1)
        with np.errstate(all="ignore"):
            bounded = _is_bounded(given, node, edges[:-1], edges[1:])
        divisions += 1
        waiting += [(float(edges[k]), float(edges[k + 1])) for k in np.flatnonzero(~bounded)[::-1]]


def _is_bounded(given: Input, node: ast.expr, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Return True for intervals with a bounded range and with arguments inside the node's domain."""
    bounded = np.isfinite(given.within(low, high, part=node).value).all(axis=0)
    match node:
        case ast.Call(ast.Name(name), [argument]) if name in DOMAINS:
            least, most = DOMAINS[name]
        case ast.BinOp(argument, ast.Pow(), _):
            least, most = 0.0, np.inf
        case _:
            return bounded
    inside = given.within(low, high, part=argument).value
    return bounded & (inside[0] >= least) & (inside[1] <= most)


def _is_pole(value: Values, low: float, high: float, size: float) -> bool:
    """Return True if values grow towards the time on either side.

    Those of a pole, unlike those of a steep exponential, still grow by the same power of the distance at the resolution of time.
    """
    order = math.log(GROWS) / math.log(FARTHER_SIDE / NEARER_SIDE)
    still_grows = (NEARER_SIDE / (2 * SHORTEST_STRETCH)) ** order
    for at, sense in ((low, -1.0), (high, 1.0)):
        far, near, nearest = (value(at + sense * side * size) for side in (FARTHER_SIDE, NEARER_SIDE, SHORTEST_STRETCH))
        if far is None or near is None or not abs(near) > GROWS * abs(far) > 0.0:
            continue
        if nearest is None or abs(nearest) > still_grows * abs(near):
            return True
    return False


def _pole_distance(value: Values, t: float, size: float) -> float:
    """Return the distance before a pole at which solvers stop: nearer, time loses digits or values are too large."""
    largest = None
    for distance in DISTANCES * size:
        found = value(t - distance)
        if found is None:
            continue
        largest = LARGEST * max(1.0, abs(found)) if largest is None else largest
        if abs(found) > largest:
            return float(distance)
    return FARTHER_SIDE * size
