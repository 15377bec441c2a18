"""From a kind's shapes to the symbolic element that its equations are written in."""

from __future__ import annotations

import ast
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import sympy as sp

from ..describe.formula import evaluate
from ..describe.formula_field import TIME
from .frames import MARKER_NUMBERS, BodyFrame, Frame, SymbolicElement
from .kind import Kind, Shape
from .spline import Spline


@dataclass
class Symbols:
    """The symbols of one kind.

    Attributes
    ----------
    element : SymbolicElement
        For the equations.
    numbers : list of Symbol
        In the order of `ElementData.numbers`; integer ones are offsets of tables.
    joint_lam : list of list of Symbol
        Multipliers of each joint that is referred to.
    switches : list of expressions
        What changes its sign at the corners in the state of the formulas (``abs``, ``step``, ...).
    """

    element: SymbolicElement
    numbers: list[sp.Symbol] = field(default_factory=list)
    joint_lam: list[list[sp.Symbol]] = field(default_factory=list)
    switches: list[sp.Expr] = field(default_factory=list)


def symbols_of(kind: Kind) -> Symbols:
    """Make a kind's symbols and its element."""
    frames = [BodyFrame(slot) for slot in range(kind.n_bodies)]
    symbols = Symbols(SymbolicElement(frames, {}))
    builder = _Builder(frames, symbols)
    symbols.element.__dict__.update({name: builder.made(name, shape) for name, shape in kind.fields})
    return symbols


class _Builder:
    def __init__(self, frames: list[BodyFrame], symbols: Symbols) -> None:
        self.frames, self.symbols = frames, symbols

    def fresh(self, name: str, **assumptions: bool) -> sp.Symbol:
        """A new symbol for the next number."""
        symbol = sp.Symbol(f"{name}_{len(self.symbols.numbers)}", **(assumptions or {"real": True}))
        self.symbols.numbers.append(symbol)
        return symbol

    def made(self, name: str, shape: Shape) -> Any:
        """What stands for a field in the equations."""
        match shape:
            case ("number",):
                return self.fresh(name)
            case ("choice", value):
                return value
            case ("marker", slot):
                return self.marker(name, slot)
            case ("several", shapes):
                return tuple(self.made(f"{name}{k}", part) for k, part in enumerate(shapes))
            case ("table",):
                offset = self.fresh(name, integer=True)
                return lambda x: Spline(x, offset, sp.Integer(0))
            case ("formula", text, n_variables, n_numbers, measures):
                return self.formula(name, text, n_variables, n_numbers, measures)
            case ("joint", element, fields, slot):
                return self.joint(name, element, fields, slot)
        raise TypeError(f"no such shape: {shape}")

    def marker(self, name: str, slot: int) -> Frame:
        """A frame with new symbols for its numbers."""
        return Frame(self.frames[slot], tuple(self.fresh(f"{name}_{part}") for part in MARKER_NUMBERS))

    def joint(self, name: str, element: Any, fields: tuple[tuple[str, Shape], ...], slot: int) -> SymbolicElement:
        """A joint that is referred to: its own fields, its coordinate, and symbols for its multipliers."""
        own = {field_name: self.made(f"{name}_{field_name}", shape) for field_name, shape in fields}
        joint: Any = SymbolicElement(self.frames, own)
        count = len(list(element.position(joint))) + len(list(element.velocity(joint)))
        joint.lam = [sp.Symbol(f"joint{slot}_lam{k}", real=True) for k in range(count)]
        joint.kind = element.kind
        joint.coordinate = element.coordinate(joint)
        self.symbols.joint_lam.append(joint.lam)
        return joint

    def formula(self, name: str, text: str, n_variables: int, n_numbers: int, measures: tuple[Any, ...]) -> Any:
        """A formula's expression, or a function of its variables where it has such."""
        numbers = [self.fresh(f"{name}_p") for _ in range(n_numbers)]
        measured = [
            self.measure(measure, [self.marker(f"{name}_{k}", slot) for k, (_, slot) in enumerate(shapes)])
            for measure, shapes in measures
        ]

        def names(variables: tuple[sp.Expr, ...]) -> Callable[[str], sp.Expr]:
            def value(word: str) -> sp.Expr:
                owner, _, coordinate = word.partition(".")
                if coordinate:
                    return self.frames[int(owner[1:])].coordinate(coordinate)
                if word == TIME:
                    return SymbolicElement.t
                if word.startswith("measure"):
                    return measured[int(word[7:])]
                return (numbers if word[0] == "p" else variables)[int(word[1:])]

            return value

        tree = ast.parse(text, mode="eval").body

        def function(*variables: sp.Expr) -> sp.Expr:
            return sp.sympify(evaluate(tree, names(variables), self.functions(), sp.sympify))

        return function if n_variables else function()

    def functions(self) -> dict[str, Callable[..., sp.Expr]]:
        """The functions of formulas; those with corners note where they are, if it is in the state."""
        e = self.symbols.element

        def noting(function: Callable[..., sp.Expr], corners: Callable[..., tuple[sp.Expr, ...]]) -> Any:
            def called(*arguments: sp.Expr) -> sp.Expr:
                for corner in corners(*arguments):
                    if {*e.q, *e.u} & sp.sympify(corner).free_symbols:
                        self.symbols.switches.append(corner)
                return function(*arguments)

            return called

        return SMOOTH | {name: noting(function, corners) for name, (function, corners) in CORNERED.items()}

    def measure(self, name: str, markers: list[Frame]) -> sp.Expr:
        """A measure between two markers, named as in Adams, in ground axes."""
        e, (a, b) = self.symbols.element, markers
        d = a.point - b.point
        distance = e.distance(a.point, b.point)
        match name:
            case "dx":
                return d[0]
            case "dy":
                return d[1]
            case "dm":
                return distance
            case "az":
                return a.angle - b.angle
            case "vx":
                return e.rate(d[0])
            case "vy":
                return e.rate(d[1])
            case "vm":
                return e.distance(sp.Matrix([e.rate(d[0]), e.rate(d[1])]), sp.zeros(2, 1))
            case "vr":
                return e.rate(distance)
            case _:
                return e.rate(a.angle - b.angle)


