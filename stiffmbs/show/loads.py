"""Loads of joints and force elements over a run: magnitude, peak, mean and root mean square, with error bars."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ..reading.units.display import SI_UNITS, DisplayUnits
from ..results.digits import largest_bar
from ..results.error_bars import UNKNOWN
from ..results.solution import Solution
from .force_table import LOADS, elements_of, reactions_of, with_bar

UNITS = {"f": "N", "t": "N m"}
"""Unit of the components of a reaction by their first letter: a force, a torque."""
PREFIXES = ((1e6, "M"), (1e3, "k"))
FINEST = 1e-5
"""Smallest error bar that is shown, relative to its value; smaller ones are rounded up to it."""


@dataclass(frozen=True, eq=False)
class Load:
    """Force or torque of one element on its first body.

    The peak is the largest magnitude at an output instant.  Its bar is the magnitude of the components' bars, which
    bounds the error of the vector.
    """

    element: str
    unit: str  # ``N`` or ``N m``
    time: np.ndarray  # shape (n,), s
    components: np.ndarray  # shape (n, 2), (n, 3) or (n, 1): along the ground axes
    bar: float  # bound on the error of the magnitude; nan if unknown
    unique: bool  # False if rigid bodies do not determine it
    excess: float = 0.0  # part of the bar for peaks between output instants
    display: DisplayUnits = SI_UNITS

    @property
    def magnitude(self) -> np.ndarray:
        """Magnitude at the output instants, shape (n,)."""
        return np.asarray(np.sqrt(np.square(self.components).sum(axis=1)))

    @property
    def peak_row(self) -> int:
        """Output instant of the peak; the first if no value is known."""
        sizes = self.magnitude
        return 0 if np.isnan(sizes).all() else int(np.nanargmax(sizes))

    @property
    def peak(self) -> float:
        """Largest magnitude."""
        return float(np.nan_to_num(self.magnitude[self.peak_row]))

    @property
    def mean(self) -> float:
        """Mean magnitude over time."""
        return self.over_time(1)[0]

    @property
    def rms(self) -> float:
        """Root mean square over time."""
        return self.over_time(2)[0]

    def over_time(self, power: int) -> tuple[float, float]:
        """Return the mean over time of a power of the magnitude, its root taken, and the error of the sum over the instants.

        The error is the difference from the sum over every other instant.
        """
        known = np.isfinite(self.magnitude)
        t, values = self.time[known], self.magnitude[known] ** power
        every = np.arange(len(t))
        other = np.union1d(every[::2], every[-1:])
        whole, coarse = (_mean(t[rows], values[rows]) ** (1.0 / power) for rows in (every, other))
        return whole, abs(whole - coarse)


def _mean(t: np.ndarray, values: np.ndarray) -> float:
    if len(t) < 2 or t[-1] <= t[0]:
        return float(values[0]) if len(values) else 0.0
    return float(np.trapezoid(values, t) / (t[-1] - t[0]))


@np.errstate(all="ignore")  # numbers of a diverged run overflow
def loads_of(solution: Solution) -> tuple[list[Load], list[str]]:
    """Return forces and torques, the largest of each first, and the elements that carry none.

    A torque or force without a unique value is listed even if it is zero.
    """
    components, elements = reactions_of(solution), elements_of(solution)
    every = [
        _load(solution, element, [name for name in components if name[0] == kind], unit)
        for kind, unit in UNITS.items()
        for element in elements
    ]
    least = LOADS.zero * max((max(load.peak, load.excess) for load in every), default=0.0)
    kept = [load for load in every if max(load.peak, load.excess) > least or not load.unique]
    found = sorted(kept, key=lambda load: (load.unit != UNITS["f"], -load.peak))
    carrying = {load.element for load in found}
    return found, [element for element in elements if element not in carrying]


def _load(solution: Solution, element: str, parts: Sequence[str], unit: str) -> Load:
    names = [f"{element}.{part}" for part in parts]
    errors = [solution.errors.get(name, UNKNOWN) for name in names]
    bar, excess = (
        float(np.hypot.reduce([size(error) for error in errors]))
        for size in (largest_bar, lambda error: max(error.sampled_least, error.sampled_greatest))
    )
    unique = not any(name in solution.not_unique for name in names)
    values = np.column_stack([solution.channels[name] for name in names])
    return Load(element, unit, solution.time, values, bar, unique, excess, solution.display)


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
