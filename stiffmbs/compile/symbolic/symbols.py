"""Construction of the symbolic element of a kind from the shapes of its fields."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import sympy as sp

from ...elements.element import Joint
from ...reading.formula.functions import EACH, FUNCTIONS, IN_FORMULAS, Breakpoints, FormulaFunction
from ...reading.formula.names import REACTIONS
from ...reading.formula.nodes import TIME
from ...reading.formula.text import evaluate
from ..bodies import SPACE
from ..formula_shape import OWN, REACTION, STATE, Shape
from ..kind import Kind
from . import nonsmooth, planar_frames, spatial_frames
from .continuous_angle import counter
from .differentiate import Derivatives
from .element import COINCIDENT, SymbolicElement
from .referred import ReferredJoint, SymbolicComponent, measure, own_coordinate
from .spline import Spline, python_law

NARROW: dict[type[sp.Basic], str] = {
    getattr(sp, name): function.intervals for name, function in FUNCTIONS.items() if function.intervals
}
"""Functions with narrow features where their argument is steep, and the names of their intervals."""


STEEP = 10
"""Integer power from which on it is treated as exp(n log |x|), as is a variable power."""


INTERNAL = re.compile(
    "|".join((*SPACE.positions, *SPACE.velocities, *SPACE.accelerations))
    + r"|a\d\d|e\d|phi\d|n|size|turn\d+|carried\d+_\d+|s"
)
"""Stems of the symbols of bodies, rotations and common subexpressions, followed by ``_`` and a number."""


@dataclass(frozen=True)
class Law:
    """Table or function with breakpoints (`stiffmbs.compile.law_intervals`) whose argument depends on the state.

    `of`: name of its intervals (``turn`` for the argument of a sine) and, for ``table``, the index of its offset in
    the element's numbers, else 0.
    """

    argument: sp.Expr
    of: tuple[str, int]


@dataclass
class Symbols:
    """Symbols of one kind.

    - `element`: for the equations.
    - `numbers`: in the order of `ElementData.numbers`; integer ones are offsets of tables.
    - `joint_lam`: multipliers of each joint referred to.
    - `event_functions`: event functions of formulas (``abs``, ``step``, ...) that depend on the state.
    """

    element: SymbolicElement
    numbers: list[sp.Symbol] = field(default_factory=list)
    joint_lam: list[list[sp.Symbol]] = field(default_factory=list)
    event_functions: list[sp.Expr] = field(default_factory=list)
    laws: list[Law] = field(default_factory=list)

    @property
    def pressed(self) -> list[sp.Symbol]:
        """Multipliers of all joints referred to."""
        return [symbol for lam in self.joint_lam for symbol in lam]

    @property
    def arguments(self) -> sp.Matrix:
        """Arguments of laws; each depends on the state, so none is dropped as zero."""
        return sp.Matrix([law.argument for law in self.laws])

    def in_state(self, expression: sp.Expr) -> bool:
        """Return True if an expression depends on coordinates, velocities, states or reactions."""
        return self.element.in_state(expression) or self.element.depends(expression, self.pressed)

    def known(self) -> frozenset[sp.Symbol]:
        """Return all defined symbols."""
        e = self.element
        of_bodies = (s for f in e.frames for s in (*f.q, *f.u, *f.a, *f.turn, *f.pose, *f.velocities))
        counters = map(counter, range(len(e.angles)))
        return (
            frozenset((e.t, *self.numbers, *of_bodies, *e.states, *self.pressed, *counters)) | e.derivatives.defined()
        )

    def note_law(self, argument: sp.Expr, name: str, table: sp.Symbol | None = None) -> None:
        """Record the argument of a table or function with narrow features if it depends on the state."""
        law = Law(argument, (name, 0 if table is None else self.numbers.index(table)))
        if self.in_state(argument) and law not in self.laws:
            self.laws.append(law)

    def note_functions(self, expression: sp.Expr) -> None:
        """Record the functions with narrow features in an expression."""
        for part in sp.preorder_traversal(expression):
            if type(part) in NARROW:
                self.note_law(part.args[0], NARROW[type(part)])
            elif isinstance(part, sp.tan):
                self.note_law(sp.cos(part.args[0]), "reciprocal")
            elif isinstance(part, sp.Pow) and part.exp.is_Number and part.exp < 0:
                self.note_law(part.base, "reciprocal")
            elif isinstance(part, sp.Pow) and not (part.exp.is_Number and part.exp < STEEP):
                self.note_law(part.exp * sp.log(part.base**2 + COINCIDENT) / 2, "exp")


def symbols_of(kind: Kind) -> Symbols:
    """Return a kind's symbols and its element."""
    derivatives, slots = Derivatives(), range(kind.n_bodies)
    frames = (
        [planar_frames.BodyFrame(slot) for slot in slots]
        if kind.dimensions == 2
        else [
            spatial_frames.SpatialBodyFrame(slot, derivatives, kind.spins[slot] if kind.spins else "") for slot in slots
        ]
    )
    states = [sp.Symbol(f"{STATE}{slot}", real=True) for slot in range(kind.n_states)]
    symbols = Symbols(SymbolicElement(frames, {}, derivatives, states, kind.n_own))
    builder = _Builder(kind.dimensions, symbols)
    symbols.element.__dict__.update({name: builder.made(name, shape) for name, shape in kind.fields})
    return symbols


