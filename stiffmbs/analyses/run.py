"""Runs: a model is prepared, solved, examined and converted to channels."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Unpack

import numpy as np

from ..compile.callbacks import fault_of, notes_on_functions
from ..compile.table_notes import table_notes
from ..describe.element import Force
from ..describe.requests.order import units
from ..describe.scene import Scene, notes_of
from ..describe.settings import RunSettings, Settings, takes_settings
from ..errors import AssemblyError
from ..redundancy.messages.of_run import StructureNotes, structure_notes
from ..results.beyond_ranges import range_notes
from ..results.channels import named, series_of
from ..results.energy_balance import may_be_broken
from ..results.of_run import RunResults, results_of_run
from ..results.solution import Solution
from ..run_checks.glance import glance_at
from ..run_checks.motion import motion_notes
from ..run_checks.overlooked import OVERLOOKED_PART
from ..solve.algebraic_states import failure
from ..solve.dynamics import OutputRows
from ..solve.error_control.accumulated_errors import ACCUMULATED
from ..solve.missing_rows import reported
from ..solve.settings import changed, settings_notes
from ..solve.suspect import suspect
from ..solve.trajectory import IN_DOUBT, Outcome, ProgressCallback, Trajectory
from .given_inputs import Given, with_inputs
from .job import Job, Runnable, data_of, prepare
from .python_faults import up_to_a_fault
from .start_from import StartFrom
from .taken_again import Computed, on_exact_constraints, seen_through

OF_ANY_ERROR = ACCUMULATED.tolerances * ACCUMULATED.usual_rtol
"""Estimated position error, relative to the mechanism's size, below which none is reported, with any tolerances."""


@takes_settings
def run(
    model: Runnable,
    settings: RunSettings | None = None,
    watch: ProgressCallback | None = None,
    start_from: StartFrom | None = None,
    inputs: Mapping[str, Given] | None = None,
    **changes: Unpack[Settings],
) -> Solution:
    """Simulate a model over time.

    Parameters
    ----------
    model : Model, Scene, str or Path
        A model, a scene, or the file of a scene or an Adams/Solver dataset.
    settings : RunSettings, optional
        Settings of the run; by default those of the scene.
    watch : callable, optional
        Called with the time reached, s.
    start_from : Solution, str, Path or SavedState, optional
        State to start from instead of the described one, at its time unless `start` is given: the last of a solution or
        of a results file, or ``solution.state(at=2.0)``.
    inputs : mapping of str to float, callable, (times, values) or Table, optional
        Values of the model's inputs: constants, functions of t, s, or times and values with linear interpolation.  A
        smooth function becomes a spline; another is sampled at the output instants.
    **changes
        Fields of the settings to change: ``duration=2.0, rtol=1e-8``.

    Returns
    -------
    Solution
        If the run stops early, it holds the results up to there, and `message` states the reason.

    Raises
    ------
    InputError
        If the model or a setting is invalid, or the state belongs to other bodies.
    AssemblyError
        If no consistent start is found.
    """
    data = data_of(model)
    if isinstance(data, Scene) and data.stages:
        from .staged.stages import run_stages

        return run_stages(data, settings, watch, start_from, inputs, **changes)
    if inputs:
        chosen = changed(settings or (data.run if isinstance(data, Scene) else RunSettings()), {**changes})
        data = with_inputs(data, inputs, chosen)
    return solved(prepare(data, settings, start_from, **changes), watch)


@dataclass(frozen=True)
class Finished:
    """Job that was integrated and examined.

    Attributes
    ----------
    job : Job
    trajectory : Trajectory
    rows : OutputRows
    outcome : Outcome
    message : str
    notes : tuple of str
    structure : StructureNotes
    examined : RunResults or None
        Channels and energy balance; None if the scan of the output rows found nothing to report.
    """

    job: Job
    trajectory: Trajectory
    rows: OutputRows
    outcome: Outcome
    message: str
    notes: tuple[str, ...]
    structure: StructureNotes
    examined: RunResults | None

    @property
    def time(self) -> np.ndarray:
        """Output instants, s."""
        return self.rows.t

    def __getitem__(self, channel: str) -> np.ndarray:
        if self.examined:
            return named(self.examined.channels, channel)
        return series_of(self.job.data, self.job.dynamics.system, self.rows, channel)

    @cached_property
    def results(self) -> RunResults:
        """Channels and energy balance."""
        job = self.job
        return self.examined or results_of_run(
            job.data, job.dynamics.system, self.rows, job.settings, self.trajectory.step_times
        )


@np.errstate(all="ignore")  # numbers of a diverged run overflow
def finished(job: Job, watch: ProgressCallback | None = None) -> Finished:
    """Integrate and examine a prepared job; errors as for `run`."""
    computed, overlooked = seen_through(job, lambda job: on_exact_constraints(job, lambda job: _computed(job, watch)))
    trajectory, rows, seen = computed.trajectory, computed.rows, computed.seen
    if not len(rows.t):
        raise AssemblyError(
            f"no accelerations could be computed at the start: {failure(job.dynamics, rows.status, job.grid.start)}"
        )
    outcome, message = _ending(job, rows, trajectory)
    sound = seen and not (may_be_broken(seen.missing, seen.exchanged) or job.data.requests)
    examined = (
        None if sound else results_of_run(job.data, job.dynamics.system, rows, job.settings, trajectory.step_times)
    )
    of_motion = motion_notes(
        job.dynamics, rows, job.on_constraints, seen, job.settings.rtol, lambda times: _reported_at(job, times)
    )
    structure = structure_notes(job.redundancy, job.subsystems, job.dynamics)
    broken, undefined = (examined.broken_balance, examined.undefined) if examined else ((), ())
    wrong = (*(of_motion.senseless or broken), *of_motion.uncertain, *undefined)
    bounded = {name: x for name, x in job.data.forces.items() if type(x).valid_ranges is not Force.valid_ranges}
    ranges = {name: found for name, force in bounded.items() if (found := force.valid_ranges())}
    beyond = (
        range_notes(ranges, lambda channel: series_of(job.data, job.dynamics.system, rows, channel)) if ranges else ()
    )
    notes = (*_notes(job, trajectory, structure), *overlooked, *computed.left_out, *beyond, *wrong)
    doubts = (*computed.doubts, *(of_motion.senseless or broken))
    return Finished(job, trajectory, rows, outcome, _headline(outcome, message, doubts), notes, structure, examined)


