"""Trace of scene numbers through validation, for re-evaluation with other values without validating again.

An element is validated once with `Followed` objects in place of the numbers that vary. Every operation on them and the
outcome of every comparison are recorded. For other values the operations are repeated; if all comparisons have the same
outcome, the validation would have taken the same path. Operations that cannot be traced, such as conversion by NumPy,
are refused.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, Protocol

from ..units.units import Quantity
from .unchanged import names_in

FOLLOWED = "followed"
"""Key of a `Record` in the validation context."""
Parameters = Mapping[str, Quantity]
Step = Callable[[list[float], Sequence[Any], Parameters], float]
"""Function that returns a number from the numbers before it, the values of a case and its parameters."""


class NotFollowed(Exception):
    """Use of a number that cannot be traced."""


class Reader(Protocol):
    """Field that holds a number."""

    def si_value(self, found: object, parameters: Parameters | None) -> float:
        """Return the SI value of an entry of a scene."""


@dataclass(frozen=True)
class Given:
    """Placeholder in a scene for a number that varies.

    Attributes
    ----------
    variation : int
        Index of the value, or of the vector or matrix that contains it, in the values of a case.
    index : tuple of int
        Index of the number in a vector or matrix.
    """

    variation: int
    index: tuple[int, ...] = ()

    def of(self, values: Sequence[Any]) -> Any:
        """Return the number from the values of a case."""
        found = values[self.variation]
        for k in self.index:
            found = found[k]
        return found


class Record:
    """Trace of the operations and comparisons on the values of a case.

    Parameters
    ----------
    changed : collection of str
        Parameters that have other values in other cases.
    values : sequence
        Values of a case.
    parameters : mapping of str to Quantity
        Parameters of that case.
    """

    def __init__(self, changed: Collection[str], values: Sequence[Any], parameters: Parameters) -> None:
        self._changed, self._of_case = frozenset(changed), (values, parameters)
        self._steps: list[Step] = []
        self._known: list[float] = []
        self._compared: list[tuple[Callable[..., Any], int, int, bool]] = []
        self._read: dict[Any, Followed] = {}
        self._closed = False

    def close(self) -> None:
        """End the trace: later operations and comparisons are refused."""
        self._closed = True

    def follows(self, found: object) -> bool:
        """Return True if an entry has another value in other cases."""
        return isinstance(found, Given) or (isinstance(found, str) and not self._changed.isdisjoint(names_in(found)))

    def read(self, reader: Reader, found: Any) -> Followed:
        """Return the traced number of a field; repeated entries are read once."""
        key = reader, found
        if key not in self._read:
            self._read[key] = self._put(partial(_read, reader, found))
        return self._read[key]

    def computed(self, function: Callable[..., float], *operands: Any) -> Followed:
        """Return the traced result of a function of traced and plain numbers."""
        return self._put(partial(_applied, function, tuple(map(self._place, operands))))

    def compared(self, function: Callable[..., Any], left: Any, right: Any) -> bool:
        """Return the outcome of a comparison, and record it."""
        self._refuse_when_closed()
        places = self._place(left), self._place(right)
        outcome = bool(function(*(self._known[place] for place in places)))
        self._compared.append((function, *places, outcome))
        return outcome

    def numbers(self, values: Sequence[Any], parameters: Parameters) -> list[float] | None:
        """Return all numbers by `Followed.place`, for the values of another case; None if a comparison differs.

        Raises
        ------
        ValueError, ArithmeticError
            If a value cannot be read.
        """
        known: list[float] = []
        for step in self._steps:
            known.append(step(known, values, parameters))
        alike = all(bool(function(known[k], known[m])) is outcome for function, k, m, outcome in self._compared)
        return known if alike else None

    def _refuse_when_closed(self) -> None:
        if self._closed:
            raise NotFollowed

    def _put(self, step: Step) -> Followed:
        self._refuse_when_closed()
        self._known.append(step(self._known, *self._of_case))
        self._steps.append(step)
        return Followed(self, len(self._steps) - 1)

    def _place(self, operand: Any) -> int:
        if isinstance(operand, Followed):
            return operand.place
        if not isinstance(operand, int | float):
            raise NotFollowed
        return self._put(partial(_constant, operand)).place


def _read(reader: Reader, found: Any, known: list[float], values: Sequence[Any], parameters: Parameters) -> float:
    return reader.si_value(found.of(values) if isinstance(found, Given) else found, parameters)


def _applied(
    function: Callable[..., float], places: tuple[int, ...], known: list[float], values: Sequence[Any], parameters: Parameters
) -> float:  # fmt: skip
    return function(*(known[place] for place in places))


def _constant(number: float, known: list[float], values: Sequence[Any], parameters: Parameters) -> float:
    return number


class Followed:
    """Traced number: supports arithmetic and comparison, and nothing else.

    Attributes
    ----------
    place : int
        Index among the numbers of its record.
    """

    __hash__ = None  # type: ignore[assignment]

    def __init__(self, record: Record, place: int) -> None:
        self._record, self.place = record, place

    def _with(self, function: Callable[..., float], *operands: Any) -> Followed:
        return self._record.computed(function, *operands)

    def __add__(self, other: Any) -> Followed:
        return self._with(operator.add, self, other)

    def __radd__(self, other: Any) -> Followed:
        return self._with(operator.add, other, self)

    def __sub__(self, other: Any) -> Followed:
        return self._with(operator.sub, self, other)

    def __rsub__(self, other: Any) -> Followed:
        return self._with(operator.sub, other, self)

    def __mul__(self, other: Any) -> Followed:
        return self._with(operator.mul, self, other)

    def __rmul__(self, other: Any) -> Followed:
        return self._with(operator.mul, other, self)

    def __truediv__(self, other: Any) -> Followed:
        return self._with(operator.truediv, self, other)

    def __rtruediv__(self, other: Any) -> Followed:
        return self._with(operator.truediv, other, self)

    def __neg__(self) -> Followed:
        return self._with(operator.neg, self)

    def __abs__(self) -> Followed:
        return self._with(abs, self)

    def __lt__(self, other: Any) -> bool:
        return self._record.compared(operator.lt, self, other)

    def __le__(self, other: Any) -> bool:
        return self._record.compared(operator.le, self, other)

    def __gt__(self, other: Any) -> bool:
        return self._record.compared(operator.gt, self, other)

    def __ge__(self, other: Any) -> bool:
        return self._record.compared(operator.ge, self, other)

    def __eq__(self, other: Any) -> bool:
        return self._record.compared(operator.eq, self, other)

    def __ne__(self, other: Any) -> bool:
        return self._record.compared(operator.ne, self, other)

    def __bool__(self) -> bool:
        return self._record.compared(operator.ne, self, 0.0)

    def __float__(self) -> float:
        raise NotFollowed

    def __format__(self, form: str) -> str:
        raise NotFollowed

    __str__ = __int__ = __float__  # type: ignore[assignment]
