"""Reliable digits of the results of a run, from the error bars of its channels."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from .error_bars import ErrorBar, ErrorEstimate
from .scales import REQUEST_ROUNDING, kind_of, scales
from .solution import Solution

GROUPS = {
    "positions": ("position", "angle", "orientation"),
    "velocities": ("velocity", "angular velocity"),
    "forces": ("force", "torque"),
}
"""Groups of channels whose digits are counted together, by the kinds of `stiffmbs.results.scales`."""
MOTIONS = ("positions", "velocities")
"""Groups of channels that have an absolute tolerance."""
MOST_DIGITS = 12


def over_time(bar: ErrorBar) -> float:
    """Return the error of a channel at the output times."""
    return bar.over_time


def largest_bar(bar: ErrorBar) -> float:
    """Return the largest known error of a channel: over time and of its peaks, between output times too; nan if unknown."""
    return float(np.fmax.reduce([bar.over_time, bar.least, bar.greatest]))


class KnownErrors:
    """Errors of the channels of a run relative to their sizes: the largest value of each body or element.

    `group`: group of each channel; empty for requests and channels of no group. `sizes`: in the units of the channels; of
    motions at least what the absolute tolerance resolves; zero of forces that may be rounding of coordinates.
    """

    def __init__(self, solution: Solution) -> None:
        self.sizes = scales(solution.channels, 1.0, solution.requested)
        self._solution, self._rounding = solution, REQUEST_ROUNDING * max(self.sizes.values(), default=0.0)
        self.group = {name: "" if name in solution.requested else _group(kind_of(name)) for name in self.sizes}
        if solution.estimate:
            resolved = {name: solution.estimate.resolved for name, own in self.group.items() if own in MOTIONS}
            self.sizes |= {name: max(self.sizes[name], least) for name, least in resolved.items()}
            rounding = {"force": solution.estimate.resolved_force, "torque": solution.estimate.resolved_torque}
            forces = [name for name, own in self.group.items() if own == "forces"]
            self.sizes |= {name: 0.0 for name in forces if self.sizes[name] <= rounding[kind_of(name)]}

    def relative(self, error_of: Callable[[ErrorBar], float], group: str = "") -> dict[str, float]:
        """Return known errors by channel, of one group or of all groups."""
        found = {}
        for name, own in self.group.items():
            if own and group in ("", own) and self.sizes[name] > self._rounding and name in self._solution.errors:
                bar = self._solution.errors[name]
                if kind_of(name) == "orientation":  # Euler parameters of a body that turns have peaks that mean nothing
                    bar = ErrorBar(bar.over_time, bar.over_time, bar.over_time, 0.0, 0.0)
                error = error_of(bar) / self.sizes[name]
                if math.isfinite(error) and name not in self._solution.not_unique:
                    found[name] = error
        return found

    def digits(self, error_of: Callable[[ErrorBar], float]) -> dict[str, int]:
        """Return the least number of reliable digits in each group of channels with known errors."""
        found = {}
        for group in GROUPS:
            if errors := self.relative(error_of, group):
                largest = max(max(errors.values()), 10.0**-MOST_DIGITS)
                found[group] = max(0, math.floor(-math.log10(largest)))
        return found

    def largest(self, error_of: Callable[[ErrorBar], float]) -> tuple[str, float]:
        """Return the channel with the largest error, and that error; nan if none is known."""
        known = self.relative(error_of)
        name = max(known, key=lambda each: known[each], default="")
        return name, known.get(name, math.nan)

    def estimate(self) -> ErrorEstimate:
        """Return the estimate of the errors in words."""
        largest, relative = self.largest(over_time)
        peak, of_peak = self.largest(largest_bar)
        sentence = digits_words(self.digits(over_time))
        if largest:
            sentence += f"; largest error: {largest} {100 * relative:.2g} %"
        if of_peak - relative > relative:
            sentence += f"; peaks between output times: up to {100 * of_peak:.2g} % ({peak}), less with a shorter output interval"
        before = self._solution.estimate or ErrorEstimate("estimated", "")
        return replace(before, sentence=sentence, largest=largest, relative=relative)


def _group(kind: str) -> str:
    return next((group for group, kinds in GROUPS.items() if kind in kinds), "")


def digits_words(counts: Mapping[str, int]) -> str:
    """Return numbers of digits as a phrase: positions to 4 digits, forces to 3."""
    words = [f"{name} to {count}" for name, count in counts.items()]
    if words:
        words[0] += " digit" if next(iter(counts.values())) == 1 else " digits"
    return ", ".join(words)