def _headline(outcome: Outcome, message: str, doubts: Sequence[str]) -> str:
    """Return the final message of a run, with the first of the notes that question its results."""
    if outcome is not Outcome.DONE or not doubts:
        return message
    return message.replace(Outcome.DONE.value, f"{IN_DOUBT}: {doubts[0].partition(';')[0]}")


def solved(job: Job, watch: ProgressCallback | None = None) -> Solution:
    """Integrate a prepared job and return its channels; errors as for `run`."""
    found = finished(job, watch)
    trajectory, rows, results, structure = found.trajectory, found.rows, found.results, found.structure
    statistics = {"name": trajectory.solver or job.settings.solver, **trajectory.statistics}
    if job.on_constraints:
        statistics["drift"] = float(np.fmax.reduce(rows.drift))
    return Solution(
        name=job.data.name, time=rows.t, channels=results.channels, outcome=found.outcome, message=found.message,
        notes=found.notes, solver=statistics, history=trajectory.history, balance=results.balance, not_unique=structure.not_unique,
        requested=units(job.data.outputs()) if job.data.requests else {}, figure=job.data.figure if isinstance(job.data, Scene) else None,
        presolve=structure.of_presolve, turns=results.turns,
    )  # fmt: skip


def _computed(job: Job, watch: ProgressCallback | None) -> Computed:
    """Integrate a job and compute its output rows."""
    trajectory = _sound_part(job, up_to_a_fault(job.dynamics.system, job.integrate(watch)))
    rows, left_out = reported(job.dynamics, trajectory, job.on_constraints)
    seen = glance_at(job.dynamics.system, rows, trajectory.step_times, OVERLOOKED_PART)
    return Computed(trajectory, rows, left_out, seen)


def _reported_at(job: Job, times: np.ndarray) -> OutputRows:
    """Repeat the run up to the last of the given times, with rows at its start and at these times."""
    grid = replace(job.grid, end=float(times[-1]), times=np.union1d(job.grid.start, times))
    again = replace(job, grid=grid)
    trajectory = up_to_a_fault(job.dynamics.system, again.integrate())
    rows = reported(job.dynamics, trajectory, job.on_constraints)[0]
    if job.dynamics.system.has_functions:
        fault_of(job.dynamics.system)  # clears the fault that left out rows, before the next run
    return rows


def _sound_part(job: Job, trajectory: Trajectory) -> Trajectory:
    """Return a trajectory up to where the mechanism locks by omitted equations or by prescribed velocities."""
    system = job.dynamics.system
    if job.redundancy.active.all() and system.holonomic.all():
        return trajectory
    from ..run_checks.locked import locked

    found = locked(job.dynamics, job.redundancy, trajectory)
    if found is None:
        return trajectory
    outputs, sentence = found
    return replace(
        trajectory, t=trajectory.t[:outputs], q=trajectory.q[:outputs], u=trajectory.u[:outputs], outcome=Outcome.STOPPED,
        message=sentence,
    )  # fmt: skip


def _ending(job: Job, rows: OutputRows, trajectory: Trajectory) -> tuple[Outcome, str]:
    """Return the outcome and message of a run; a row without accelerations and reactions counts as a stop."""
    if len(rows.t) == len(trajectory.t):
        return trajectory.outcome, trajectory.message
    t, q, u = (array[len(rows.t)] for array in (trajectory.t, trajectory.q, trajectory.u))
    sentence = f"no accelerations and reactions were found at t = {t:.9g} s: {failure(job.dynamics, rows.status, t)}"
    fault = fault_of(job.dynamics.system)
    if fault:
        return Outcome.STOPPED, f"{sentence}; {fault.clause}"
    return Outcome.STOPPED, sentence + suspect(job.dynamics, t, q, u)


def _notes(job: Job, trajectory: Trajectory, structure: StructureNotes) -> Iterator[str]:
    system = job.dynamics.system
    yield from notes_of(job.data)
    if system.has_laws:
        yield from table_notes(job.data)
    yield from structure.of_joints
    for joint in job.data.joints.values():
        if joint.kind == "drive":
            yield from job.dynamics.kept("opposed actuators", None, lambda: _opposed(job))
            break
    yield from job.start.notes
    if system.has_functions:
        yield from notes_on_functions(system)
    if job.start.moved:
        yield job.start.sentence()
    if trajectory.note:
        yield trajectory.note
    if trajectory.displaced is not None and (trajectory.displaced > OF_ANY_ERROR * min(1.0, system.size)).any():
        from ..run_checks.accumulated_errors import accumulated_errors_sentence  # few runs have such errors

        yield from accumulated_errors_sentence(system, job.settings, trajectory)
    yield from settings_notes(job.settings, system)


def _opposed(job: Job) -> tuple[str, ...]:
    from ..redundancy.opposed_actuators import opposed_sentences  # models without drives do not load it

    return opposed_sentences(job.dynamics.system, job.data, job.start.q, job.grid)
