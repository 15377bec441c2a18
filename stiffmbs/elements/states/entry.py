"""Base of the entries of the section `states`, and their values."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from ...reading.fields import Described
from ...reading.formula.formula import Formula


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
