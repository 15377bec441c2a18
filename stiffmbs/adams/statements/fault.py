"""Errors in statements of a dataset or command file."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, TypeVar

from ...errors import InputError

MOST_TOLD = 8
Thing = TypeVar("Thing")


class DatasetFault(InputError):
    """Error in a statement, with its line; the reader of the file prepends the file name."""

    def __init__(self, line: int, label: str, reason: str) -> None:
        super().__init__(f"line {line}, {label}: {reason}")
        self.line, self.label, self.reason = line, label, reason


class CommandFault(DatasetFault):
    """Error in a command, with its line in the command file."""


def of_each(things: Iterable[Thing], make: Callable[[Thing], dict[str, Any]]) -> dict[str, Any]:
    """Merge the results of a function for each item; the faults of all items are raised as one."""
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
    """Raise several faults as one, at the line of the first; do nothing if there are none."""
    if not faults:
        return
    first, *others = faults
    told = [first.reason, *map(str, others[: MOST_TOLD - 1])]
    more = f"; and {len(faults) - MOST_TOLD} more" if len(faults) > MOST_TOLD else ""
    raise DatasetFault(first.line, first.label, "; ".join(told) + more)
