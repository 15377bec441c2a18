"""Errors of a run: recording of its steps, and the estimate from them or from a second run."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ..error_estimate.parameters import ESTIMATE
from ..errors import StiffmbsError
from ..model.settings import LARGEST_RTOL, RunSettings
from ..notes import Note, NoteKind, Severity
from ..results.error_bars import ErrorEstimate
from ..solve.sampling import restarts
from ..solve.settings import changed, misses_breakpoints, traits_of
from ..solve.trajectory import SAME_TIME, Outcome, ProgressCallback, Recording, Trajectory
from ..tuning import in_use

if TYPE_CHECKING:
    from ..error_estimate.accuracy import Judged
    from ..results.solution import Solution
    from .job import Job

NOT_REACHED = NoteKind(
    "accuracy-not-reached",
    "the requested accuracy was not reached: {found} {how}",
    "use a smaller {setting}, or --verify",
)
EXACT = NoteKind(
    "accuracy-exact",
    "the requested accuracy is reached: {solver} follows the drives, exact up to rounding, without rtol",
    severity=Severity.REMARK,
)
NOT_JUDGED = NoteKind("accuracy-not-judged", "the requested accuracy cannot be judged: errors are {why}")
MOST_REPEATS = 2
"""Runs with another tolerance after the first one, in search of an accuracy, or of errors where steps do not change."""
ASK = "--errors, or errors: true in run, estimates it"


def recording(job: Job) -> Job:
    """Return a job whose implicit steps are recorded: always if its errors are to be estimated, else up to some work.

    Steps between samples of states are not recorded: a second run estimates their errors.
    """
    asked = True if job.settings.accuracy else job.settings.errors
    with in_use(job.settings.tuning):
        most = {True: np.inf, None: ESTIMATE.work, False: 0.0}[asked]
        recorded = Recording(most, ESTIMATE.row, ESTIMATE.solution, ESTIMATE.restart, ESTIMATE.events)
    return replace(job, grid=replace(job.grid, recorded=recorded))


def assessed(job: Job, trajectory: Trajectory, solution: Solution) -> Solution:
    """Return the results of a job with an estimate of their errors, or a sentence on why there is none."""
    traits = traits_of(job.settings)
    if len(solution.time) < 2 or solution.outcome is Outcome.INTERRUPTED or traits.exact:
        return solution
    if solution.notes and _may_differ(solution.notes):
        return _without(solution, "not estimated: more than one motion may follow, as a note says")
    with in_use(job.settings.tuning), np.errstate(all="ignore"):
        if trajectory.recorded:
            from ..error_estimate.estimate import estimated

            return estimated(solution, job.data, job.dynamics, job.start, job.subsystems, trajectory, job.settings)
        if misses_breakpoints(job.settings, job.dynamics.system):
            why = f"{traits.name} does not locate breakpoints of forces, where half a step may have the same error"
            return _without(solution, f"not estimated: {why}; --verify compares with other runs")
        if _work(job, trajectory) <= job.grid.recorded.most:
            return _by_second_run(job, trajectory, solution)
    return _without(
        solution, f"not estimated: that takes some time for {_steps(trajectory)} steps of this model; {ASK}"
    )


def _may_differ(notes: Iterable[Note]) -> bool:
    """Return True if a note says that the run follows one of several motions: its difference from another one is no error."""
    from ..run_checks.motion import SEVERAL_MOTIONS
    from ..run_checks.singular_poses import SEVERAL

    return any(SEVERAL in note or note.kind == SEVERAL_MOTIONS.name for note in notes)


def _steps(trajectory: Trajectory) -> int:
    return int(trajectory.statistics.get("steps", 0))


def _work(job: Job, trajectory: Trajectory) -> float:
    """Return the work of a second run, evaluations of the equations times unknowns; infinite if recorded steps have been too many."""
    from ..solve.explicit.dop853 import DOP853

    system, steps, found = job.dynamics.system, _steps(trajectory), trajectory.statistics
    unknowns = system.n_q + system.n_u + system.n_c
    if traits_of(job.settings).fixed_steps:
        return 2.0 * float(found.get("accelerations") or found["factorizations"]) * unknowns
    if not found.get("jacobians") or "projected" in trajectory.solver:
        return steps * DOP853.stages * unknowns
    return steps * ESTIMATE.row + float(found["residuals"]) * unknowns if system.sampled.any() else np.inf


def _by_second_run(job: Job, trajectory: Trajectory, solution: Solution) -> Solution:
    """Return the results with errors from a run at a smaller tolerance, or at a larger one if there is none, or with half the step.

    Where breakpoints or samples limit the steps, both runs may take the same ones, whose errors do not differ; another run then
    takes smaller ones.
    """
    from ..error_estimate.estimate import with_bars
    from ..results.error_bars import bars_by_difference
    from .run import finished

    grid, longest = job.grid, 0.0
    breakpoints = restarts(job.dynamics, grid)
    times, at = _with_steps(solution, trajectory, breakpoints)
    for repeats in range(1, MOST_REPEATS + 1):
        settings, part, how, last = _second_run(job.settings, trajectory, repeats, longest)
        try:
            other = finished(replace(job, settings=settings, grid=replace(job.grid, recorded=Recording(), times=times)))
        except StiffmbsError as error:
            return _without(solution, f"not estimated: a run {how} failed: {error}; use --verify")
        shared = _shared(trajectory, other.trajectory)
        if last or _takes_other_steps(trajectory, other.trajectory, part, shared):
            break
        own = _lengths(trajectory)
        longest = float(max(shared.max(), own.mean()) if len(shared) else own.max(initial=0.0))
    if len(other.time) != len(times):
        return _without(solution, f"not estimated: a run {how} ended early; use --verify")
    close = ESTIMATE.close if grid.times is None else 0.0  # own steps may lie just before and after an event
    found = bars_by_difference(
        times, at, solution.channels, other.channels, part, breakpoints + grid.aside, ESTIMATE.numbers_at_once, close
    )
    return with_bars(replace(solution, errors=found), job.settings, job.dynamics, trajectory)


def _second_run(
    settings: RunSettings, trajectory: Trajectory, repeats: int, longest: float
) -> tuple[RunSettings, float, str, bool]:
    """Return the settings of a second run, its errors in those of the first one, how it is run, and True if it is the last.

    `repeats`: number of the run, from 1. `longest`: step of the first run to reduce, s, or 0.
    """
    if order := traits_of(settings).order:
        taken = float(np.ptp(trajectory.t)) / _steps(trajectory)  # reduced to divide output intervals
        return changed(settings, {"step": 0.5 * taken}), 0.5**order, "with half the step", True
    part = _part_of_second(settings.rtol)
    found = _with_errors(settings, part**repeats, longest)
    last = repeats == MOST_REPEATS or part > 1.0 or part * found.rtol < ESTIMATE.smallest_rtol
    return found, part, f"at rtol {found.rtol:.0e}", last


def _takes_other_steps(trajectory: Trajectory, other: Trajectory, part: float, shared: np.ndarray) -> bool:
    """Return True if the errors of another run are other ones than those of a run.

    `shared`: lengths of the steps of both, s. Those of implicit runs are the first ones after samples.
    """
    from ..solve.explicit.dop853 import DOP853

    more = _steps(other) > _steps(trajectory) * part ** (-0.5 / DOP853.order)
    few = bool(trajectory.statistics.get("jacobians") or shared.sum() <= ESTIMATE.shared * _lengths(trajectory).sum())
    return more and few


def _lengths(trajectory: Trajectory) -> np.ndarray:
    """Return the lengths of the steps of a run, s."""
    return np.diff(trajectory.step_times, prepend=trajectory.t[0])


def _shared(trajectory: Trajectory, other: Trajectory) -> np.ndarray:
    """Return the lengths of the steps of a run that another one takes too, s, up to rounding."""
    ends, others = (np.append(each.t[0], each.step_times) for each in (trajectory, other))
    rounding = SAME_TIME * np.ptp(ends)
    at = np.minimum(np.searchsorted(others, ends - rounding), len(others) - 1)
    same = np.abs(others[at] - ends) <= rounding
    return _lengths(trajectory)[same[:-1] & same[1:] & (np.diff(at) == 1)]


def _part_of_second(rtol: float) -> float:
    """Return the ratio of the tolerance of the second run to that of the first, below 1 if there is a smaller tolerance."""
    return ESTIMATE.second if ESTIMATE.second * rtol >= ESTIMATE.smallest_rtol else 1.0 / ESTIMATE.second


def _with_steps(solution: Solution, trajectory: Trajectory, breakpoints: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the output times with others between them, where peaks may be, and the places of the output times.

    The others are those of steps, and just after breakpoints.
    """
    outputs = np.unique(solution.time)
    least = ESTIMATE.difference * np.ptp(outputs)
    steps = np.union1d(trajectory.step_times, breakpoints + 2.0 * least)
    steps = steps[:: 1 + len(steps) * len(solution.channels) // ESTIMATE.numbers_at_once]
    steps = steps[np.diff(steps, prepend=-np.inf) > least]
    after = np.searchsorted(outputs, steps)
    steps, after = (each[(after > 0) & (after < len(outputs))] for each in (steps, after))
    steps = steps[np.minimum(outputs[after] - steps, steps - outputs[after - 1]) > least]
    times = np.sort(np.concatenate([outputs, steps]))
    return times, np.searchsorted(times, solution.time)


def _with_errors(settings: RunSettings, part: float, longest: float) -> RunSettings:
    """Return the settings of a run whose errors are a part of those of another one; `longest`: step of that to reduce, s, or 0."""
    from ..solve.explicit.dop853 import DOP853

    changes: dict[str, float] = {"rtol": min(part * settings.rtol, LARGEST_RTOL)}
    if settings.atol is not None:
        changes["atol"] = part * settings.atol
    if longest := settings.max_step or longest:
        changes["max_step"] = longest * part ** (1.0 / DOP853.order)
    return changed(settings, changes)


def to_accuracy(job: Job, watch: ProgressCallback | None) -> tuple[Job, Solution]:
    """Solve a job with a tolerance, chosen by the estimate of the errors, at which it has the accuracy asked for.

    Returns the job with that tolerance too. The run is repeated twice at most, without an estimate never; the rtol of its settings
    has no effect.
    """
    from ..error_estimate.accuracy import Accuracy
    from .run import solved

    accuracy, traits = Accuracy(job.settings.accuracy), traits_of(job.settings)
    rtol = accuracy.first_rtol(job.dynamics.system.size)
    for repeats in range(0 if traits.exact or traits.fixed_steps else MOST_REPEATS, -1, -1):
        job = job.varied({"rtol": rtol}) if "rtol" in traits.reads else job
        solution = solved(job, watch)
        judged = accuracy.judged(solution, rtol)
        if judged.reached or judged.next_rtol >= rtol or not repeats or not solution.success:
            break
        rtol = judged.next_rtol
    return job, _with_accuracy(solution, judged, job.settings)


def _with_accuracy(solution: Solution, judged: Judged, settings: RunSettings) -> Solution:
    """Return a solution with a sentence or a note on the accuracy asked for."""
    estimate, traits = solution.estimate, traits_of(settings)
    if traits.exact:
        note = EXACT(solver=traits.name)
    elif estimate is None:  # interrupted, or without results over time, as its message says
        return solution
    elif estimate.status == "none":
        note = NOT_JUDGED(why=estimate.sentence)
    else:
        fixed = traits.fixed_steps
        how = f"with steps of at most {settings.step:.2g} s" if fixed else f"at rtol {settings.rtol:.2g}"
        if judged.reached:
            return replace(solution, estimate=estimate.with_accuracy(f"{judged.sentence} {how}"))
        note = NOT_REACHED(found=judged.sentence, how=how, setting="step" if fixed else "rtol")
    return replace(solution, notes=(*solution.notes, note))


def _without(solution: Solution, sentence: str) -> Solution:
    return replace(solution, estimate=ErrorEstimate("none", sentence))
