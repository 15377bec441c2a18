"""Sampling between output times: a run at many more times, except those at singular poses."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..analyses.job import Job
from ..compile.inputs.features import InputFeatures
from ..results.error_bars import Fine
from ..results.frames import from_own_axes
from ..results.scales import ROUNDING, kind_of
from ..results.solution import Solution
from ..run_checks.singular_poses import PosesOnTheWay
from .parameters import VERIFICATION
from .solve_again import Again


@dataclass(frozen=True)
class DenseSamples:
    """Samples between output times.

    Attributes
    ----------
    solution : Solution
        At many times.
    sound : ndarray of bool
        Mask of the times with determined accelerations and reactions, and of the output times.
    at : ndarray of int
        Positions of the output times among the sound ones.
    singular : tuple of float
        Other times, s.
    """

    solution: Solution
    sound: np.ndarray
    at: np.ndarray
    singular: tuple[float, ...]

    def fine(self, channel: str) -> Fine:
        """Return the sound times, the channel's values there, and the positions of the output times."""
        return self.solution.time[self.sound], self.solution[channel][self.sound], self.at


def more_instants(first: Solution, features: InputFeatures) -> np.ndarray:
    """Return output times, ends of steps, and times between these; fewer if there are too many.

    If inputs have features narrower than the output interval, a few times in each are added.
    """
    reported, own = first.time, first.step_times
    most = int(VERIFICATION.most_values / len(first))
    found = reported
    start, end = float(reported[0]), float(reported[-1])
    narrow = features.instants(
        start, end, float(np.max(np.diff(reported))), min(most // 4, VERIFICATION.most_of_inputs)
    )
    ends = own[(own > reported[0]) & (own < reported[-1])]
    if len(found) + len(ends) <= most:
        found = np.union1d(found, apart(ends, found))
    parts = VERIFICATION.parts_of_implicit_steps if len(first.history.order) else VERIFICATION.parts
    if parts * len(found) <= most:
        within = found[:-1, None] + np.diff(found)[:, None] * np.arange(1, parts) / parts
        found = np.union1d(found, apart(within.ravel(), found))
    return np.union1d(found, apart(narrow, found))


def apart(more: np.ndarray, found: np.ndarray) -> np.ndarray:
    """Return the times that differ from others by more than rounding."""
    k = np.clip(np.searchsorted(found, more), 1, len(found) - 1)
    nearest = np.minimum(np.abs(found[k] - more), np.abs(more - found[k - 1]))
    return more[nearest > ROUNDING * (found[-1] - found[0]) / len(found)]


def dense_samples(job: Job, run: Again, sizes: Mapping[str, float]) -> DenseSamples | None:
    """Return the samples of a run; None if it stopped early or too many poses need a check.

    If accelerations and reactions are far larger than at output times, the pose may be singular. They are then
    dominated by rounding, and such times are omitted.

    Parameters
    ----------
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
            if poses.products > VERIFICATION.most_products:
                return None
            sound[poses.at_singular(k)] = False
        sound |= reported
        seen |= peaks
    kept = np.flatnonzero(sound)
    return DenseSamples(solution, sound, np.searchsorted(kept, run.at), tuple(solution.time[~sound]))


def _peaks(
    solution: Solution, names: list[str], sound: np.ndarray, at: np.ndarray, sizes: Mapping[str, float]
) -> set[int]:
    """Return the sound times at which channels are far larger than at output times."""
    kept = np.flatnonzero(sound)
    reported = np.searchsorted(kept, at)
    found = set()
    for name in names:
        values = solution[name][kept]
        for excess, extreme in zip(beyond(values, reported), (np.nanargmin, np.nanargmax), strict=True):
            if excess > VERIFICATION.blown_up * sizes[name]:
                found.add(int(kept[extreme(values)]))
    return found


def beyond(values: np.ndarray, at: np.ndarray) -> tuple[float, float]:
    """Return the excess of a channel below and above its output values."""
    return float(np.nanmin(values[at]) - np.nanmin(values)), float(np.nanmax(values) - np.nanmax(values[at]))


def poses_of(job: Job, solution: Solution) -> PosesOnTheWay:
    """Return the poses of a solution with their distances from singular ones."""
    system = job.dynamics.system
    names = [f"{body}.{name}" for body in system.bodies for name in system.of_body.positions]
    q = from_own_axes(system, np.column_stack([solution[name] for name in names]))
    behind = np.zeros((len(q), system.n_q - system.n_pose))  # irrelevant, as only J is evaluated
    return PosesOnTheWay(system, solution.time, np.column_stack([q, behind]))
