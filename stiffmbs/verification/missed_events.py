"""Search along a run for events that its steps missed, as an integrator has only a polynomial within a step.

The run is repeated with many output times, within its steps too, where the block system gives the accelerations. Their
integral is the velocity change (momentum balance), unless a force acts that the step has missed. Stiff forces magnify
errors within the tolerance, so an open balance is no proof. Such an interval is therefore solved again with much
shorter steps. If it then ends differently, but not with a tighter tolerance alone, an event was missed.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from ..analyses.job import Job
from ..compile.inputs.features import InputFeatures
from ..compile.reactions import reactions
from ..compile.system import System
from ..dynamics.dynamics import OutputRows
from ..errors import StiffmbsError
from ..results.error_bars import Fine
from ..results.frames import from_own_axes
from ..results.scales import ROUNDING, kind_of
from ..results.solution import Solution
from ..run_checks.singular_poses import PosesBetween
from ..solve.events.narrow_inputs import NARROW_INPUTS
from ..solve.events.restart import restarted
from ..solve.missing_rows import reported
from ..solve.settings import changed, near_constraints, traits_of
from ..solve.trajectory import Grid, Outcome
from .parameters import VERIFICATION
from .solve_again import EXPLICIT, Again, Deadline, uninterrupted


@dataclass(frozen=True)
class SteppedOver:
    """Interval of a run with a missed event.

    `at`: time of the largest imbalance of momentum, s. `width`: length of the unbalanced interval, s. `element`: name
    of the force or joint, or an empty string.
    """

    at: float
    width: float
    element: str

    @property
    def max_step(self) -> float:
        """Longest step that resolves it, s."""
        return float(f"{self.width / VERIFICATION.fewest_steps:.1g}")


@dataclass(frozen=True)
class Along:
    """Result of the search along a run.

    - `stretches`: missed events of the run.
    - `elsewhere`: missed events of the repeated run if it differs.
    - `obstacle`: why no search was made, or an empty string.
    """

    stretches: tuple[SteppedOver, ...] = ()
    elsewhere: tuple[SteppedOver, ...] = ()
    obstacle: str = ""


def looked_along(job: Job, first: Solution, allowed: float) -> Along:
    """Search along a run at many times, with limited effort.

    `first`: of the job. `allowed`: evaluations of the job's equations.
    """
    begun = job.evaluations()
    times = _instants(job, first, VERIFICATION.of_effort_left * allowed)
    deadline = Deadline(job.grid.start, float(times[-1]), allowed, job.evaluations)
    try:
        trajectory = uninterrupted(job.varied(times=times).integrate(deadline), deadline)
    except StiffmbsError as error:
        return Along(obstacle=str(error))
    if deadline.passed:
        return Along(obstacle="missed events were not searched: the limit of evaluations is reached")
    rows, _ = reported(job.dynamics, trajectory, near_constraints(job.settings), job.settings.rtol)
    left = allowed - (job.evaluations() - begun)
    stretches = tuple(_stepped_over(job, rows, trajectory.step_times, left))
    if not _same_motion(first, rows.t, rows.kinetic):
        return Along(elsewhere=stretches)
    return Along(stretches)


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


def _stepped_over(job: Job, rows: OutputRows, steps: np.ndarray, allowed: float) -> Iterator[SteppedOver]:
    """Yield the intervals that end differently when they are solved again, the worst first."""
    system = job.dynamics.system
    poses = PosesBetween(system, rows.t, rows.q)
    missing, speed = _momentum(system, rows)
    end, looked = job.evaluations() + allowed, np.zeros(len(missing), dtype=bool)
    for _ in range(VERIFICATION.stretches):
        worst = int(np.argmax(np.where(looked, 0.0, missing), axis=0)) if len(missing) else 0
        if not len(missing) or looked[worst] or not missing[worst] > VERIFICATION.open_balance * speed:
            return
        left = end - job.evaluations()
        if left <= 0:
            return
        first, last = _stretch(rows.t, steps, worst)
        looked[first:last] = True
        width, element = float(rows.t[worst + 1] - rows.t[worst]), _acting(system, rows, worst)
        if not element or poses.nearest(float(rows.t[first]), float(rows.t[last])) is not None:
            continue  # near a singular pose, any difference may decide the branch
        parted = _parted(job, rows, first, last, width, left / 2, VERIFICATION.diverged * speed)
        if parted > VERIFICATION.elsewhere * speed:
            yield SteppedOver(float(rows.t[worst]), width, element)


def _momentum(system: System, rows: OutputRows) -> tuple[np.ndarray, float]:
    """Return the imbalance of velocities and accelerations in each interval, and the largest velocity.

    Both are norms in the mass matrix. Accelerations are integrated by the trapezoidal rule with end corrections.
    """
    t, u, a = rows.t, rows.u, rows.acceleration
    roots = np.sqrt(system.mass)
    speed = float(np.sqrt(2 * np.nanmax(rows.kinetic, initial=0.0)))
    if len(t) < 3 or not speed:
        return np.zeros(max(len(t) - 1, 0)), speed
    h = np.diff(t)[:, None]
    slope = np.gradient(a, t, axis=0)
    gained = h * (a[1:] + a[:-1]) / 2 + h**2 * (slope[:-1] - slope[1:]) / 12
    return np.nan_to_num(np.linalg.norm((np.diff(u, axis=0) - gained) * roots, axis=1)), speed


def _stretch(t: np.ndarray, steps: np.ndarray, k: int) -> tuple[int, int]:
    """Return the positions of the last step end before an interval and of the first after it."""
    before, after = steps[steps < t[k]], steps[steps > t[k + 1]]
    first = int(np.searchsorted(t, before[-1])) if len(before) else 0
    last = int(np.searchsorted(t, after[0])) if len(after) else len(t) - 1
    return min(first, k), min(max(last, k + 1), len(t) - 1)


def _parted(job: Job, rows: OutputRows, first: int, last: int, width: float, allowed: float, much: float) -> float:
    """Return the velocity difference at the end of an interval solved with short steps, as a norm in the mass matrix.

    It is 0 if the solution stops early, or if a tighter tolerance alone causes much of a small difference.
    """
    roots, again = np.sqrt(job.dynamics.system.mass), partial(_solved_again, job, rows, first, last, allowed)
    short = again({"max_step": width / VERIFICATION.shorter})
    if short is None:
        return 0.0
    off = float(np.linalg.norm((short - rows.u[last]) * roots))
    if off > much:
        return off
    tight = again({"rtol": max(VERIFICATION.stretch_tolerance * job.settings.rtol, VERIFICATION.tightest_rtol)})
    return off if tight is not None and np.linalg.norm((tight - short) * roots) > off / 2 else 0.0


def _solved_again(
    job: Job, rows: OutputRows, first: int, last: int, allowed: float, how: dict[str, object]
) -> np.ndarray | None:
    """Return the velocities at the end of an interval solved with other settings, or None if it stops early."""
    begin, end = float(rows.t[first]), float(rows.t[last])
    how |= EXPLICIT if traits_of(job.settings).switches else {}
    try:
        start = restarted(job.dynamics, begin, rows.q[first], rows.u[first])
        grid = Grid(begin, end, np.array([begin, end]))
        stretch = replace(job, settings=changed(job.settings, how), grid=grid, start=start, subsystems=())
        deadline = Deadline(begin, end, allowed, job.evaluations)
        found = uninterrupted(stretch.integrate(deadline), deadline)
    except StiffmbsError:
        return None
    return found.u[-1] if found.outcome is Outcome.DONE else None


def _acting(system: System, rows: OutputRows, k: int) -> str:
    """Return the force, or joint with a law, whose reaction changes most in an interval, or an empty string."""
    around = slice(max(k - 1, 0), k + 3)
    changes = {
        name: float(np.ptp(values))
        for name, values in reactions(system, rows.values[around]).items()
        if np.isfinite(values).all()
    }
    laws = {name for group in system.groups if not group.record.n_equations or group.has_law for name in group.names}
    of_laws = {name: much for name, much in changes.items() if name.rpartition(".")[0] in laws}
    name = max(of_laws, key=lambda each: of_laws[each], default="")
    return name.rpartition(".")[0] if name and of_laws[name] > VERIFICATION.share * max(changes.values()) else ""


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
