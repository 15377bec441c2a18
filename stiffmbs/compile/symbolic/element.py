"""Symbolic element: the interface in which joints and forces state their equations."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import sympy as sp

from ...elements.element import IN_EQUATIONS
from ...errors import InputError
from .canonical import product, total
from .continuous_angle import ContinuousAngle, counter
from .differentiate import Derivatives, Slope
from .logarithm import PlanarLogarithm, SpatialLogarithm, logarithm
from .read import read
from .relative_rotation import RelativeRotation, ShortestRotation
from .relative_rotation import product as turned
from .spline import common_normal, integral

if TYPE_CHECKING:
    from .planar_frames import BodyFrame
    from .referred import ReferredJoint
    from .spatial_frames import SpatialBodyFrame, SpatialFrame

COINCIDENT = sp.Float("1e-200")
"""Added under the root of a distance, so that a spring without free length is defined at coincident points."""


Terms = Any
"""Expression, or a matrix or list of expressions, and the same of its results."""

Work = tuple[sp.Expr, sp.Expr]
"""Effort, and the quantity it does work on: a function of the pose, or its rate."""


@dataclass(frozen=True)
class Variables:
    """Coordinates or velocities of an element, by which expressions are differentiated."""

    element: SymbolicElement
    slopes: list[list[Slope]]

    def matrix(self, column: Iterable[sp.Expr]) -> sp.Matrix:
        """Return the matrix of derivatives of a column."""
        rows = [[self.derivative(x, k) for k in range(len(self.slopes))] for x in column]
        return sp.Matrix(len(rows), len(self.slopes), [entry for row in rows for entry in row])

    def work(self, pairs: Iterable[Work]) -> sp.Matrix:
        """Return the generalised force: the column of sums of efforts times derivatives of their quantities."""
        known = list(pairs)
        return sp.Matrix([self._change(known, of_row) for of_row in self.slopes])

    def derivative(self, x: sp.Expr, k: int) -> sp.Expr:
        """Return the derivative by one variable."""
        return self._change([(sp.Integer(1), x)], self.slopes[k])

    def of(self, x: sp.Expr) -> list[int]:
        """Return the variables that an expression depends on."""
        return [k for k, of_row in enumerate(self.slopes) if self.element.depends(x, (symbol for symbol, _ in of_row))]

    def _change(self, pairs: list[Work], of_row: list[Slope]) -> sp.Expr:
        """Return the sum of efforts times derivatives by one variable; shared parts are named."""
        partial, changes = self.element.derivatives.partial, []
        for symbol, much in of_row:
            parts = ((effort, partial(x, symbol)) for effort, x in pairs)
            whole = total(product(effort, part) for effort, part in parts if part is not sp.S.Zero)
            if whole is not sp.S.Zero:
                changes.append(whole if much is sp.S.One else product(self.element.named(whole), much))
        return total(changes)


class SymbolicElement:
    """Element with frames for its markers and symbols for its numbers.

    - `t`: time.
    - `frames`: the bodies, in the order of `Element.bodies`.
    - `states`: states that it reads or determines, by slot.
    - `own`: the element's own states, which come first.
    - `state_rates`: rates of the states, in the equations of joints.
    - `angles`: continuous angles, in the order of their counters.
    - `joint_angles`: slot of the joint and its coordinate, for each of these that is the coordinate of a referenced joint.
    - `counts`: false for values that are only reported: angles without a counter are then within one turn.
    - `breakpoints`: event functions of the equations (``Abs``, ``Max``, ``Piecewise``), as they are read.
    - `derivatives`: derivatives of expressions in its symbols.
    """

    t = sp.Symbol("t", real=True)

    def __init__(
        self,
        frames: list[Any],
        fields: dict[str, object],
        derivatives: Derivatives,
        states: list[sp.Symbol],
        n_own: int = 0,
    ) -> None:
        self.frames = frames
        self.states, self.own = states, states[:n_own]
        self.state_rates: tuple[sp.Expr, ...] = ()
        self.angles: list[sp.Expr] = []
        self.joint_angles: dict[int, tuple[int, str]] = {}
        self.counts = True
        self.breakpoints: list[sp.Expr] = []
        self.derivatives = derivatives
        self._rotations: dict[tuple[object, object], RelativeRotation] = {}
        self._logarithms: dict[tuple[object, object], SpatialLogarithm | PlanarLogarithm] = {}
        self.__dict__.update(fields)

    def __getattr__(self, name: str) -> Any:
        known = (*(own for own in self.__dict__ if own not in IN_EQUATIONS), "t", "rate", "distance", "angle", "named")
        raise AttributeError(f"found e.{name}, expected one of e.{', e.'.join(known)}")

    @property
    def q(self) -> sp.Matrix:
        """Coordinates of all bodies of the element."""
        return sp.Matrix([symbol for frame in self.frames for symbol in frame.q])

    @property
    def u(self) -> sp.Matrix:
        """Velocities of all bodies of the element."""
        return sp.Matrix([symbol for frame in self.frames for symbol in frame.u])

    @property
    def a(self) -> sp.Matrix:
        """Accelerations of all bodies of the element."""
        return sp.Matrix([symbol for frame in self.frames for symbol in frame.a])

    @property
    def velocities(self) -> list[sp.Symbol]:
        """Symbols by which functions of the velocities are differentiated."""
        return [symbol for frame in self.frames for symbol in frame.velocities]

    def read(self, x: sp.Expr) -> sp.Expr:
        """Return an expression of an element's equations in the form for kernels; record its breakpoints."""
        return read(x, self._note)

    def _note(self, breakpoint: sp.Expr) -> None:
        if breakpoint not in self.breakpoints:
            self.breakpoints.append(breakpoint)

    def rate(self, x: Terms) -> Terms:
        """Return the total time derivative of an expression, or of each in a matrix, at constant velocities."""
        if isinstance(x, sp.MatrixBase):
            return x.applyfunc(self.rate)
        x = self.read(x)
        if self.depends(x, self.states) and not self.state_rates:
            raise InputError("found a state in an expression whose rate is needed, expected coordinates and time alone")
        partial = self.derivatives.partial
        own = (product(rate, partial(x, symbol)) for symbol, rate in zip(self.states, self.state_rates, strict=False))
        moving = (
            product(rate, part if symbol in frame.q else self.named(part))
            for frame in self.frames
            for symbol, rate in frame.motion
            if (part := partial(x, symbol)) is not sp.S.Zero
        )
        return total((*moving, *own, partial(x, self.t)))

    def second_rate(self, x: sp.Expr) -> sp.Expr:
        """Return the second total time derivative of a read expression at constant velocities."""
        rates = {symbol: rate for frame in self.frames for symbol, rate in frame.motion}
        rates |= dict(zip(self.states, self.state_rates, strict=False)) | {self.t: sp.Integer(1)}
        return self.derivatives.along(self.derivatives.along(x, rates), rates)

    def acceleration(self, x: sp.Expr) -> sp.Expr:
        """Return the second total time derivative of an expression of the pose and time."""
        return self.by_accelerations(self.rate(x)) + self.second_rate(self.read(x))

    def by_accelerations(self, x: sp.Expr) -> sp.Expr:
        """Return the acceleration part J a of the rate of a function of velocities, in fewer products than from J."""
        return self.derivatives.along(x, self._accelerations)

    @cached_property
    def _accelerations(self) -> dict[sp.Symbol, sp.Expr]:
        """Rates of the symbols in `velocities` due to accelerations."""
        rates: dict[sp.Symbol, sp.Expr] = {}
        for a, of_row in zip(self.a, self.by_u.slopes, strict=True):
            for symbol, much in of_row:
                rates[symbol] = rates.get(symbol, sp.Integer(0)) + a * much
        return {symbol: self.named(rate) for symbol, rate in rates.items()}

    def named(self, x: Terms) -> Terms:
        """Name an expression, or each in a matrix or list; named expressions are derived much faster."""
        if isinstance(x, sp.MatrixBase):
            return x.applyfunc(self.named)
        return [self.named(part) for part in x] if isinstance(x, list) else self.derivatives.named(self.read(x))

    def variable(self, x: sp.Expr) -> sp.Symbol:
        """Return a symbol for an expression by which others can be differentiated (`slope`, `composed`)."""
        return self.derivatives.variable(self.read(x), self._state)

    def slope(self, x: sp.Expr, variable: sp.Symbol) -> sp.Expr:
        """Return the derivative of an expression by a symbol from `variable`, other variables held constant."""
        return self.derivatives.partial(self.read(x), variable)

    def composed(self, outputs: Iterable[object], variables: Sequence[sp.Symbol]) -> list[sp.Expr]:
        """Name long expressions that depend on the state through few variables, to be differentiated through these."""
        return [self.derivatives.composed(self.read(x), variables, self._state) for x in outputs]

    @property
    def _state(self) -> list[sp.Symbol]:
        return [*(symbol for frame in self.frames for symbol in frame.pose), *self.velocities, *self.states, self.t]

    def relative_rotation(self, i: SpatialFrame, j: SpatialFrame) -> RelativeRotation:
        """Return the rotation of a spatial marker relative to one of another body."""
        if (i, j) not in self._rotations:
            self._rotations[i, j] = self._new_rotation(i, j)
        return self._rotations[i, j]

    def _new_rotation(self, i: SpatialFrame, j: SpatialFrame) -> RelativeRotation:
        """Define symbols for a relative rotation, with the derivatives stated by `RelativeRotation`."""
        back = sp.diag(1, -1, -1, -1) * self.named(j.quaternion)
        inverse_length = sp.sqrt(i.body.inverse_square * j.body.inverse_square) / 2
        meaning = turned(back, self.named(i.quaternion)) * self.named(inverse_length)
        parts = [sp.Symbol(f"turn{len(self._rotations)}_{k}", real=True) for k in range(4)]
        turn = RelativeRotation(parts[0], sp.Matrix(parts[1:]))
        halves = [turn.rates(self.named(sp.Matrix([axis[k] for axis in j.axes]) / 2)) for k in range(3)]
        for part, stands_for, changes in zip(parts, meaning, zip(*halves, strict=True), strict=True):
            by = dict(zip(i.body.phi, changes, strict=True))
            against = dict(zip(j.body.phi, (-change for change in changes), strict=True))
            self.derivatives.define(part, by | against, stands_for)
        return turn

    def shortest_rotation(self, i: SpatialFrame, j: SpatialFrame, axis: int) -> ShortestRotation:
        """Return the tilt of an axis (0, 1, 2 for x, y, z) of a spatial marker relative to another one."""
        own = self.named([i.x, i.y, i.z][axis])
        return ShortestRotation(axis, sp.Matrix(self.named([own.dot(self.named(other)) for other in (j.x, j.y, j.z)])))

    def logarithm(self, i: object, j: object) -> SpatialLogarithm | PlanarLogarithm:
        """Return the logarithm of the displacement of a marker from one of another body."""
        if (i, j) not in self._logarithms:
            self._logarithms[i, j] = logarithm(self, i, j)
        return self._logarithms[i, j]

    @property
    def meanings(self) -> dict[sp.Symbol, sp.Expr]:
        """Expressions of the named symbols, each after those it uses."""
        return self.derivatives.meanings

    @cached_property
    def by_q(self) -> Variables:
        """Coordinates of the bodies, then states; turn counters follow them."""
        of_states: list[list[Slope]] = [[(symbol, sp.Integer(1))] for symbol in self.states]
        return Variables(self, [*(of_row for frame in self.frames for of_row in frame.by_coordinate), *of_states])

    @cached_property
    def by_u(self) -> Variables:
        """Velocities of the bodies."""
        return Variables(self, [of_row for frame in self.frames for of_row in frame.by_velocity])

    def reaction(self, joint: ReferredJoint, on: BodyFrame | SpatialBodyFrame) -> dict[str, sp.Expr]:
        """Return the reaction of a joint on one of its bodies about the joint's point, by component: -J^T lam."""
        force = -self.by_u.work(zip(joint.lam, joint.velocity_level, strict=True))
        first = sum(len(frame.u) for frame in self.frames[: self.frames.index(on)])
        wrench = on.wrench(force[first : first + len(on.u), :], sp.Matrix(joint.point))
        names = ("fx", "fy", "tz") if len(wrench) == 3 else ("fx", "fy", "fz", "tx", "ty", "tz")
        return dict(zip(names, wrench, strict=True))

    def by(self, column: Iterable[sp.Expr], symbols: Iterable[sp.Symbol]) -> sp.Matrix:
        """Return the matrix of derivatives by any symbols."""
        return self.derivatives.jacobian(column, symbols)

    def is_constant(self, expression: sp.Expr) -> bool:
        """Return True if an expression depends on neither time nor the state."""
        return not self.depends(expression, [self.t]) and not self.in_state(expression)

    def angle(self, sine: sp.Expr, cosine: sp.Expr) -> sp.Expr:
        """Return the continuous angle with a given sine and cosine, or multiples of both."""
        for angle in self.angles:
            if angle.args[:2] == (sine, cosine):
                return angle
        if not self.counts:
            return ContinuousAngle(sine, cosine, sp.Integer(0))
        self.angles.append(ContinuousAngle(sine, cosine, counter(len(self.angles))))
        return self.angles[-1]

    def in_state(self, expression: sp.Expr) -> bool:
        """Return True if an expression depends on coordinates, velocities or states."""
        of_bodies = (symbol for frame in self.frames for symbol in frame.pose)
        return self.depends(expression, [*of_bodies, *self.velocities, *self.states])

    def depends(self, expression: sp.Expr, symbols: Iterable[sp.Symbol]) -> bool:
        """Return True if an expression depends on any of the given symbols, also through named symbols."""
        return not self.derivatives.variables(sp.sympify(expression)).isdisjoint(symbols)

    def distance(self, a: sp.Matrix, b: sp.Matrix) -> sp.Expr:
        """Return the distance of two points, with zero derivative where they coincide."""
        d = self.named(a - b)
        return self.named(sp.sqrt(d.dot(d) + COINCIDENT))

    @staticmethod
    def integral(law: Callable[[sp.Expr], sp.Expr], x: sp.Expr) -> sp.Expr | None:
        """Return the integral of a law from 0 to x, for a potential; None if there is no simple one."""
        return integral(law, x)

    def common_normal(self, offset: Any, axes: Any, first: Any, second: Any) -> sp.Matrix:
        """Return the unit normal between two solids, each a sum of ellipsoids."""
        return self.named(common_normal(offset, axes, first, second))

    def at_extremum(self, function: Callable[[list[sp.Symbol]], object], at: Any) -> sp.Expr:
        """Return a function of variables at its extremum over them."""
        variables = [sp.Symbol(f"extremal{k}", real=True) for k in range(len(at))]
        values = dict(zip(variables, at, strict=True))
        return self.derivatives.at_extremum(self.read(function(variables)), values, self._state)

    def at_root(
        self, residual: Callable[[sp.Symbol], sp.Expr], value: sp.Expr, variables: Sequence[sp.Symbol]
    ) -> sp.Symbol:
        """Return a symbol for the zero of a function, computed as `value`, differentiated through few variables."""
        return self.derivatives.at_root(lambda x: self.read(residual(x)), self.read(value), variables, self._state)