class _Builder:
    def __init__(self, dimensions: int, symbols: Symbols) -> None:
        self.dimensions, self.frames, self.symbols = dimensions, symbols.element.frames, symbols

    def fresh(self, name: str, **assumptions: bool) -> sp.Symbol:
        """Return a new symbol for the next number."""
        stem = f"{name}_field" if INTERNAL.fullmatch(name) else name
        symbol = sp.Symbol(f"{stem}_{len(self.symbols.numbers)}", **(assumptions or {"real": True}))
        self.symbols.numbers.append(symbol)
        return symbol

    def made(self, name: str, shape: Shape) -> Any:
        """Return the symbolic form of a field."""
        match shape:
            case ("number",):
                return self.fresh(name)
            case ("choice", value):
                return value
            case ("state", slot):
                return self.symbols.element.states[slot]
            case ("marker", slot):
                return self.marker(name, slot)
            case ("several", shapes):
                return tuple(self.made(f"{name}{k}", part) for k, part in enumerate(shapes))
            case ("table",):
                offset = self.fresh(name, integer=True)
                return lambda x: self.spline(offset, x)
            case ("python",):
                return python_law(self.fresh(name), self.symbols.element.read)
            case ("formula", text, counts, measures, *reactions):
                return self.formula(name, text, counts, measures, *reactions)
            case ("component", component, fields):
                return SymbolicComponent(component, {part: self.made(part, shape) for part, shape in fields})
            case ("joint", element, fields, slot, coordinate):
                return self.joint(name, element, fields, slot, coordinate)
        raise TypeError(f"no such shape: {shape}")

    def marker(self, name: str, slot: int) -> Any:
        """Return a frame with new symbols for its numbers."""
        if self.dimensions == 2:
            numbers = tuple(self.fresh(f"{name}_{part}") for part in planar_frames.MARKER_NUMBERS)
            return planar_frames.Frame(self.frames[slot], numbers)
        numbers = tuple(self.fresh(f"{name}_{part}") for part in spatial_frames.MARKER_NUMBERS)
        return spatial_frames.SpatialFrame(self.frames[slot], numbers)

    def joint(
        self, name: str, element: Joint, fields: tuple[tuple[str, Shape], ...], slot: int, coordinate: str | None
    ) -> ReferredJoint:
        """Return a joint that is referred to."""
        own = {field_name: self.made(f"{name}_{field_name}", shape) for field_name, shape in fields}
        joint = ReferredJoint(self.symbols.element, element, own, coordinate, slot)
        self.symbols.joint_lam.append(joint.lam)
        return joint

    def formula(
        self, name: str, text: str, counts: tuple[int, int, int], measures: Shape, reactions: Shape = ()
    ) -> Any:
        """Return a formula's expression, or a function of its variables; `counts`: variables, numbers, tables."""
        n_variables, n_numbers, n_tables = counts
        numbers = [self.fresh(f"{name}_p") for _ in range(n_numbers)]
        measured = [
            self.measure(measure, [self.marker(f"{name}_{k}", slot) for k, (_, slot) in enumerate(shapes)])
            for measure, shapes in measures
        ]

        tables = {f"table{k}": partial(self.spline, self.fresh(f"{name}_t", integer=True)) for k in range(n_tables)}

        pressed = self.reactions(name, reactions)

        def names(variables: tuple[sp.Expr, ...]) -> Callable[[str], sp.Expr]:
            def value(word: str) -> sp.Expr:
                """Return the expression that a name of the formula stands for."""
                owner, _, coordinate = word.partition(".")
                if coordinate:
                    return self.frames[int(owner[1:])].coordinate(coordinate)
                if word == TIME:
                    return SymbolicElement.t
                if word.startswith(STATE):
                    return self.symbols.element.states[int(word[len(STATE) :])]
                if word.startswith(REACTION):
                    return pressed[int(word[len(REACTION) :])]
                if word.startswith("measure"):
                    return measured[int(word[7:])]
                return (numbers if word[0] == "p" else variables)[int(word[1:])]

            return value

        tree = ast.parse(text, mode="eval").body

        def function(*variables: sp.Expr) -> sp.Expr:
            """Return the expression of the formula at its variables."""
            functions = self.functions() | tables
            expression = sp.sympify(evaluate(tree, names(variables), functions, sp.sympify))
            if expression.has(sp.Abs):  # SymPy turns sqrt(x^2) into Abs
                expression = expression.replace(sp.Abs, functions["abs"])
            self.symbols.note_functions(expression)
            return expression

        return function if n_variables else function()

    def reactions(self, name: str, wanted: tuple[tuple[str, Shape], ...]) -> list[sp.Expr]:
        """Return components of the reactions of joints, their coordinates, and the rates of these."""
        joints = {
            shape: self.made(f"{name}_j{k}", shape)
            for k, shape in enumerate(dict.fromkeys(shape for _, shape in wanted))
        }
        known: dict[Shape, dict[str, sp.Expr]] = {}
        for component, shape in wanted:
            if component in REACTIONS and shape not in known:
                _, _, fields, *_ = shape
                first = next(field[1] for _, field in fields if field[0] == "marker")
                known[shape] = self.symbols.element.reaction(joints[shape], self.frames[first])
        return [
            known[shape][component] if component in REACTIONS else joints[shape].channel(component)
            for component, shape in wanted
        ]

    def _of_direction(self, argument: sp.Expr) -> bool:
        """Return True if an argument contains an angle of a direction, which jumps by a full turn."""
        meanings = self.symbols.element.meanings
        return any(x.has(sp.atan2) for x in (argument, *(meanings.get(s, s) for s in argument.free_symbols)))

    def functions(self) -> dict[str, Callable[..., sp.Expr]]:
        """Return the functions of formulas; those with breakpoints record them if they depend on the state."""

        def noting(name: str, function: FormulaFunction) -> Any:
            def turning(argument: sp.Expr) -> sp.Expr:
                self.symbols.note_law(argument, "direction" if self._of_direction(argument) else "turn")
                return SMOOTH[name](argument)

            def called(*arguments: sp.Expr) -> sp.Expr:
                for breakpoint in _breakpoints(function, arguments):
                    if self.symbols.in_state(breakpoint) and breakpoint not in self.symbols.event_functions:
                        self.symbols.event_functions.append(breakpoint)
                return getattr(nonsmooth, function.symbolic)(*arguments)

            return turning if function.turns else SMOOTH.get(name, called)

        return {name: noting(name, function) for name, function in IN_FORMULAS.items()}

    def measure(self, name: str, markers: list[Any]) -> sp.Expr:
        """Return a measure between markers, or a coordinate of a spatial body in its own axes."""
        if name.startswith(OWN):
            return own_coordinate(name.removeprefix(OWN), markers[0])
        return measure(name, self.symbols.element, markers)

    def spline(self, table: sp.Symbol, x: sp.Expr) -> sp.Expr:
        """Return the value of the table at an offset."""
        argument = sp.sympify(x)
        self.symbols.note_law(argument, "table of a direction" if self._of_direction(argument) else "table", table)
        return Spline(x, table, sp.Integer(0))


def _breakpoints(function: FormulaFunction, arguments: tuple[sp.Expr, ...]) -> Iterator[sp.Expr]:
    """Yield the expressions that are zero at a function's breakpoints."""
    each: Breakpoints = tuple((0, k) for k in range(1, len(arguments)))
    for i, k in each if function.breakpoints == EACH else function.breakpoints:
        yield arguments[i] if k is None else arguments[i] - arguments[k]


SMOOTH: dict[str, Callable[..., sp.Expr]] = {
    name: getattr(sp, name) for name, function in FUNCTIONS.items() if function.in_c
}
