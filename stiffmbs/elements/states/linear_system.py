"""Linear systems with formulas as inputs: transfer functions and state space (Adams: TFSISO, LSE)."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Sequence
from dataclasses import replace

from pydantic import Field, field_validator, model_validator

from ...reading.fields import is_name
from ...reading.formula.dimension import UNKNOWN
from ...reading.formula.field import OfMotion
from ...reading.formula.formula import Formula
from ...reading.table import Table
from ...reading.units import si
from .entry import Entry, StateValue

Weighted = tuple[float, Formula | str]
"""Weight, and the formula or state that it multiplies."""


def combined(parts: Sequence[Weighted], *formulas: Formula) -> Formula:
    """Return a weighted sum of formulas and states.

    `*formulas`: formulas among the parts, and others whose parameters the sum keeps.
    """
    kept = [(weight, part) for weight, part in parts if weight]
    if len(kept) == 1 and kept[0][0] == 1.0 and isinstance(kept[0][1], Formula):
        return kept[0][1]
    terms = [_times(weight, ast.Name(part) if isinstance(part, str) else part.tree) for weight, part in kept]
    tree: ast.expr = ast.Constant(0.0)
    for k, term in enumerate(terms):
        tree = ast.BinOp(tree, ast.Add(), term) if k else term
    states = [name for formula in formulas for name in formula.states]
    states += [part for _, part in parts if isinstance(part, str)]
    values: dict[str, float] = {}
    tables: dict[str, Table] = {}
    for formula in formulas:
        values |= formula.values
        tables |= dict(formula.tables)
    return replace(
        formulas[0], text=ast.unparse(ast.fix_missing_locations(tree)), tree=tree, values=values, tables=tables,
        dimension=UNKNOWN, states=tuple(dict.fromkeys(states)), among_variables=False,
    )  # fmt: skip


def _times(weight: float, tree: ast.expr) -> ast.expr:
    return tree if weight == 1.0 else ast.BinOp(ast.Constant(float(weight)), ast.Mult(), tree)


Row = tuple[si.Anything, ...]
Matrix = tuple[Row, ...]


class TransferFunction(Entry):
    """Output y of G(s) = numerator(s)/denominator(s) with a formula as input; formulas use y by the name of the entry.

    Its n states are those of the observer canonical form (Kailath, *Linear Systems*, 1980, sec. 2.1), zero at the
    start.

    Examples
    --------
    A low-pass filter of second order at w0 rad/s, with the parameter w0::

        states: {smooth: {numerator: [w0^2], denominator: [1, 1.4*w0, w0^2], input: body.ax_measured}}

    This is Adams' TFSISO, with the highest power first, as in SciPy.
    """

    numerator: Row = Field(
        description="coefficients of the numerator, that of the highest power of s first", min_length=1
    )
    denominator: Row = Field(
        description="coefficients of the denominator, that of the highest power of s first", min_length=1
    )
    input: OfMotion = Field(description="a formula of time, coordinates, velocities and states")

    @model_validator(mode="after")
    def _proper(self) -> TransferFunction:
        top, bottom = _trimmed(self.numerator), _trimmed(self.denominator)
        if not bottom:
            raise ValueError("denominator: found zeros, expected a number that is not zero")
        if len(top) > len(bottom):
            raise ValueError(
                f"numerator: found the degree {len(top) - 1} above that of the denominator, {len(bottom) - 1}, expected a proper "
                "transfer function: it would differentiate its input"
            )
        return self

    @property
    def _monic(self) -> tuple[list[float], list[float], float]:
        """Monic denominator after its first coefficient, numerator of the strictly proper part, and feedthrough."""
        bottom = _trimmed(self.denominator)
        top = _trimmed(self.numerator)
        b = [x / bottom[0] for x in [0.0] * (len(bottom) - len(top)) + top]
        a = [x / bottom[0] for x in bottom[1:]]
        return a, [y - x * b[0] for x, y in zip(a, b[1:], strict=True)], b[0]

    def _states(self, name: str) -> list[str]:
        a, _, through = self._monic
        names = [f"{name}.x{k + 1}" for k in range(len(a))]
        return names if through or not a else [name, *names[1:]]

    def values(self, name: str) -> Iterator[tuple[str, StateValue]]:
        """Yield its unknowns by full name: x_k' = -a_k x_1 + x_(k+1) + b_k u."""
        a, b, _ = self._monic
        states = self._states(name)
        for k, full in enumerate(states):
            parts: list[Weighted] = [(-a[k], states[0]), (b[k], self.input)]
            parts += [(1.0, states[k + 1])] if k + 1 < len(states) else []
            yield full, StateValue(combined(parts, self.input), 0.0, 1.0)

    def outputs(self, name: str) -> Iterator[tuple[str, Formula]]:
        """Yield y = x_1 + d u, unless it is x_1 itself."""
        a, _, through = self._monic
        if through or not a:
            first: list[Weighted] = [(1.0, self._states(name)[0])] if a else []
            yield name, combined([*first, (through, self.input)], self.input)


