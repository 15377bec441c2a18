"""Algebraic state: solution of an algebraic equation at every time (Adams: VARIABLE, implicit)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from pydantic import Field

from ..fields import Described
from ..formula.field import OfMotion
from ..formula.formula import Formula
from ..given import Law, Number
from .amount import Amount
from .state import Scale, StateValue


class AlgebraicState(Described):
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
    start: Amount = Field(
        Amount(0.0), description="where its value is sought from at the start; a unit tells its dimension"
    )
    scale: Scale = Field(
        Amount(1.0), description="a size of it that matters, for its absolute tolerance; 1 in SI units by default"
    )

    if TYPE_CHECKING:

        def __init__(self, *, zero: Law, start: Number = 0.0, scale: Number = 1.0) -> None: ...

    def formulas(self) -> Iterator[tuple[str, Formula]]:
        """Yield its formulas by field."""
        yield "zero", self.zero

    def values(self, name: str) -> Iterator[tuple[str, StateValue]]:
        """Yield its unknowns by full name."""
        yield name, StateValue(self.zero, float(self.start), float(self.scale), algebraic=True)

    def outputs(self, name: str) -> Iterator[tuple[str, Formula]]:
        """Yield no outputs."""
        yield from ()
