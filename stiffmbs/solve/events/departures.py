"""Departures of a run from the points of tables."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from ...compile.system import System
from ...compile.written_values import table_arguments
from ...notes import Note
from ...reading.table import Table
from ..reasons import Reason

ROUNDING = 1e-9
"""Distance from the points of a table, relative to their range, that is no departure."""


@dataclass(frozen=True)
class Departure:
    """A table whose points a run has left.

    - `element`, `label`: the element that uses the table, and the name of the table or of its field.
    - `reached`: lowest and highest argument. `duration`: time outside, s. `first`: time of the first departure, s.
    """

    element: str
    label: str
    table: Table
    reached: tuple[float, float]
    duration: float
    first: float

    @property
    def extent(self) -> tuple[float, float]:
        """First and last argument of the table."""
        return self.table.table[0][0], self.table.table[-1][0]

    @property
    def beyond(self) -> tuple[float, float]:
        """Distances below the first and above the last argument that were reached, 0 if not left there."""
        (first, last), (low, high) = self.extent, self.reached
        return max(first - low, 0.0), max(high - last, 0.0)

    @property
    def matters(self) -> bool:
        """Return True if the departure is more than rounding."""
        first, last = self.extent
        return max(self.beyond) > ROUNDING * (last - first)

    def end(self, side: int) -> str:
        """Return the first (0) or last (1) point in words."""
        return f"{('first', 'last')[side]} point at {self.extent[side]:.6g}"

    def refusal(self) -> Note:
        """Return the reason why a run ends where the table is left."""
        return Reason.LEFT_TABLE.of(
            f"stopped at t = {self.first:.9g} s: the table '{self.label}' of '{self.element}' was left (beyond: error): its "
            f"argument passes its {self.end(int(self.beyond[1] > self.beyond[0]))}; expected more points, or another 'beyond'",
            self.element,
        )


def departures(system: System, found: Iterable[Sequence[float]]) -> tuple[Departure, ...]:
    """Return the departures from the lowest and highest value, time outside, and first time of each argument of a law."""
    left = zip(table_arguments(system), found, strict=True)
    each = (
        Departure(element, label, table, (low, high), duration, first)
        for (element, label, table), (low, high, duration, first) in left
        if table is not None
    )
    return tuple(departure for departure in each if departure.matters)


def refused_departure(found: Iterable[Departure]) -> Departure | None:
    """Return the first departure from a table with ``beyond: error``, or None."""
    errors = (each for each in found if each.table.beyond == "error")
    return min(errors, key=lambda each: each.first, default=None)


def merged(parts: Iterable[Departure]) -> Iterator[Departure]:
    """Yield the departures from each table of each element in all parts of a run."""
    found: dict[tuple[str, str], Departure] = {}
    for part in parts:
        before = found.get((part.element, part.label))
        if before:
            low, high = zip(before.reached, part.reached, strict=True)
            part = replace(
                before, reached=(min(low), max(high)), duration=before.duration + part.duration,
                first=min(before.first, part.first),
            )  # fmt: skip
        found[part.element, part.label] = part
    yield from found.values()
