"""Inputs of a scene: tables of time, and the largest parts of formulas that depend on time only."""

from __future__ import annotations

import ast
import copy
from collections.abc import Callable, Collection, Hashable, Iterator, Mapping, Set
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, get_args

import numpy as np

from ...elements.element import Element, Joint
from ...reading.formula.field import FormulaOf
from ...reading.formula.formula import Formula
from ...reading.formula.functions import IN_FORMULAS
from ...reading.formula.nodes import TIME, is_named, parts_of
from ...reading.formula.text import BINARY, UNARY, UNIT
from ...reading.table import Table
from ..system import System
from .enclosed_functions import FUNCTIONS as ENCLOSED
from .interval_arithmetic import Enclosure
from .table_ranges import TableRanges

WRITTEN = "written"
"""Node attribute that caches its dump."""
OF_TIME = "of_time"
"""Node attribute that caches the parts of a formula that use time alone."""
TABLE = "table"
"""Function name of a field's own table of time."""


@dataclass(frozen=True, eq=False)
class Input:
    """Expression of time only, compared by content.

    `text`: for messages. `values`: parameters, units and constants by name. `of_joint`: true if it may prescribe a
    position, whose second derivative acts.
    """

    tree: ast.expr
    text: str
    values: Mapping[str, float]
    tables: Mapping[str, TableRanges]
    of_joint: bool = False

    @cached_property
    def _says(self) -> tuple[Hashable, ...]:
        tables = tuple((name, id(ranges.table)) for name, ranges in sorted(self.tables.items()))
        return self.text, _written(self.tree), tuple(sorted(self.values.items())), tables, self.of_joint

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Input) and self._says == other._says

    def __hash__(self) -> int:
        return hash(self._says)

    def at(self, t: np.ndarray, part: ast.expr | None = None) -> np.ndarray:
        """Return the values of the expression, or of a part of it, at given times, shape (n,)."""
        return evaluated_at(part or self.tree, t, self.values, self.tables)

    def within(self, low: np.ndarray, high: np.ndarray, order: int = 1, part: ast.expr | None = None) -> Enclosure:
        """Return ranges of the values and Taylor coefficients over time intervals."""
        t = Enclosure.of_time(low, high, order)
        middle = _Evaluation((low + high) / 2, self.values, _of_arrays(self.tables))
        evaluation = _Ranges(t, self.values, _of_enclosures(self.tables), middle, (high - low) / 2)
        return t.constant(evaluation.value(part or self.tree))


def evaluated_at(
    tree: ast.expr, t: np.ndarray, values: Mapping[str, float], tables: Mapping[str, TableRanges]
) -> np.ndarray:
    """Return the values of an expression at given times, shape (n,)."""
    found = _Evaluation(t, values, _of_arrays(tables)).value(tree)
    return np.broadcast_to(np.asarray(found, dtype=float), t.shape)


def evaluated_within(
    tree: ast.expr, low: np.ndarray, high: np.ndarray, order: int, values: Mapping[str, Any],
    tables: Mapping[str, TableRanges],
) -> Enclosure:  # fmt: skip
    """Return ranges of the values and Taylor coefficients of an expression over time intervals; values may be enclosures."""
    t = Enclosure.of_time(low, high, order)
    return t.constant(_Evaluation(t, values, _of_enclosures(tables)).value(tree))


def _of_arrays(tables: Mapping[str, TableRanges]) -> dict[str, Callable[..., object]]:
    return _OF_ARRAYS | {name: table.values for name, table in tables.items()}


def _of_enclosures(tables: Mapping[str, TableRanges]) -> dict[str, Callable[..., object]]:
    return _OF_ENCLOSURES | {name: _by_argument(table.values, table.enclosed) for name, table in tables.items()}


class _Evaluation:
    """Evaluation of parts of a formula in one algebra; repeated parts are evaluated once."""

    def __init__(self, t: Any, values: Mapping[str, Any], functions: Mapping[str, Callable[..., object]]) -> None:
        self._t, self._values, self._functions = t, values, functions
        self._known: dict[str, object] = {}

    def value(self, node: ast.expr) -> Any:
        """Return the value of a node."""
        match node:
            case ast.Constant(int() | float() as number):
                return float(number)
            case ast.Name(name):
                return self._t if name == TIME else self._values[name]
            case ast.Attribute(_, name):
                return self._values[f"{UNIT}.{name}"]
        key = _written(node)
        if key not in self._known:
            self._known[key] = self._computed(node)
        return self._known[key]

    def _computed(self, node: ast.expr) -> Any:
        match node:
            case ast.BinOp(left, op, right):
                return BINARY[type(op)](*(_number(self.value(side)) for side in (left, right)))
            case ast.UnaryOp(op, operand):
                return UNARY[type(op)](self.value(operand))
            case ast.Call(ast.Name(name), arguments):
                return self._functions[name](*(self.value(argument) for argument in arguments))
        raise TypeError(f"no such part of a formula: {ast.dump(node)}")


