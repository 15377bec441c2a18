"""Choice of the tolerance at which a run has an accuracy that is asked for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..model.accuracy import Wanted, wanted
from ..model.settings import LARGEST_RTOL
from ..results.digits import KnownErrors, over_time
from ..results.scales import UNITS, kind_of
from ..results.solution import Solution
from .parameters import ESTIMATE

ABSOLUTE = {"positions": "position", "velocities": "velocity", "forces": "force"}


@dataclass(frozen=True)
class Judged:
    """Accuracy of a run: whether all is reached, a phrase on each group, and the tolerance to try next if it is not."""

    reached: bool
    sentence: str
    next_rtol: float


class Accuracy:
    """Accuracy asked for, and the tolerances that were tried."""

    def __init__(self, asked: Mapping[str, object]) -> None:
        self._wanted = wanted(asked)
        self._tried: list[tuple[float, float]] = []

    def first_rtol(self, size: float) -> float:
        """Return the tolerance to begin with. `size`: size of the mechanism, m."""
        least = min(each.error if each.relative else self._as_part(each, size) for each in self._wanted)
        return max(ESTIMATE.smallest_rtol, min(ESTIMATE.part * least, LARGEST_RTOL))

    @staticmethod
    def _as_part(each: Wanted, size: float) -> float:
        return each.error / size if each.group == "positions" else ESTIMATE.part

    def judged(self, solution: Solution, rtol: float) -> Judged:
        """Return the accuracy of a run with a tolerance."""
        phrases, excess = [], 0.0
        for each in self._wanted:
            error = _error(solution, each)
            unit = "%" if each.relative else UNITS[ABSOLUTE[each.group]]
            shown = 100.0 * error if each.relative else error
            phrases.append(f"{each.group} {shown:.2g} {unit} (asked: {each.text})")
            excess = np.fmax(excess, error / each.error) if np.isfinite(error) else np.inf
        reached = bool(excess <= 1.0)
        following = rtol if reached else self._following(rtol, float(excess))
        return Judged(reached, "reached " + ", ".join(phrases), following)

    def _following(self, rtol: float, excess: float) -> float:
        """Return the tolerance at which the error is expected to be a part of that asked for."""
        if not np.isfinite(excess):
            return max(ESTIMATE.smallest_rtol, ESTIMATE.part * rtol)
        self._tried.append((rtol, excess))
        slope = ESTIMATE.slope
        if len(self._tried) > 1:
            (before, more), (now, less) = self._tried[-2:]
            found = np.log(more / less) / np.log(before / now)
            slope = float(np.clip(found, 0.5 * slope, 1.0)) if np.isfinite(found) else slope
        return float(max(ESTIMATE.smallest_rtol, rtol * (ESTIMATE.aim / excess) ** (1.0 / slope)))


def _error(solution: Solution, each: Wanted) -> float:
    """Return the largest error of a group of channels; nan if it is unknown."""
    known = KnownErrors(solution).relative(over_time, each.group)
    if not each.relative:
        kind = ABSOLUTE[each.group]
        known = {name: solution.errors[name].over_time for name in known if kind_of(name) == kind}
    return max(known.values(), default=float("nan"))
