"""Declared arguments: each field of a statement's dataclass states the argument that it is read from."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, fields
from typing import ClassVar, Self, TypeVar

from ..functions.function import Function, read_function, required_function
from .arguments import Arguments
from .text import DatasetFault, Statement
from .units import Units

Read = TypeVar("Read")
"""Value of a field that is read from the arguments of a statement."""


@dataclass(frozen=True)
class Numbered:
    """Statement with a number. A class of statements declares each argument by the field that it sets."""

    ident: int
    line: int
    alias: str
    keyword: str
    ignored: ClassVar[Mapping[str, str]] = {}  # arguments without effect, with the reason
    refused: ClassVar[Mapping[str, str]] = {}  # arguments that are not supported, with the supported ones
    others: ClassVar[tuple[str, ...]] = ()  # arguments that only `check` reads
    repeated: ClassVar[tuple[str, ...]] = ()  # arguments that may occur several times

    @property
    def label(self) -> str:
        """Name and number of the statement in messages: ``JOINT/3``."""
        return f"{self.keyword}/{self.ident}"

    @property
    def name(self) -> str:
        """Name of its element in the scene."""
        return f"{self.keyword}_{self.ident}"

    def fault(self, reason: str) -> DatasetFault:
        """Return the error for a fault of the statement in its dataset."""
        return DatasetFault(self.line, self.label, reason)

    @classmethod
    def read(cls, keyword: str, statement: Statement, units: Units) -> Self:
        """Read a statement of this class. Raises DatasetFault."""
        declared = {each.name: each.metadata for each in fields(cls) if "read" in each.metadata}
        names = [name for one in declared.values() for name in one["names"]]
        functions = ["FUNCTION", *(name for one in declared.values() if one["expressions"] for name in one["names"])]
        found = Arguments(
            statement, keyword, (*names, *cls.others, *cls.ignored, *cls.refused), functions, cls.repeated
        )
        for name, expected in cls.refused.items():
            found.refuse((name,), expected)
        cls.check(found)
        head = found.head()
        return cls(*head, **{name: one["read"](found, units) for name, one in declared.items()})

    @classmethod
    def check(cls, found: Arguments) -> None:
        """Raise DatasetFault for inconsistent arguments."""


def read_by(read: Callable[[Arguments, Units], Read], *names: str, expressions: bool = False) -> Read:
    """Declare a field that a function reads from the named arguments. `expressions`: they are function expressions."""
    return field(metadata={"read": read, "names": names, "expressions": expressions})


def constant(value: Read) -> Read:
    """Declare a field with one value, which no argument sets."""
    return read_by(lambda *_: value)


def ident(name: str) -> int:
    """Declare a required number of a statement."""
    return read_by(lambda found, _: found.required(name), name)


def ident_or_none(name: str) -> int | None:
    """Declare a number of a statement; None if it is missing."""
    return read_by(lambda found, _: found.reference(name), name)


def number(name: str, **powers: float) -> float:
    """Declare a number with the powers of its unit, as `Units.of`; 0 if it is missing."""
    return read_by(lambda found, units: (found.number(name) or 0.0) * units.of(**powers), name)


def above_zero(name: str, **powers: float) -> float:
    """Declare a required number above zero with the powers of its unit."""
    return read_by(lambda found, units: found.needed(name) * units.of(**powers), name)


def given(name: str) -> bool:
    """Declare a field that is true if an argument is present."""
    return read_by(lambda found, _: name in found, name)


def one_of(*words: str, missing: str) -> str:
    """Declare a field that is the one of several words in the statement; without any, the fault `missing`."""

    def read(found: Arguments, _: Units) -> str:
        word = found.one_of(*words)
        if word is None:
            raise found.fault(missing)
        return word

    return read_by(read, *words)


def one_of_or_none(*words: str) -> str | None:
    """Declare a field that is the one of several words in the statement; None without any."""
    return read_by(lambda found, _: found.one_of(*words), *words)


def expression(name: str) -> Function:
    """Declare a required function expression."""
    return read_by(lambda found, _: required_function(found, name), name, expressions=True)


def expressions(*names: str) -> tuple[Function | None, ...]:
    """Declare a tuple of function expressions; None for those that are missing."""
    return read_by(lambda found, _: tuple(read_function(found, name) for name in names), *names, expressions=True)


def named_words(found: Arguments, name: str) -> Iterator[str]:
    """Yield the words of an argument such as ``(PRELOAD:REACTION_FORCE)`` in capitals."""
    text = (found.text(name) or "ALL").strip(" ()").upper()
    yield from (word.strip() for word in text.replace(",", ":").split(":"))