class _Ranges(_Evaluation):
    """Enclosures of parts of a formula, narrowed by the values at interval midpoints (mean value form)."""

    def __init__(
        self, t: Enclosure, values: Mapping[str, float], functions: Mapping[str, Callable[..., object]], middle: _Evaluation,
        half: np.ndarray,
    ) -> None:  # fmt: skip
        super().__init__(t, values, functions)
        self._middle, self._half = middle, half

    def _computed(self, node: ast.expr) -> Any:
        found = super()._computed(node)
        return found.narrowed(self._middle.value(node), self._half) if isinstance(found, Enclosure) else found


def _written(node: ast.expr) -> str:
    """Return the dump of a node, cached in the node."""
    known: str | None = getattr(node, WRITTEN, None)
    if known is None:
        known = ast.dump(node)
        setattr(node, WRITTEN, known)
    return known


def _number(value: object) -> Any:
    """Return numbers as NumPy scalars, which divide by zero without an exception."""
    return np.float64(value) if isinstance(value, float) else value


@dataclass(frozen=True)
class Given:
    """Values of the model's inputs, by name: constants, and tables of time. Other names of states depend on the motion."""

    constants: Mapping[str, float] = field(default_factory=dict)
    tables: Mapping[str, Table] = field(default_factory=dict)


NONE_GIVEN = Given()


def given_to(system: System) -> Given:
    """Return the values of the inputs of a system's model."""
    return given_in(system.outputs)


def given_in(outputs: Mapping[str, Formula]) -> Given:
    """Return the values of the inputs among the formulas of outputs."""
    constants: dict[str, float] = {}
    tables: dict[str, Table] = {}
    for name, formula in outputs.items():
        match formula.tree:
            case ast.Constant(float() as number):
                constants[name] = number
            case ast.Call(ast.Name(table), [ast.Name(argument)]) if table in formula.tables and argument == TIME:
                tables[name] = formula.tables[table]
    return Given(constants, tables)


def in_formulas_of_time(system: System, name: str) -> bool:
    """Return True if breakpoints or step limits of time inputs may depend on a constant input of the model."""
    given = given_to(system)
    elements = (element for group in system.groups if group.has_inputs for element in group.elements)
    return any(name in values for element in elements for _, _, values, _ in expressions_of(element, given))


def inputs_of(system: System) -> list[Input]:
    """Return the distinct time inputs of all elements."""
    found: dict[Input, None] = {}
    given = given_to(system)
    known: dict[int, TableRanges] = {}

    def ranges_of(table: Table) -> TableRanges:
        return known.setdefault(id(table), known.get(id(table)) or TableRanges(table))

    for group in system.groups:
        for element in group.elements if group.has_inputs else ():
            for expression, text, values, tables in expressions_of(element, given):
                ranges = {name: ranges_of(table) for name, table in tables.items()}
                found.setdefault(Input(expression, text, values, ranges, isinstance(element, Joint)))
    return list(found)


def _without_roots(tree: ast.expr) -> ast.expr:
    """Return the expression with roots of squares as absolute values; itself if it has no roots."""
    has_roots = any(
        (isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "sqrt")
        or isinstance(node, ast.Pow)
        for node in ast.walk(tree)
    )
    return _WithoutRoots().visit(copy.deepcopy(tree)) if has_roots else tree


class _WithoutRoots(ast.NodeTransformer):
    """Replace sqrt(x^2), sqrt(x*x) and (x^2)^0.5 by abs(x), whose breakpoint the range of a root does not show."""

    def visit_Call(self, node: ast.Call) -> ast.expr:
        """Replace the root of a square."""
        self.generic_visit(node)
        match node:
            case ast.Call(ast.Name("sqrt"), [inner]) if (x := _squared(inner)) is not None:
                return ast.Call(ast.Name("abs", ast.Load()), [x], [])
        return node

    def visit_BinOp(self, node: ast.BinOp) -> ast.expr:
        """Replace a square to the power of 0.5."""
        self.generic_visit(node)
        match node:
            case ast.BinOp(inner, ast.Pow(), ast.Constant(0.5)) if (x := _squared(inner)) is not None:
                return ast.Call(ast.Name("abs", ast.Load()), [x], [])
        return node


def _squared(node: ast.expr) -> ast.expr | None:
    match node:
        case ast.BinOp(x, ast.Pow(), ast.Constant(2)):
            return x
        case ast.BinOp(x, ast.Mult(), y) if ast.dump(x) == ast.dump(y):
            return x
    return None