def step(x: sp.Expr, x0: sp.Expr, h0: sp.Expr, x1: sp.Expr, h1: sp.Expr) -> sp.Expr:
    """Adams' STEP: from h0 at x0 to h1 at x1 by a cubic with flat ends."""
    z = (x - x0) / (x1 - x0)
    return sp.Piecewise((h0, x <= x0), (h1, x >= x1), (h0 + (h1 - h0) * z**2 * (3 - 2 * z), True))


def step5(x: sp.Expr, x0: sp.Expr, h0: sp.Expr, x1: sp.Expr, h1: sp.Expr) -> sp.Expr:
    """Adams' STEP5: from h0 at x0 to h1 at x1 by a quintic without curvature at its ends."""
    z = (x - x0) / (x1 - x0)
    return sp.Piecewise((h0, x <= x0), (h1, x >= x1), (h0 + (h1 - h0) * z**3 * (10 - 15 * z + 6 * z**2), True))


def greater(first: sp.Expr, *others: sp.Expr) -> sp.Expr:
    """The greatest of its arguments, with the derivative of that one."""
    for other in others:
        first = sp.Piecewise((first, first >= other), (other, True))
    return first


def less(first: sp.Expr, *others: sp.Expr) -> sp.Expr:
    """The least of its arguments, with the derivative of that one."""
    for other in others:
        first = sp.Piecewise((first, first <= other), (other, True))
    return first


def sign(x: sp.Expr) -> sp.Expr:
    """-1 or 1, with derivative zero."""
    return sp.Piecewise((sp.Integer(1), x >= 0), (sp.Integer(-1), True))


def magnitude(x: sp.Expr) -> sp.Expr:
    """The absolute value."""
    return sp.Piecewise((x, x >= 0), (-x, True))


SMOOTH: dict[str, Callable[..., sp.Expr]] = {
    name: getattr(sp, name)
    for name in (
        "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "exp", "log", "sqrt",
    )
}  # fmt: skip


def _differences(first: sp.Expr, *others: sp.Expr) -> tuple[sp.Expr, ...]:
    return tuple(first - other for other in others)


CORNERED: dict[str, tuple[Callable[..., sp.Expr], Callable[..., tuple[sp.Expr, ...]]]] = {
    "abs": (magnitude, lambda x: (x,)),
    "sign": (sign, lambda x: (x,)),
    "min": (less, _differences),
    "max": (greater, _differences),
    "step": (step, lambda x, x0, h0, x1, h1: (x - x0, x - x1)),
    "step5": (step5, lambda x, x0, h0, x1, h1: (x - x0, x - x1)),
}
"""Functions with corners, and what is zero there."""
