"""Looking between output instants: a run at many more of them, but for those at singular poses."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..analyses.job import Job
from ..compile.inputs.features import InputFeatures
from ..results.error_bars import Fine
from ..results.scales import kind_of
from ..results.solution import Solution
from .poses import poses_of
from .solve_again import Again

BLOWN_UP = 0.05
"""Part of its scale by which a channel must exceed what output instants show before the pose there is looked at."""
AT_OUTPUT = 1e-9
"""Part of an interval by which an instant must differ from an output instant."""
PARTS_OF_IMPLICIT_STEPS, PARTS = 2, 4
"""Into how many parts the time between two instants is cut: a polynomial of order 5 or less goes through an implicit
step, one of order 8 through an explicit one."""
MOST_OF_INPUTS = 5000
"""Instants that show what inputs do."""
MOST_VALUES = 3e7
"""Values of a run; more would fill the memory."""
MOST_PRODUCTS = 3e9
"""In the decompositions of poses: a second or so."""


@dataclass(frozen=True)
class DenseSamples:
    """What lies between output instants.

    Attributes
    ----------
    solution : Solution
        At many instants.
    sound : ndarray of bool
        Those at which accelerations and reactions are determined, and the output instants.
    at : ndarray of int
        The output instants among the sound ones.
    singular : tuple of float
        When the others are, s.
    """

    solution: Solution
    sound: np.ndarray
    at: np.ndarray
    singular: tuple[float, ...]

    def fine(self, channel: str) -> Fine:
        """Instants, values there, and which of them are reported."""
        return self.solution.time[self.sound], self.solution[channel][self.sound], self.at


def more_instants(first: Solution, features: InputFeatures) -> np.ndarray:
    """Output instants, ends of the solver's steps, and instants between these; fewer where there are too many.

    Where the inputs have features narrower than the time between output instants, a few instants in each besides.
    """
    reported, own = first.time, first.step_times
    most = int(MOST_VALUES / len(first))
    found = reported
    start, end = float(reported[0]), float(reported[-1])
    narrow = features.instants(start, end, float(np.max(np.diff(reported))), min(most // 4, MOST_OF_INPUTS))
    ends = own[(own > reported[0]) & (own < reported[-1])]
    if len(found) + len(ends) <= most:
        found = np.union1d(found, apart(ends, found))
    parts = PARTS_OF_IMPLICIT_STEPS if len(first.history.order) else PARTS
    if parts * len(found) <= most:
        within = found[:-1, None] + np.diff(found)[:, None] * np.arange(1, parts) / parts
        found = np.union1d(found, apart(within.ravel(), found))
    return np.union1d(found, apart(narrow, found))


def apart(more: np.ndarray, found: np.ndarray) -> np.ndarray:
    """Those of the instants that no rounding makes the same as others."""
    k = np.clip(np.searchsorted(found, more), 1, len(found) - 1)
    nearest = np.minimum(np.abs(found[k] - more), np.abs(more - found[k - 1]))
    return more[nearest > AT_OUTPUT * (found[-1] - found[0]) / len(found)]


def dense_samples(job: Job, run: Again, sizes: Mapping[str, float]) -> DenseSamples | None:
    """What a run at many instants shows between the reported ones; None where it did not come to the end, or too many poses ask
    for a look.

    Where accelerations and reactions are far beyond those at output instants, the pose may be singular: there they are
    quotients of roundings, and are left out.

    Parameters
    ----------
    job : Job
    run : Again
    sizes : mapping of str to float
        Scales of the channels.
    """
    solution = run.solution
    if solution is None or run.obstacle:
        return None
    sound = np.ones(len(solution.time), dtype=bool)
    reported = np.zeros_like(sound)
    reported[run.at] = True
    poses = poses_of(job, solution)
    strained = [
        name for name in solution if sizes[name] and kind_of(name).endswith(("acceleration", "force", "torque"))
    ]
    seen: set[int] = set()
    while peaks := _peaks(solution, strained, sound, run.at, sizes) - seen:
        for k in peaks:
            if poses.products > MOST_PRODUCTS:
                return None
            sound[poses.at_singular(k)] = False
        sound |= reported
        seen |= peaks
    kept = np.flatnonzero(sound)
    return DenseSamples(solution, sound, np.searchsorted(kept, run.at), tuple(solution.time[~sound]))


def _peaks(
    solution: Solution, names: list[str], sound: np.ndarray, at: np.ndarray, sizes: Mapping[str, float]
) -> set[int]:
    """Sound instants at which channels are far beyond what they are at the reported ones."""
    kept = np.flatnonzero(sound)
    reported = np.searchsorted(kept, at)
    return {int(kept[k]) for name in names for k in _blown_up(solution[name][kept], reported, BLOWN_UP * sizes[name])}


def _blown_up(values: np.ndarray, at: np.ndarray, much: float) -> list[int]:
    """Where the least and the greatest value lie, as far as they are beyond the reported ones."""
    low, high = int(np.nanargmin(values)), int(np.nanargmax(values))
    found = [low] if np.nanmin(values[at]) - values[low] > much else []
    return found + ([high] if values[high] - np.nanmax(values[at]) > much else [])
