"""Tables of the loads of a run, in one unit each."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ..evaluation.loads import Load
from ..reading.units.display import SI_UNITS, DisplayUnits
from .force_table import with_bar

PREFIXES = ((1e6, "M"), (1e3, "k"))
FINEST = 1e-5
"""Smallest error bar that is shown, relative to its value; smaller ones are rounded up to it."""


@dataclass(frozen=True)
class Column:
    """Unit of the numbers of a table, chosen once for all of its rows."""

    unit: str  # with a prefix, such as ``kN``
    factor: float  # of numbers in SI units

    @classmethod
    def of(cls, unit: str, largest: float, display: DisplayUnits = SI_UNITS) -> Column:
        """Return the unit that is chosen, or that in which a largest value has one to three digits before the point."""
        chosen, factor = display.of(unit)
        if chosen != unit:
            return cls(chosen, factor)
        size, prefix = next((pair for pair in PREFIXES if largest >= pair[0]), (1.0, ""))
        return cls(prefix + unit, 1.0 / size)

    def words(self, value: float, bar: float) -> str:
        """Return a value in SI units, with its bar if known, in the unit of the column; tiny bars are widened to `FINEST`."""
        if np.isnan(bar):
            return f"{value * self.factor:.5g}"
        return with_bar(value * self.factor, max(bar, FINEST * abs(value)) * self.factor)


@dataclass(frozen=True)
class LoadRow:
    """Row of the table of loads, ready to print."""

    element: str
    about: str  # its kind and bodies
    peak: str
    bar: str  # half width of the error bar of the peak, or an empty string
    at: str  # time of the peak, s
    mean: str
    rms: str
    share: float  # peak over the largest one
    unique: bool


def load_rows(loads: Sequence[Load], column: Column, about: dict[str, str]) -> Iterator[LoadRow]:
    """Yield a row for each load; `about` has the kind and bodies of each element."""
    largest = max((load.peak for load in loads), default=0.0)
    for load in loads:
        peak, _, bar = column.words(load.peak, load.bar).partition(" \N{PLUS-MINUS SIGN} ")
        mean, rms = (column.words(value, float(np.nan_to_num(load.bar)) + error).partition(" ")[0]
                     for value, error in (load.over_time(power) for power in (1, 2)))  # fmt: skip
        share = load.peak / largest if largest > 0 else 0.0
        at = f"{load.time[load.peak_row]:.4g}"
        yield LoadRow(load.element, about.get(load.element, ""), peak, bar, at, mean, rms, share, load.unique)
