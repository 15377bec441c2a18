"""Verdict on a run: how it ended, how many digits are reliable, and what the user should check."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..notes import Note
from ..results.digits import KnownErrors, digits_words, largest_bar
from ..results.solution import Solution
from ..solve.trajectory import IN_DOUBT, Outcome


@dataclass(frozen=True)
class Verdict:
    """Verdict on a run."""

    status: str  # ``done``, ``doubt`` (completed, but the results may be wrong), ``stopped`` or ``interrupted``
    headline: str  # one sentence on the end of the run
    # reliable digits of positions, velocities and forces, relative to the largest value of each body or element; empty
    # if its errors are unknown
    digits: dict[str, int]
    to_check: tuple[Note, ...]  # notes of the run

    @property
    def digits_words(self) -> str:
        """Reliable digits as a phrase."""
        if not self.digits:
            return "the number of reliable digits is unknown: use --errors or --verify"
        return f"reliable: {digits_words(self.digits)}"


@np.errstate(all="ignore")  # numbers of a diverged run overflow
def verdict(solution: Solution) -> Verdict:
    """Return the verdict on a run."""
    start, end = float(solution.time[0]), float(solution.time[-1])
    words = {Outcome.DONE: "done", Outcome.STOPPED: "stopped", Outcome.INTERRUPTED: "interrupted"}
    status = "doubt" if IN_DOUBT in solution.message else words[solution.outcome]
    headline = f"{start:g} s to {end:g} s: {solution.message}"
    if status == "done":
        headline = f"Completed: {start:g} s to {end:g} s"
    return Verdict(status, headline, KnownErrors(solution).digits(largest_bar), solution.notes)
