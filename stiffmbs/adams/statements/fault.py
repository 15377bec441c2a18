"""Where in a dataset something is wrong."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, TypeVar

from ...errors import InputError

MOST_TOLD = 8
Thing = TypeVar("Thing")


class DatasetFault(InputError):
    """What is wrong with a statement, and its line; the file's name is put before it by the reader of the file."""

    def __init__(self, line: int, label: str, reason: str) -> None:
        super().__init__(f"line {line}, {label}: {reason}")
        self.line, self.label, self.reason = line, label, reason


class CommandFault(DatasetFault):
    """The same of a command, with its line in the command file."""


def of_each(things: Iterable[Thing], make: Callable[[Thing], dict[str, Any]]) -> dict[str, Any]:
    """What is made of each thing, all in one; the faults of all of them are raised as one."""
    found: dict[str, Any] = {}
    faults = []
    for thing in things:
        try:
            found |= make(thing)
        except DatasetFault as fault:
            faults.append(fault)
    raise_all(faults)
    return found


def raise_all(faults: Sequence[DatasetFault]) -> None:
    """Raise what is wrong with several statements as one fault, at the line of the first; nothing without any."""
    if not faults:
        return
    first, *others = faults
    told = [first.reason, *map(str, others[: MOST_TOLD - 1])]
    more = f"; and {len(faults) - MOST_TOLD} more" if len(faults) > MOST_TOLD else ""
    raise DatasetFault(first.line, first.label, "; ".join(told) + more)
