"""User-defined states: of a differential equation (Adams: DIFF), an algebraic one (implicit VARIABLE), or sampled (GSE)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated

from pydantic import AfterValidator, Field, model_validator

from ...reading.fields import Described
from ...reading.formula.dimension import Known, measured_in, product
from ...reading.formula.field import OfMotion
from ...reading.formula.formula import Formula
from ...reading.units import si
from ...reading.units.units import in_its_unit, named_unit
from .amount import Amount, AnyAmount, positive, stated_dimension

Scale = Annotated[AnyAmount, AfterValidator(positive)]


@dataclass(frozen=True)
class StateValue:
    """Scalar unknown in addition to the motion."""

    # its rate of change, the residual of an algebraic state, or the next value of a sampled one; None if an element
    # defines it
    rate: Formula | None
    start: float  # initial value, SI units; for an algebraic state the initial guess
    scale: float  # characteristic size: its absolute tolerance is that of an angle times this
    algebraic: bool = False  # whether its equation is 0 = formula, without a rate
    # period, offset: times between the samples of a sampled state, and of its first one, s; a period of 0 for all other
    # states
    period: float = 0.0
    offset: float = 0.0


class Entry(Described):
    """Base of the entries of the section `states`; scenes use its subclasses."""

    def formulas(self) -> Iterator[tuple[str, Formula]]:
        """Yield its formulas by field."""
        for name in type(self).model_fields:
            value = getattr(self, name)
            if isinstance(value, Formula):
                yield name, value
            elif isinstance(value, tuple):
                yield from ((f"{name}.{k}", part) for k, part in enumerate(value) if isinstance(part, Formula))

    def values(self, name: str) -> Iterator[tuple[str, StateValue]]:
        """Yield its unknowns by full name."""
        raise NotImplementedError

    def outputs(self, name: str) -> Iterator[tuple[str, Formula]]:
        """Yield its outputs by full name; none unless its kind has some, such as a transfer function."""
        yield from ()


class State(Entry):
    """Variable x with x' = rate and the initial value start; formulas use it by its name.

    Examples
    --------
    The force of a spring that follows its deflection with a delay of tau seconds, with parameters k and tau::

        states: {delayed: {rate: "(cart.x - delayed)/tau", start: 0 m}}
        forces: {push: {type: force, i: cart, force: ["-k*delayed", 0]}}

    This is Adams' DIFF.
    """

    rate: OfMotion = Field(description="its rate of change: a formula of time, coordinates, velocities and states")
    start: AnyAmount = Field(Amount(0.0), description="initial value; a unit states its dimension")
    scale: Scale = Field(
        Amount(1.0), description="typical magnitude, for its absolute tolerance; 1 in SI units by default"
    )

    @model_validator(mode="after")
    def _rate_fits(self) -> State:
        _refuse_other_dimension(
            "rate", self.rate, self.start, product(self.start.known, measured_in("time"), -1), " over time"
        )
        return self

    def values(self, name: str) -> Iterator[tuple[str, StateValue]]:
        yield name, StateValue(self.rate, float(self.start), float(self.scale))


class AlgebraicState(Entry):
    """Variable x with zero(x) = 0 at every time; formulas use it by its name.

    Examples
    --------
    The pressure upstream of a valve, whose flow is that of a piston of area A with a leak::

        states: {p: {zero: "p/(c + abs(p))^0.5 + leak*p - A*piston.vx", start: 100 kPa}}
        forces: {push: {type: force, i: piston, force: ["-A*p", 0]}}

    This is Adams' VARIABLE with IMPLICIT.
    """

    zero: OfMotion = Field(
        description="residual, zero at all times: a formula of the state itself, time, coordinates, velocities and other states"
    )
    start: AnyAmount = Field(
        Amount(0.0), description="initial guess of its value at the start; a unit states its dimension"
    )
    scale: Scale = Field(
        Amount(1.0), description="typical magnitude, for its absolute tolerance; 1 in SI units by default"
    )

    def values(self, name: str) -> Iterator[tuple[str, StateValue]]:
        yield name, StateValue(self.zero, float(self.start), float(self.scale), algebraic=True)


class SampledState(Entry):
    """Variable x that takes the value of a formula at the times offset + k period and keeps it in between.

    The formula is evaluated just before each sample; the names of sampled states in it are their previous values, also
    those that are sampled at the same time. Forces and other formulas use the value by its name.

    Examples
    --------
    A controller with a sample time of 10 ms, with parameters kp, ki and goal::

        states:
          integral: {update: "integral + ki*(goal - cart.x)*0.01", period: 10 ms}
          push: {update: "kp*(goal - cart.x) + integral", period: 10 ms}
        forces: {motor: {type: force, i: cart, force: [push, 0]}}

    This is a discrete state of Adams' GSE, or a variable of a clock of FMI 3.
    """

    update: OfMotion = Field(
        description="its next value: a formula of time, coordinates, velocities, reactions and states, sampled ones with their previous values"
    )
    period: si.PositiveTime = Field(description="time between two samples, s")
    offset: si.Time = Field(0.0, description="time of a sample, s: the others are whole periods before and after it")
    start: AnyAmount = Field(Amount(0.0), description="value before the first sample; a unit states its dimension")

    @model_validator(mode="after")
    def _update_fits(self) -> SampledState:
        _refuse_other_dimension("update", self.update, self.start, self.start.known, "")
        return self

    def values(self, name: str) -> Iterator[tuple[str, StateValue]]:
        yield name, StateValue(self.update, float(self.start), 1.0, period=self.period, offset=self.offset)


def _refuse_other_dimension(field: str, formula: Formula, start: Amount, expected: Known, per: str) -> None:
    """Refuse a formula whose known dimension differs from the expected one, if the start has a unit."""
    if start.known.stated and not formula.dimension.agrees_with(expected):
        assert formula.dimension.exponents is not None and expected.exponents is not None
        raise ValueError(
            f"{field}: found '{formula.text}', which is {in_its_unit(formula.dimension.exponents)}, expected "
            f"{named_unit(expected.exponents)}, the unit of start{per}"
        )


def dimension_of_state(entry: object, parameters: object) -> Known:
    """Return the known dimension of a state before its validation; unknown if its start cannot be read."""
    start = getattr(entry, "start", None)
    if isinstance(start, Amount):
        return start.dimension
    return stated_dimension(entry.get("start") if isinstance(entry, dict) else None, parameters)
