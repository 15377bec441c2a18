"""Numbers of a scene that are followed through reading and checking, so that other values need neither again.

An element is made once with `Followed` in place of the numbers that are varied.  What is computed from these is written down
step by step, and so is the outcome of every comparison.  With other values the steps are repeated; where all comparisons come
out alike, reading the element anew would have gone the same way.  What cannot be followed, such as a number given to NumPy, is
refused.
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
"""The key of a `Record` in the context of a validation."""
Parameters = Mapping[str, Quantity]
Step = Callable[[list[float], Sequence[Any], Parameters], float]
"""A number from those before it, the values of a case and its parameters."""


class NotFollowed(Exception):
    """A number was used in a way that cannot be repeated with others."""


class Reader(Protocol):
    """A field that holds a number."""

    def si_value(self, found: object, parameters: Parameters | None) -> float:
        """Of what stands in the scene."""


@dataclass(frozen=True)
class Given:
    """Stands in a scene for a number that is varied.

    Attributes
    ----------
    variation : int
        Which of the values of a case it is, or is in.
    index : tuple of int
        Of the number in a vector or matrix.
    """

    variation: int
    index: tuple[int, ...] = ()

    def of(self, values: Sequence[Any]) -> Any:
        """The number in the values of a case."""
        found = values[self.variation]
        for k in self.index:
            found = found[k]
        return found


class Record:
    """What is computed from the values of a case, and how comparisons came out.

    Parameters
    ----------
    changed : collection of str
        The parameters that have other values in other cases.
    values : sequence
        Those of a case.
    parameters : mapping of str to Quantity
        Of that case.
    """

    def __init__(self, changed: Collection[str], values: Sequence[Any], parameters: Parameters) -> None:
        self._changed, self._of_case = frozenset(changed), (values, parameters)
        self._steps: list[Step] = []
        self._known: list[float] = []
        self._compared: list[tuple[Callable[..., Any], int, int, bool]] = []
        self._read: dict[Any, Followed] = {}
        self._closed = False

    def close(self) -> None:
        """Write nothing down any more: whoever still computes or compares with the numbers is refused."""
        self._closed = True

    def follows(self, found: object) -> bool:
        """Whether what stands in the scene has another value in other cases."""
        return isinstance(found, Given) or (isinstance(found, str) and not self._changed.isdisjoint(names_in(found)))

    def read(self, reader: Reader, found: Any) -> Followed:
        """The number that a field holds; what stands there several times is read once."""
        key = reader, found
        if key not in self._read:
            self._read[key] = self._put(partial(_read, reader, found))
        return self._read[key]

    def computed(self, function: Callable[..., float], *operands: Any) -> Followed:
        """What a function of followed and plain numbers gives."""
        return self._put(partial(_applied, function, tuple(map(self._place, operands))))

    def compared(self, function: Callable[..., Any], left: Any, right: Any) -> bool:
        """How a comparison comes out."""
        self._refuse_when_closed()
        places = self._place(left), self._place(right)
        outcome = bool(function(*(self._known[place] for place in places)))
        self._compared.append((function, *places, outcome))
        return outcome

    def numbers(self, values: Sequence[Any], parameters: Parameters) -> list[float] | None:
        """All numbers by `Followed.place`, with the values of another case; None where a comparison comes out otherwise.

        Raises
        ------
        ValueError, ArithmeticError
            Where a value cannot be read.
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
    """A number that is followed: it computes and compares as a number does, and can do nothing else.

    Attributes
    ----------
    place : int
        Among the numbers of its record.
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