def expressions_of(
    element: Element, given: Given = NONE_GIVEN
) -> Iterator[tuple[ast.expr, str, Mapping[str, float], Mapping[str, Table]]]:
    """Yield the expressions of time of an element with their text, values and tables; `given` values of inputs are constants."""
    for _, formula in element.parts(Formula):
        of_time = [name for name in formula.states if name in given.tables]
        if not (formula.uses_time or of_time):
            continue
        tables = {**formula.tables, **{_OF_TIME.format(name): given.tables[name] for name in of_time}}
        for part, names in _of_time_alone(formula, given, of_time):
            constants = {name: given.constants[name] for name in names if name in given.constants}
            used = {name: tables[name] for name in names if name in tables}
            yield part, formula.text, {**formula.values, **constants}, used
    for name, table in element.parts(Table):
        if _is_of_time(element, name):
            called = ast.Call(ast.Name(TABLE, ast.Load()), [ast.Name(TIME, ast.Load())], [])
            written = type(element).model_fields[name].alias or name
            yield called, f"the table {written}", {}, {TABLE: table}


def _is_of_time(element: Element, name: str) -> bool:
    """Return True if a field's formula or table is a function of time, without variables of its own."""
    field = type(element).model_fields[name]
    marks = [mark for mark in _marks(field.metadata, field.annotation) if isinstance(mark, FormulaOf)]
    return any(not mark.variables for mark in marks)


def _marks(metadata: list[object], annotation: object) -> Iterator[object]:
    yield from metadata
    yield from getattr(annotation, "__metadata__", ())
    for part in get_args(annotation):
        yield from _marks([], part)


_OF_TIME = "{}(t)"
"""Function name of an input that is a table of time; no name in a scene has parentheses."""


def _of_time_alone(formula: Formula, given: Given, called: Collection[str]) -> list[tuple[ast.expr, list[str]]]:
    """Return the largest parts of a formula that use time and no state, and the names in them.

    `called`: inputs that are tables of time. The parts are kept in the tree: every run needs them.
    """
    constants = frozenset(name for name in formula.states if name in given.constants)
    of_state = frozenset((*formula.variables, *formula.states)) - constants - frozenset(called)
    known: dict[Hashable, list[tuple[ast.expr, list[str]]]] = vars(formula.tree).setdefault(OF_TIME, {})
    key = of_state, constants, frozenset(called)
    if key not in known:
        tree = _CallsOfTime(called).visit(copy.deepcopy(formula.tree)) if called else formula.tree
        parts = (_without_factors(part, constants) for part in _largest_parts(tree, of_state)[2])
        known[key] = [(_without_roots(part), _names(part)) for part in parts]
    return known[key]


class _CallsOfTime(ast.NodeTransformer):
    """Replace names of inputs by calls of their tables."""

    def __init__(self, names: Collection[str]) -> None:
        self._called = names

    def visit_Name(self, node: ast.Name) -> ast.expr:
        if node.id not in self._called:
            return node
        return ast.Call(ast.Name(_OF_TIME.format(node.id), ast.Load()), [ast.Name(TIME, ast.Load())], [])


def _without_factors(part: ast.expr, constants: frozenset[str]) -> ast.expr:
    """Return an expression without factors and terms of constant inputs, which move no breakpoint of it."""
    match part:
        case ast.BinOp(left, ast.Add() | ast.Sub() | ast.Mult(), right):
            sides = [(left, right), (right, left)]
        case ast.BinOp(left, ast.Div(), right):
            sides = [(right, left)]
        case _:
            return part
    for side, other in sides:
        names = _names(side)
        if TIME not in names and not constants.isdisjoint(names):
            return _without_factors(other, constants)
    return part


def _names(tree: ast.expr) -> list[str]:
    return [node.id for node in ast.walk(tree) if isinstance(node, ast.Name)]


def _largest_parts(node: ast.expr, of_state: Set[str]) -> tuple[bool, bool, list[ast.expr]]:
    """Return whether a part uses time, whether it uses state or field variables, and its largest parts of time only."""
    match node:
        case ast.Name(name):
            time, state = name == TIME, name in of_state
        case ast.Attribute(ast.Name(owner)):
            time, state = False, owner != UNIT
        case _:
            time, state = False, is_named(node)
    found: list[ast.expr] = []
    for child in parts_of(node):
        of_time, of_child, parts = _largest_parts(child, of_state)
        time, state = time or of_time, state or of_child
        found += parts
    return time, state, [node] if time and not state else found


def _by_argument(of_numbers: Callable[..., object], of_enclosures: Callable[..., object]) -> Callable[..., object]:
    """Return a function that also accepts constants of formulas."""
    return lambda *x: (of_enclosures if any(isinstance(part, Enclosure) for part in x) else of_numbers)(*x)


_OF_ARRAYS: dict[str, Callable[..., object]] = {name: function.array for name, function in IN_FORMULAS.items()}
_OF_ENCLOSURES = {name: _by_argument(of_arrays, ENCLOSED[name]) for name, of_arrays in _OF_ARRAYS.items()}