class LinearSystem(Entry):
    """State space x' = A x + B u, y = C x + D u with formulas u; outputs are used by its name, or as ``name.output``.

    Examples
    --------
    With two outputs, ``actuator.force`` and ``actuator.flow``::

        states:
          actuator:
            {a: [[-5, 1], [0, -2]], b: [[0], [1]], c: [[1, 0], [0, 1]], input: [cart.vx], outputs: [force, flow]}

    This is Adams' LSE.
    """

    a: Matrix = Field(description="A, by rows", min_length=1)
    b: Matrix = Field(description="B, by rows", min_length=1)
    c: Matrix = Field(description="C, by rows", min_length=1)
    d: Matrix | None = Field(None, description="D, by rows; zero by default")
    input: tuple[OfMotion, ...] = Field(description="a formula for each input", min_length=1)
    outputs_: tuple[str, ...] = Field((), alias="outputs", description="names of the outputs, where there are several")
    start: Row | None = Field(None, description="initial values of x; zeros by default")

    @field_validator("input", mode="before")
    @classmethod
    def _one_or_more(cls, found: object) -> object:
        return found if isinstance(found, list | tuple) else [found]

    @model_validator(mode="after")
    def _sizes(self) -> LinearSystem:
        n, m, p = len(self.a), len(self.input), len(self.c)
        expected = {"a": (n, n), "b": (n, m), "c": (p, n), "d": (p, m)}
        for name, (rows, columns) in expected.items():
            matrix = getattr(self, name)
            if matrix is not None and (len(matrix) != rows or any(len(row) != columns for row in matrix)):
                shape = f"{len(matrix)} rows of {'/'.join(map(str, dict.fromkeys(map(len, matrix))))}"
                raise ValueError(f"{name}: found {shape} numbers, expected {rows} rows of {columns}")
        if self.start is not None and len(self.start) != n:
            raise ValueError(f"start: found {len(self.start)} numbers, expected {n}")
        if len(self.outputs_) != (p if p > 1 or self.outputs_ else 0):
            raise ValueError(f"outputs: found {len(self.outputs_)} names, expected {p}, one for each row of c")
        for output in self.outputs_:
            if not is_name(output) or re.match(r"x\d+$", output):
                raise ValueError(f"outputs: found '{output}', expected letters, digits and _, and none of x1, x2, ...")
        return self

    def values(self, name: str) -> Iterator[tuple[str, StateValue]]:
        start = self.start or (0.0,) * len(self.a)
        for k, (of_states, of_inputs) in enumerate(zip(self.a, self.b, strict=True)):
            yield f"{name}.x{k + 1}", StateValue(self._row(name, of_states, of_inputs), start[k], 1.0)

    def outputs(self, name: str) -> Iterator[tuple[str, Formula]]:
        nothing = (0.0,) * len(self.input)
        names = [f"{name}.{output}" for output in self.outputs_] or [name]
        for k, full in enumerate(names):
            yield full, self._row(name, self.c[k], self.d[k] if self.d else nothing)

    def _row(self, name: str, of_states: Sequence[float], of_inputs: Sequence[float]) -> Formula:
        parts: list[Weighted] = [(weight, f"{name}.x{k + 1}") for k, weight in enumerate(of_states)]
        return combined([*parts, *zip(of_inputs, self.input, strict=True)], *self.input)


class PID(Entry):
    """Controller kp e + ki (integral of e) + kd (filtered derivative of e) with e = setpoint - input, used by name.

    The derivative is that of e with a first-order low-pass, kd s/(filter s + 1). Integral and filter are zero at the
    start.

    Examples
    --------
    ::

        states: {motor: {pid: {input: cart.x, setpoint: 0.4 m, kp: 50, ki: 30, kd: 12, filter: 1 ms}}}
        forces: {push: {type: force, i: cart, force: [motor, 0]}}
    """

    input: OfMotion = Field(description="controlled quantity: a formula of time, coordinates, velocities and states")
    setpoint: OfMotion | None = Field(None, description="set value of the input: a formula; zero by default")
    kp: si.Anything = Field(0.0, description="proportional gain")
    ki: si.Anything = Field(0.0, description="integral gain")
    kd: si.Anything = Field(0.0, description="derivative gain")
    filter: si.PositiveTime | None = Field(None, description="time constant of the derivative's filter, s")

    @model_validator(mode="after")
    def _filtered(self) -> PID:
        if self.kd and self.filter is None:
            raise ValueError("filter: found none with kd, expected the time constant of the derivative's filter")
        return self

    def _sum(self, gain: float, *others: Weighted) -> Formula:
        """Return gain times the error, plus other terms."""
        error: list[Weighted] = [(-gain, self.input)]
        error += [(gain, self.setpoint)] if self.setpoint is not None else []
        return combined([*error, *others], *(formula for _, formula in self.formulas()))

    def values(self, name: str) -> Iterator[tuple[str, StateValue]]:
        """Yield its unknowns by full name: the integral, and the filtered error."""
        if self.ki:
            yield f"{name}.integral", StateValue(self._sum(1.0), 0.0, 1.0)
        if self.kd and self.filter is not None:
            rate = 1 / self.filter
            yield f"{name}.filtered", StateValue(self._sum(rate, (-rate, f"{name}.filtered")), 0.0, 1.0)

    def outputs(self, name: str) -> Iterator[tuple[str, Formula]]:
        """Yield the sum of the proportional, integral and filtered derivative parts."""
        derivative = self.kd / self.filter if self.kd and self.filter is not None else 0.0
        others: list[Weighted] = [(self.ki, f"{name}.integral")] if self.ki else []
        others += [(-derivative, f"{name}.filtered")] if derivative else []
        yield name, self._sum(self.kp + derivative, *others)


def _trimmed(coefficients: Sequence[float]) -> list[float]:
    first = next((k for k, x in enumerate(coefficients) if x), len(coefficients))
    return list(coefficients[first:])
