"""Channels of a model at one instant, each computed when it is read.

A request is compiled to a Python function of numbers. Where it has no finite value, and for measures that few requests
use, it is evaluated as over a run (`stiffmbs.results.requests`).
"""

from __future__ import annotations

import ast
import math
from collections.abc import Callable, Iterator, Mapping
from functools import cached_property, partial
from typing import Any

import numpy as np

from ..compile.system import System
from ..compile.table_values import curve
from ..dynamics.dynamics import OutputRows
from ..elements.requests.check import ends
from ..elements.requests.output import CONTINUOUS_ANGLES, Output, Term, placeholder
from ..model.model_data import ModelData
from ..reading.formula.functions import FUNCTIONS
from ..reading.formula.nodes import TIME
from ..reading.marker import GROUND, MarkerReference
from .channels import channels_of, channels_of_model, counters, named, state_channels
from .frames import BodyFrame, GroundFrame, MarkerFrame, Vector, cross, dot, in_own_axes, minus, own_are_principal
from .joint_angles import TURN, joint_angles
from .marker_motion import place
from .requests import value_over_time

LEVELS = {"d": "point", "v": "velocity", "w": "omega", "acc": "acceleration", "wdt": "alpha"}
"""Vectors of a marker whose differences are measures, by the name of their components without the last letter."""
BUILT_IN: dict[str, Callable[..., object]] = {
    **{name: function.value for name, function in FUNCTIONS.items() if function.in_numbers}, "sqrt": math.sqrt,
}  # fmt: skip
_GROUND = GroundFrame()


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
        self._placed: dict[int, tuple[Any, Any]] = {}
        self._begin()

    def forget(self) -> None:
        """Discard the values of an earlier instant."""
        if self._known or "rows" in self.__dict__:
            self._begin()

    def _begin(self) -> None:
        self._known: dict[str, float] = {}
        self._frames: dict[str, BodyFrame] = {GROUND: _GROUND}
        self._markers: dict[int, MarkerFrame] = {}
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
        except (ArithmeticError, ValueError, NotCompiledError):
            pass
        known = counters(self._model, self._system, self.rows.q)
        return float(value_over_time(self._model, output, self.rows.t, self, known)[0])

    def term(self, term: Term) -> float:
        """Return a measure between markers, or a component of an action.

        Raises NotCompiledError for a measure that few requests use.
        """
        if term.element:
            return self._action(term)
        i, j, *axes = (self._marker(marker) for marker in term.markers)
        name = term.function
        if name in CONTINUOUS_ANGLES:
            return self._continuous_angle(term, i, j)
        if name == "vr":
            offset = minus(i.point, j.point)
            return dot(offset, minus(i.velocity, j.velocity)) / math.sqrt(dot(offset, offset))
        level = LEVELS.get(name[:-1])
        if level is None:
            raise NotCompiledError
        return _component(minus(getattr(i, level), getattr(j, level)), name[-1], axes)

    def _continuous_angle(self, term: Term, i: MarkerFrame, j: MarkerFrame) -> float:
        if self._system.of_body.dimensions == 2:
            angles = [
                self._model.place(marker).angle + (0.0 if marker.body == GROUND else self.value(f"{marker.body}.angle"))
                for marker in term.markers
            ]
            return float(angles[0] - angles[1])
        about = term.function[1]
        if about == "z":
            sine, cosine = dot(i.axes[0], j.axes[1]), dot(i.axes[0], j.axes[0])
        else:
            z = i.axes[2]
            sine, cosine = -dot(z, j.axes[1]) if about == "x" else dot(z, j.axes[0]), dot(z, j.axes[2])
        angle, counted = math.atan2(sine, cosine), self._counted[str(term)]
        return angle + TURN * round((self.rows.q.item(0, counted) - angle) / TURN)

    @cached_property
    def _counted(self) -> dict[str, int]:
        """Coordinates that count the turns of angles, by the text of the angle."""
        system = self._system
        return {name: int(places[0]) for group in system.groups for name, places in zip(group.names, group.counters, strict=True) if len(places)}  # fmt: skip

    def _action(self, term: Term) -> float:
        force, torque = ("fx fy 0", "0 0 torque") if self._system.of_body.dimensions == 2 else ("fx fy fz", "tx ty tz")
        f, m = _vector(self._read(term.element, force)), _vector(self._read(term.element, torque))
        if term.on_second:
            i, j = (self._marker(marker).point for marker in ends(term.element, self._model))
            f, m = _negative(f), minus(_negative(m), cross(minus(i, j), f))
        return _component(
            f if term.function[0] == "f" else m, term.function[1], [self._marker(x) for x in term.markers]
        )

    def _read(self, owner: str, labels: str) -> tuple[float, ...]:
        return tuple(0.0 if label == "0" else self.value(f"{owner}.{label}") for label in labels.split())

    def _marker(self, marker: MarkerReference) -> MarkerFrame:
        at = id(marker)  # hashing the marker would take longer; the model keeps it
        if at not in self._markers:
            if at not in self._placed:
                point, orientation = place(self._model, marker)
                self._placed[at] = tuple(point.tolist()), tuple(orientation.tolist())
            if marker.body not in self._frames:
                planar = self._system.of_body.dimensions == 2
                self._frames[marker.body] = BodyFrame(partial(self._read, marker.body), planar)
            self._markers[at] = MarkerFrame(self._frames[marker.body], *self._placed[at])
        return self._markers[at]


class NotCompiledError(Exception):
    """A measure is evaluated over time only."""


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


def _component(v: Vector, which: str, axes: list[MarkerFrame]) -> float:
    """Return the magnitude of a vector, or its component along the axes of a marker or of ground."""
    if which == "m":
        return math.sqrt(dot(v, v))
    k = "xyz".index(which)
    return dot(v, axes[0].axes[k]) if axes else v[k]


def _vector(values: tuple[float, ...]) -> Vector:
    x, y, z = values
    return x, y, z


def _negative(v: Vector) -> Vector:
    return -v[0], -v[1], -v[2]
