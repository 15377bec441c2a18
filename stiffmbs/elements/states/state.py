"""User-defined states: of a differential equation (Adams: DIFF), an algebraic one (implicit VARIABLE), or sampled (GSE)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated

from pydantic import AfterValidator, Field, model_validator

from ...reading.formula.dimension import Known, measured_in, product
from ...reading.formula.field import OfMotion
from ...reading.formula.formula import Formula
from ...reading.units import si
from ...reading.units.units import in_its_unit, named_unit
from .amount import Amount, AnyAmount, positive
from .entry import Entry, StateValue

Scale = Annotated[AnyAmount, AfterValidator(positive)]


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
