"""Times at which an input has a pole or ends; no motion exists beyond them.

Interval arithmetic (`stiffmbs.compile.inputs.enclosure`) bounds formulas over time intervals. Intervals without a bound
are subdivided down to the resolution of time. Nearby values then distinguish a pole from a removable singularity, as
that of sin(t)/t at zero.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from ...describe.element import Element
from ...describe.formula.formula import Formula
from ...describe.formula.functions import EVERYWHERE, IN_FORMULAS
from ...describe.formula.nodes import TIME, is_named, reading_order
from ...describe.formula.text import UNIT, evaluate
from ..system import System
from .enclosed_functions import FUNCTIONS
from .enclosure import Enclosure
from .of_time import Input

PARTS_OF_A_STRETCH, MOST_DIVISIONS = 32, 500
"""Parts of a subdivided interval, and limit of subdivisions, after which solvers have to find the end."""
SHORTEST_DIVIDED = 1e-13
"""Length, relative to the times, of an interval that is not subdivided further."""
FARTHER_SIDE, NEARER_SIDE = 1e-6, 1e-10
"""Distances, relative to the times, at which values on both sides are compared."""
GROWS = 3.0
"""Factor by which values must grow between these distances: that of a pole of order 1/8."""
LARGEST, DISTANCES = 1e8, np.geomspace(0.1, FARTHER_SIDE, 16)
"""Growth towards a pole that solvers can follow, and distances at which it is checked, relative to the times."""
DOMAINS = {name: function.domain for name, function in IN_FORMULAS.items() if function.domain != EVERYWHERE}
"""Domains of functions."""
RISKY = (*DOMAINS, *(name for name, function in IN_FORMULAS.items() if function.poles))
"""Functions without a finite value for some arguments."""

Values = Callable[[float], float | None]


class InputEnd(NamedTuple):
    """End of a formula of time.

    Attributes
    ----------
    t : float
        s.
    near : float
        Distance before the end, s, within which its values are inaccurate.
    element, text : str
        Element, and part of its formula.
    pole : bool
        True if it grows without bound; False if it has no value beyond.
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
    """Return the first time of a run at which a formula of time ends; None if all have values.

    Parameters
    ----------
    system : System
    start, end : float
        s.
    """
    found = [
        each for group in system.groups if group.has_inputs for name, element in zip(group.names, group.elements, strict=True)
        for each in _of_element(name, element, start, end)
    ]  # fmt: skip
    return min(found, key=lambda each: each.t, default=None)


def _of_element(name: str, element: Element, start: float, end: float) -> Iterator[InputEnd]:
    for _, formula in element.parts(Formula):
        for part in _parts_of_time(formula):
            for node in reading_order(part):
                if _is_risky(node):
                    yield from _of_node(name, formula, part, node, start, end)


def _parts_of_time(formula: Formula) -> list[ast.expr]:
    """Return the largest parts that depend on time only, except table arguments: tables extrapolate linearly."""
    if not formula.uses_time:
        return []
    return [part for part in _divided(formula.tree, formula)[1] if isinstance(part, ast.expr)]


def _divided(node: ast.AST, formula: Formula) -> tuple[bool, list[ast.AST]]:
    """Return whether a part depends on time only, and its largest parts that do."""
    of_time, found = not _is_of_state(node, formula), list[ast.AST]()
    for child in ast.iter_child_nodes(node):
        child_of_time, parts = _divided(child, formula)
        of_time = of_time and child_of_time
        found += parts
    if of_time:
        return True, [node]
    return False, [] if isinstance(node, ast.Call) and (is_named(node) or _is_table(node, formula)) else found


def _is_of_state(node: ast.AST, formula: Formula) -> bool:
    """Return True if a node is a coordinate, state, measure, reaction, table or variable of its field."""
    match node:
        case ast.Attribute():
            return f"{UNIT}.{node.attr}" not in formula.values
        case ast.Name():
            return node.id in formula.variables or node.id in formula.tables or node.id in formula.states
    return is_named(node)


def _is_table(node: ast.Call, formula: Formula) -> bool:
    return isinstance(node.func, ast.Name) and node.func.id in formula.tables


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


def _of_node(
    name: str, formula: Formula, part: ast.expr, node: ast.expr, start: float, end: float
) -> Iterator[InputEnd]:
    """Yield the first end of a part of a formula caused by one of its nodes."""

    evaluated = Input(part, formula.text, formula.values, {})

    def value(t: float) -> float | None:
        with np.errstate(all="ignore"):  # cosh may overflow in a denominator
            found = float(evaluated.at(np.array([t]))[0])
        return found if np.isfinite(found) else None

    for low, high in _without_bound(formula, node, start, end):
        size = max(abs(low), abs(high), end - start)
        pole = _is_pole(value, low, high, size)
        if pole or _has_no_value_beyond(value, high, size):
            near = _pole_distance(value, low, size) if pole else NEARER_SIDE * size
            yield InputEnd(low, near, name, ast.unparse(node), pole)
            return


def _without_bound(formula: Formula, node: ast.expr, start: float, end: float) -> Iterator[tuple[float, float]]:
    """Yield the shortest intervals over which a node is unbounded, in ascending order and separated."""
    waiting, divisions, passed = [(start, end)], 0, start
    while waiting and divisions < MOST_DIVISIONS:
        first, last = waiting.pop()
        size = max(abs(first), abs(last), end - start)
        if last < passed:
            continue
        if last - first <= SHORTEST_DIVIDED * size:
            yield first, last
            passed = last + FARTHER_SIDE * size
            continue
        edges = np.linspace(first, last, PARTS_OF_A_STRETCH + 1)
        with np.errstate(all="ignore"):
            bounded = _is_bounded(formula, node, edges[:-1], edges[1:])
        divisions += 1
        waiting += [(float(edges[k]), float(edges[k + 1])) for k in np.flatnonzero(~bounded)[::-1]]


def _is_bounded(formula: Formula, node: ast.expr, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Return True for intervals with a bounded range and with arguments inside the node's domain."""
    bounded = np.isfinite(_range(formula, node, low, high)).all(axis=0)
    match node:
        case ast.Call(ast.Name(name), [argument]) if name in DOMAINS:
            least, most = DOMAINS[name]
        case ast.BinOp(argument, ast.Pow(), _):
            least, most = 0.0, np.inf
        case _:
            return bounded
    inside = _range(formula, argument, low, high)
    return bounded & (inside[0] >= least) & (inside[1] <= most)


def _range(formula: Formula, node: ast.expr, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Return the ranges of a node over time intervals, shape (2, n)."""
    t = Enclosure.of_time(low, high)

    def constant(number: float) -> Enclosure:
        return t.constant(number)

    def names(name: str) -> Enclosure:
        return t if name == TIME else constant(formula.values[name])

    return evaluate(node, names, FUNCTIONS, constant).value


def _is_pole(value: Values, low: float, high: float, size: float) -> bool:
    """Return True if values grow towards the time on either side."""
    for at, way in ((low, -1.0), (high, 1.0)):
        far, near = value(at + way * FARTHER_SIDE * size), value(at + way * NEARER_SIDE * size)
        if far is not None and near is not None and abs(near) > GROWS * abs(far) > 0.0:
            return True
    return False


def _has_no_value_beyond(value: Values, high: float, size: float) -> bool:
    return all(value(high + distance * size) is None for distance in (NEARER_SIDE, 10 * NEARER_SIDE))


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
