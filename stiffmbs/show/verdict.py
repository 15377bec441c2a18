"""Verdict on a run: how it ended, how many digits are reliable, and what the user should check."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..results.scales import kind_of, scales
from ..results.solution import Solution
from ..solve.trajectory import IN_DOUBT, Outcome

GROUPS = {
    "positions": ("position", "angle", "orientation"),
    "velocities": ("velocity", "angular velocity"),
    "forces": ("force", "torque"),
}
"""Groups of channels whose digits are counted together, by the kinds of `stiffmbs.results.scales`."""
MOST_DIGITS = 12


@dataclass(frozen=True)
class Verdict:
    """Verdict on a run."""

    status: str  # ``done``, ``doubt`` (completed, but the results may be wrong), ``stopped`` or ``interrupted``
    headline: str  # one sentence on the end of the run
    # reliable digits of positions, velocities and forces, relative to the largest value of each body or element; empty
    # if the run was not verified
    digits: dict[str, int]
    to_check: tuple[str, ...]  # notes of the run

    @property
    def digits_words(self) -> str:
        """Reliable digits as a phrase."""
        if not self.digits:
            return "not verified: the number of reliable digits is unknown"
        counted = (f"{name} to {count} digit{'s' if count != 1 else ''}" for name, count in self.digits.items())
        return f"reliable: {', '.join(counted)}"


@np.errstate(all="ignore")  # numbers of a diverged run overflow
def verdict(solution: Solution) -> Verdict:
    """Return the verdict on a run."""
    start, end = float(solution.time[0]), float(solution.time[-1])
    words = {Outcome.DONE: "done", Outcome.STOPPED: "stopped", Outcome.INTERRUPTED: "interrupted"}
    status = "doubt" if IN_DOUBT in solution.message else words[solution.outcome]
    headline = f"{start:g} s to {end:g} s: {solution.message}"
    if status == "done":
        headline = f"Completed: {start:g} s to {end:g} s"
    return Verdict(status, headline, dict(_digits(solution)), solution.notes)


def _digits(solution: Solution) -> Iterator[tuple[str, int]]:
    """Yield the least number of reliable digits in each group of channels with known errors."""
    sizes = scales(solution.channels, 1.0, solution.requested)
    known = {
        name: bar.over_time / sizes[name]
        for name, bar in solution.errors.items()
        if name in sizes and sizes[name] > 0 and math.isfinite(bar.over_time) and name not in solution.not_unique
    }
    for group, kinds in GROUPS.items():
        errors = [error for name, error in known.items() if name not in solution.requested and kind_of(name) in kinds]
        if errors:
            largest = max(max(errors), 10.0**-MOST_DIGITS)
            yield group, max(0, math.floor(-math.log10(largest)))
