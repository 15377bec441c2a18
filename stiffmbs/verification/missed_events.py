"""Search along a run for events that its steps missed, as an integrator has only a polynomial within a step.

The run is repeated with many output times, within its steps too. At these it is checked as any run is at its output times
(`stiffmbs.run_checks.overlooked`).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from ..analyses.job import Job
from ..analyses.rerun import velocities_again
from ..compile.inputs.features import InputFeatures
from ..errors import StiffmbsError
from ..results.error_bars import Fine
from ..results.frames import from_own_axes
from ..results.scales import ROUNDING, kind_of
from ..results.solution import Solution
from ..run_checks.overlooked import Overlooked, overlooked
from ..run_checks.singular_poses import PosesBetween
from ..solve.events.narrow_inputs import NARROW_INPUTS
from ..solve.missing_rows import reported
from ..solve.settings import near_constraints
from .parameters import VERIFICATION
from .solve_again import Again, Deadline, uninterrupted


@dataclass(frozen=True)
class Along:
    """Result of the search along a run.

    - `missed`: missed events of the run, or None. Their duration is the distance of samples.
    - `elsewhere`: missed events of the repeated run if it differs.
    - `obstacle`: why no search was made, or an empty string.
    """

    missed: Overlooked | None = None
    elsewhere: Overlooked | None = None
    obstacle: str = ""

    @property
    def max_step(self) -> float:
        """Longest step that resolves the events, s; infinite if none was missed."""
        durations = [each.shortest for each in (self.missed, self.elsewhere) if each]
        return float(f"{min(durations, default=math.inf) / VERIFICATION.fewest_steps:.1g}")


def looked_along(job: Job, first: Solution, allowed: float) -> Along:
    """Search along a run at many times, with limited effort.

    `first`: of the job. `allowed`: evaluations of the job's equations.
    """
    times = _instants(job, first, VERIFICATION.of_effort_left * allowed)
    deadline = Deadline(job.grid.start, float(times[-1]), allowed, job.evaluations)
    try:
        trajectory = uninterrupted(job.varied(times=times).integrate(deadline), deadline)
    except StiffmbsError as error:
        return Along(obstacle=str(error))
    if deadline.passed:
        return Along(obstacle="missed events were not searched: the limit of evaluations is reached")
    rows, _ = reported(job.dynamics, trajectory, near_constraints(job.settings), job.settings.rtol)

    def again(k: int) -> np.ndarray | None:
        return velocities_again(job, rows.t[k : k + 2], rows.q[k], rows.u[k])

    found = overlooked(job.dynamics, rows, trajectory, job.settings, again)
    if found is not None:
        k = max(1, int(np.searchsorted(rows.t, found.times[0])))
        found = replace(found, shortest=float(np.diff(rows.t[k - 1 : k + 1])[0]))
    return Along(found) if _same_motion(first, rows.t, rows.kinetic) else Along(elsewhere=found)


def _same_motion(first: Solution, t: np.ndarray, kinetic: np.ndarray) -> bool:
    """Return True if a run with more output times has the same kinetic energies."""
    at = np.minimum(np.searchsorted(t, first.time), len(t) - 1)
    own = first["energy.kinetic"]
    return bool(np.nanmax(np.abs(own - kinetic[at])) <= VERIFICATION.elsewhere * np.nanmax(own, initial=0.0))


def _instants(job: Job, first: Solution, allowed: float) -> np.ndarray:
    """Return output times, ends of steps, and as many evenly spaced times as the effort allows."""
    reported_at, steps = first.time, first.step_times
    start, end = float(reported_at[0]), float(reported_at[-1])
    begun = job.evaluations()
    job.dynamics.report(np.array([start]), job.start.q[None], job.start.u[None], True)
    each = job.evaluations() - begun
    most = int(np.clip(allowed / each, 2, VERIFICATION.samples))
    found = np.union1d(reported_at, apart(steps[(steps > start) & (steps < end)], reported_at))
    spread = np.linspace(start, end, most)[1:-1]
    return np.union1d(found, apart(spread, found)) if most > 2 else found


@dataclass(frozen=True)
class DenseSamples:
    """Samples between output times.

    - `solution`: at many times.
    - `sound`: mask of the times with determined accelerations and reactions, and of the output times.
    - `at`: positions of the output times among the sound ones.
    - `singular`: other times, s.
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
    narrow = features.instants(start, end, float(np.max(np.diff(reported))), min(most // 4, NARROW_INPUTS.most_samples))
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
    dominated by rounding, and such times are omitted. `sizes`: scales of the channels.
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


def poses_of(job: Job, solution: Solution) -> PosesBetween:
    """Return the poses of a solution with their distances from singular ones."""
    system = job.dynamics.system
    names = [f"{body}.{name}" for body in system.bodies for name in system.of_body.positions]
    q = from_own_axes(system, np.column_stack([solution[name] for name in names]))
    trailing = np.zeros((len(q), system.n_q - system.n_pose))  # irrelevant, as only J is evaluated
    return PosesBetween(system, solution.time, np.column_stack([q, trailing]))
