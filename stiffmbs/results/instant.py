"""Channels of a model at one instant, each computed when it is read.

A request is compiled to a Python function of numbers. Where it has no finite value, it is evaluated as over a run
(`stiffmbs.results.requests`).
"""

from __future__ import annotations

import ast
import math
from collections.abc import Callable, Iterator, Mapping
from functools import cached_property

import numpy as np

from ..compile.system import System
from ..compile.table_values import curve
from ..dynamics.dynamics import OutputRows
from ..elements.requests.output import Output, Term, placeholder
from ..model.model_data import ModelData
from ..reading.formula.functions import FUNCTIONS
from ..reading.formula.nodes import TIME
from .channels import channels_of, channels_of_model, counters, named, state_channels
from .frames import in_own_axes, own_are_principal
from .joint_angles import joint_angles
from .marker_motion import Measures
from .requests import value_over_time

BUILT_IN: dict[str, Callable[..., object]] = {
    **{name: function.value for name, function in FUNCTIONS.items() if function.in_numbers}, "sqrt": math.sqrt,
}  # fmt: skip


class Instant(Mapping[str, np.ndarray]):
    """Channels at the current instant; as a mapping, arrays of one value.

    `report`: returns the output row of the current instant. `angle`: returns a continuous angle of a joint, rad, given
    the row and the channel.
    """

    def __init__(
        self,
        model: ModelData,
        system: System,
        report: Callable[[], OutputRows],
        angle: Callable[[OutputRows, str], float],
    ) -> None:
        self._model, self._system, self._report, self._angle = model, system, report, angle
        self._outputs = model.outputs()
        self._compiled: dict[str, Callable[[Instant], float]] = {}
        self._bodies = {body: k for k, body in enumerate(system.bodies)}
        levels = system.of_body.positions, system.of_body.velocities, system.of_body.accelerations
        self._places = {name: (k, n, len(names)) for k, names in enumerate(levels) for n, name in enumerate(names)}
        angles = joint_angles(system)
        self._angles = frozenset(angles.places if angles else ())
        self._principal = own_are_principal(system)
        self._measures = Measures(model, self.value, lambda angle: self.rows.q.item(0, self._counted[angle]), math)
        self._begin()

    def forget(self) -> None:
        """Discard the values of an earlier instant."""
        if self._known or "rows" in self.__dict__:
            self._begin()

    def _begin(self) -> None:
        self._known: dict[str, float] = {}
        self._measures.forget()
        for kept in ("rows", "_levels", "_others"):
            self.__dict__.pop(kept, None)

    def value(self, name: str) -> float:
        """Return a channel. Raises ChannelError if there is no such channel."""
        if name not in self._known:
            self._known[name] = self._request(name) if name in self._outputs else self._channel(name)
        return self._known[name]

    def __getitem__(self, name: str) -> np.ndarray:
        return np.array([self.value(name)])

    def __iter__(self) -> Iterator[str]:
        return iter(channels_of(self._model, self._system, self.rows))

    def __len__(self) -> int:
        return sum(1 for _ in self)

    @cached_property
    def rows(self) -> OutputRows:
        """Output row."""
        return self._report()

    @property
    def time(self) -> float:
        """Time, s."""
        return float(self.rows.t[0])

    @cached_property
    def _levels(self) -> tuple[list[float], ...]:
        """Positions, velocities and accelerations of the described bodies."""
        rows = self.rows
        states = rows.q, rows.u, rows.acceleration
        if not self._principal:
            states = in_own_axes(self._system, *states)
        return tuple(state[0].tolist() for state in states)

    @cached_property
    def _others(self) -> dict[str, np.ndarray]:
        """States, and channels of the whole model."""
        rows = self.rows
        return state_channels(self._system, rows.q, rows.values) | channels_of_model(rows)

    def _channel(self, name: str) -> float:
        owner, _, component = name.rpartition(".")
        if owner in self._bodies and component in self._places:
            level, n, width = self._places[component]
            return self._levels[level][width * self._bodies[owner] + n]
        if name in self._angles:
            return self._angle(self.rows, name)
        if name in self._system.reported:
            at = self._system.reported[name]
            return self.rows.values.item(0, at) if at >= 0 else 0.0
        if name in self._others:
            return self._others[name].item(0)
        return named(channels_of(self._model, self._system, self.rows), name).item(0)

    def _request(self, name: str) -> float:
        output = self._outputs[name]
        if name not in self._compiled:
            self._compiled[name] = compiled(output)
        try:
            found = self._compiled[name](self)
            if isinstance(found, float | int) and math.isfinite(found):
                return float(found)
        except (ArithmeticError, ValueError):
            pass
        known = counters(self._model, self._system, self.rows.q)
        return float(value_over_time(self._model, output, self.rows.t, self, known)[0])

    def term(self, term: Term) -> float:
        """Return a measure between markers, or a component of an action."""
        return self._measures.value(term)  # type: ignore[no-any-return]

    @cached_property
    def _counted(self) -> dict[str, int]:
        """Coordinates that count the turns of angles, by the text of the angle."""
        system = self._system
        return {name: int(places[0]) for group in system.groups for name, places in zip(group.names, group.counters, strict=True) if len(places)}  # fmt: skip


def compiled(output: Output) -> Callable[[Instant], float]:
    """Return a request as a function of an instant."""
    terms = {placeholder(k): term for k, term in enumerate(output.terms)}
    constants: dict[str, object] = {"power": _power}

    def kept(value: object) -> ast.expr:
        name = f"k{len(constants)}"
        constants[name] = value
        return ast.Name(name, ast.Load())

    def method(name: str, argument: object) -> ast.expr:
        return ast.Call(ast.Attribute(ast.Name("instant", ast.Load()), name, ast.Load()), [kept(argument)], [])

    def written(node: ast.expr) -> ast.expr:
        """Return a node as Python that reads an instant."""
        match node:
            case ast.BinOp(left, ast.Pow(), right):
                return ast.Call(ast.Name("power", ast.Load()), [written(left), written(right)], [])
            case ast.BinOp(left, op, right):
                return ast.BinOp(written(left), op, written(right))
            case ast.UnaryOp(op, operand):
                return ast.UnaryOp(op, written(operand))
            case ast.Constant(int() | float() as value):
                return kept(float(value))
            case ast.Name(name) if name == TIME:
                return ast.Attribute(ast.Name("instant", ast.Load()), "time", ast.Load())
            case ast.Name(name) if name in terms:
                return method("term", terms[name])
            case ast.Call(ast.Name(name), arguments):
                table = output.tables.get(name)
                function = curve(table) if table is not None else BUILT_IN.get(name, FUNCTIONS[name].array)
                return ast.Call(kept(function), [written(argument) for argument in arguments], [])
            case ast.Name(name):
                full = name
            case ast.Attribute(ast.Name(owner), last):
                full = f"{owner}.{last}"
        return kept(output.quantities[full].value) if full in output.quantities else method("value", full)

    arguments = ast.arguments([], [ast.arg("instant")], None, [], [], None, [])
    tree = ast.fix_missing_locations(ast.Expression(ast.Lambda(arguments, written(output.tree))))
    made: Callable[[Instant], float] = eval(compile(tree, "request", "eval"), constants)
    return made


def _power(base: float, exponent: float) -> float:
    value = base**exponent
    return math.nan if isinstance(value, complex) else value
