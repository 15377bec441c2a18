"""Choice of the tolerance at which a run has an accuracy that is asked for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
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
    """Accuracy of a run: whether all is reached, a sentence on all groups, and the tolerance to try next if it is not."""

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
        known = KnownErrors(solution)
        errors = [_error(solution, known, each) for each in self._wanted]
        excess = float(max(error / each.error for error, each in zip(errors, self._wanted, strict=True)))
        reached = excess <= 1.0
        following = rtol if reached else self._following(rtol, excess)
        return Judged(reached, _sentence(errors, self._wanted), following)

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


def _error(solution: Solution, known: KnownErrors, each: Wanted) -> float:
    """Return the largest error of a group of channels: infinite if none is known, -inf if none has a unique value other than zero."""
    kind, relative = "" if each.relative else ABSOLUTE[each.group], known.relative(over_time, each.group)
    of_group = [name for name, group in known.group.items() if group == each.group and kind in ("", kind_of(name))]
    if not any(known.sizes[name] for name in of_group if name not in solution.not_unique):
        return -np.inf
    errors = relative if each.relative else {name: solution.errors[name].over_time for name in relative}
    return max((errors[name] for name in of_group if name in errors), default=np.inf)


def _sentence(errors: Sequence[float], all_wanted: Sequence[Wanted]) -> str:
    """Return what was reached, followed by the groups without a number."""
    reached, others = [], []
    for error, each in zip(errors, all_wanted, strict=True):
        asked = f"(asked: {each.text})"
        if np.isfinite(error):
            number, unit = (100.0 * error, "%") if each.relative else (error, UNITS[ABSOLUTE[each.group]])
            reached.append(f"{each.group} {number:.2g} {unit} {asked}")
        elif error > 0.0:
            others.append(f"the errors of {each.group} are unknown {asked}")
        else:
            others.append(f"there are no {each.group} to judge {asked}")
    return ", ".join([*(["reached " + ", ".join(reached)] if reached else []), *others])
