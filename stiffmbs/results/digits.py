"""Reliable digits of the results of a run, from the error bars of its channels."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from operator import attrgetter

import numpy as np

from .error_bars import ErrorBar
from .scales import kind_of, scales
from .solution import Solution

GROUPS = {
    "positions": ("position", "angle", "orientation"),
    "velocities": ("velocity", "angular velocity"),
    "forces": ("force", "torque"),
}
"""Groups of channels whose digits are counted together, by the kinds of `stiffmbs.results.scales`."""
MOST_DIGITS = 12


def largest_bar(bar: ErrorBar) -> float:
    """Return the largest known error of a channel: over time and of its peaks, between output times too; nan if unknown."""
    return float(np.fmax.reduce([bar.over_time, bar.least, bar.greatest]))


def relative_bars(solution: Solution, errors: Mapping[str, float]) -> dict[str, float]:
    """Return known errors relative to the largest value of each body or element, by channel."""
    sizes = scales(solution.channels, 1.0, solution.requested)
    return {
        name: error / sizes[name]
        for name, error in errors.items()
        if name in sizes and sizes[name] > 0 and math.isfinite(error) and name not in solution.not_unique
    }


def group_of(solution: Solution, channel: str) -> str:
    """Return the group of a channel; empty for requests and channels of no group."""
    kind = "" if channel in solution.requested else kind_of(channel)
    return next((group for group, kinds in GROUPS.items() if kind in kinds), "")


def digits(solution: Solution, peaks: bool = True) -> dict[str, int]:
    """Return the least number of reliable digits in each group of channels with known errors.

    `peaks`: True to count the errors of peaks between output times, False for the values at the output times alone.
    """
    return dict(_digits(solution, largest_bar if peaks else attrgetter("over_time")))


def _digits(solution: Solution, error_of: Callable[[ErrorBar], float]) -> Iterator[tuple[str, int]]:
    known = relative_bars(solution, {name: error_of(bar) for name, bar in solution.errors.items()})
    for group in GROUPS:
        errors = [error for name, error in known.items() if group_of(solution, name) == group]
        if errors:
            largest = max(max(errors), 10.0**-MOST_DIGITS)
            yield group, max(0, math.floor(-math.log10(largest)))


def digits_words(counts: Mapping[str, int]) -> str:
    """Return numbers of digits as a phrase: positions to 4 digits, forces to 3."""
    words = [f"{name} to {count}" for name, count in counts.items()]
    if words:
        words[0] += " digit" if next(iter(counts.values())) == 1 else " digits"
    return ", ".join(words)
