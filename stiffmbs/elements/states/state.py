"""User-defined states: solutions of a differential equation (Adams: DIFF), or of an algebraic one (implicit VARIABLE)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import AfterValidator, Field, model_validator

from ...reading.fields import Described
from ...reading.formula.dimension import Known, measured_in, product
from ...reading.formula.field import OfMotion
from ...reading.formula.formula import Formula
from ...reading.given import Law, Number
from ...reading.units.units import named_unit
from .amount import Amount, AnyAmount, positive, stated_dimension

Scale = Annotated[AnyAmount, AfterValidator(positive)]


@dataclass(frozen=True)
class StateValue:
    """Scalar unknown in addition to the motion.

    Attributes
    ----------
    rate : Formula or None
        Its rate of change, or the residual of an algebraic state; None if an element defines it.
    start : float
        Initial value, SI units; for an algebraic state the initial guess.
    scale : float
        Characteristic size: its absolute tolerance is that of an angle times this.
    algebraic : bool
        Whether its equation is 0 = formula, without a rate.
    """

    rate: Formula | None
    start: float
    scale: float
    algebraic: bool = False


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
    start: AnyAmount = Field(Amount(0.0), description="initial value; a unit tells its dimension")
    scale: Scale = Field(
        Amount(1.0), description="a size of it that matters, for its absolute tolerance; 1 in SI units by default"
    )

    if TYPE_CHECKING:

        def __init__(self, *, rate: Law, start: Number = 0.0, scale: Number = 1.0) -> None: ...

    @model_validator(mode="after")
    def _rate_fits(self) -> State:
        expected = product(self.start.known, measured_in("time"), -1)
        if self.start.known.stated and not self.rate.dimension.agrees_with(expected):
            assert self.rate.dimension.exponents is not None and expected.exponents is not None
            raise ValueError(
                f"rate: found '{self.rate.text}', which is in {named_unit(self.rate.dimension.exponents)}, expected "
                f"{named_unit(expected.exponents)}, the unit of start over time"
            )
        return self

    def values(self, name: str) -> Iterator[tuple[str, StateValue]]:
        """Yield its unknowns by full name."""
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
        description="what is zero: a formula of the state itself, time, coordinates, velocities and other states"
    )
    start: AnyAmount = Field(
        Amount(0.0), description="where its value is sought from at the start; a unit tells its dimension"
    )
    scale: Scale = Field(
        Amount(1.0), description="a size of it that matters, for its absolute tolerance; 1 in SI units by default"
    )

    if TYPE_CHECKING:

        def __init__(self, *, zero: Law, start: Number = 0.0, scale: Number = 1.0) -> None: ...

    def values(self, name: str) -> Iterator[tuple[str, StateValue]]:
        """Yield its unknowns by full name."""
        yield name, StateValue(self.zero, float(self.start), float(self.scale), algebraic=True)


def dimension_of_state(entry: Any, parameters: Any) -> Known:
    """Return the known dimension of a state before its validation; unknown if its start cannot be read."""
    start = getattr(entry, "start", None)
    if isinstance(start, Amount):
        return start.dimension
    return stated_dimension(entry.get("start") if isinstance(entry, dict) else None, parameters)
