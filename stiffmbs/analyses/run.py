"""Runs: a model is prepared, solved, examined and converted to channels."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Unpack

import numpy as np

from ..compile.callbacks import fault_of
from ..compile.machine import drafts
from ..compile.machine.routines import fully_compiled, on_drafts
from ..dynamics.algebraic_states import failure
from ..dynamics.dynamics import OutputRows
from ..elements.requests.order import units
from ..errors import AssemblyError
from ..model.model_data import ModelData
from ..model.scene import Scene
from ..model.settings import RunSettings, Settings, takes_settings
from ..notes import Note, Severity
from ..reading.units.display import SI_UNITS
from ..redundancy.messages.presolve_report import StructureNotes, structure_notes
from ..results.channels import channels_of, named, series_of, turns_of
from ..results.energy_balance import Balance, energy_balance
from ..results.energy_balance_notes import broken_balance, is_broken
from ..results.provenance import provenance_of
from ..results.solution import Solution
from ..run_checks.motion import several_solutions_note
from ..solve.events.departures import Departure, refused_departure
from ..solve.missing_rows import reported
from ..solve.reasons import OF_STATUS, Reason
from ..solve.trajectory import IN_DOUBT, Outcome, ProgressCallback, Trajectory, unwatched
from ..tuning import in_use
from .checks import Integrated, notes_on
from .errors import assessed, recording, to_accuracy
from .job import Job, Runnable, data_of, prepare, settings_of, up_to_a_fault, with_elements
from .long_runs import Predicted, TakesLongError
from .rerun import Computed, on_exact_constraints, rerun_after_missed_events
from .start_from import StartFrom

if TYPE_CHECKING:
    from .conditions import Monitor
    from .given_inputs import Given


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
        Values of the model's inputs: constants, functions of t, s, or times and values with linear interpolation, which
        is extrapolated with a note; a `Table` states what is beyond its points.  A smooth function becomes a spline; another is sampled at the output instants.
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
        from .staged import run_stages

        found = run_stages(data, settings, watch, start_from, inputs, **changes)
        return replace(found, provenance=provenance_of(data, settings_of(data, settings, changes)))
    return run_monitored(data, None, settings, watch, start_from, inputs, **changes)


def run_monitored(
    data: ModelData,
    monitor: Callable[[Job], Monitor] | None,
    settings: RunSettings | None = None,
    watch: ProgressCallback | None = None,
    start_from: StartFrom | None = None,
    inputs: Mapping[str, Given] | None = None,
    **changes: Unpack[Settings],
) -> Solution:
    """Simulate a model without stages, up to where a monitor ends the run; other parameters and errors as for `run`."""
    data = with_elements(data, lambda scene: run(scene, settings, None, start_from, inputs, **changes))
    if inputs:
        from .given_inputs import with_inputs

        data = with_inputs(data, inputs, settings_of(data, settings, changes))
    try:
        with on_drafts():
            return _prepared_and_solved(data, settings, watch, start_from, changes, monitor)
    except TakesLongError:
        with fully_compiled():
            return _prepared_and_solved(data, settings, watch, start_from, changes, monitor)


def _prepared_and_solved(
    data: ModelData,
    settings: RunSettings | None,
    watch: ProgressCallback | None,
    start_from: StartFrom | None,
    changes: Settings,
    monitor: Callable[[Job], Monitor] | None,
) -> Solution:
    """Prepare a job and solve it; raise TakesLongError if it takes long on drafts of compiled code."""
    job = replace(prepare(data, settings, start_from, **changes), monitor=monitor)
    if drafts.tier() == drafts.Tier.DRAFT and drafts.quick_ones_are_used():
        watch = Predicted(job.grid.end, watch or unwatched)
    if job.settings.errors is not False or job.settings.accuracy:
        job = recording(job)
    return to_accuracy(job, watch)[1] if job.settings.accuracy else solved(job, watch)


@dataclass(frozen=True)
class Finished:
    """Job that was integrated and examined; `examined` has the channels if the checks of the run needed them."""

    job: Job
    trajectory: Trajectory
    rows: OutputRows
    outcome: Outcome
    message: str
    notes: tuple[Note, ...]
    structure: StructureNotes
    balance: Balance
    examined: dict[str, np.ndarray] | None

    @property
    def time(self) -> np.ndarray:
        """Output instants, s."""
        return self.job.shown(self.rows.t)

    def __getitem__(self, channel: str) -> np.ndarray:
        if self.examined:
            return named(self.examined, channel)
        return series_of(self.job.data, self.job.dynamics.system, self.rows, channel)

    @property
    def channels(self) -> dict[str, np.ndarray]:
        """All channels by name, computed unless the checks of the run needed them before."""
        return self.examined or channels_of(self.job.data, self.job.dynamics.system, self.rows)


def finished(job: Job, watch: ProgressCallback | None = None) -> Finished:
    """Integrate and examine a prepared job; errors as for `run`."""
    with in_use(job.settings.tuning), np.errstate(all="ignore"):  # numbers of a diverged run overflow
        return _finished(job, watch)


def _finished(job: Job, watch: ProgressCallback | None) -> Finished:
    compute = partial(on_exact_constraints, compute=partial(_computed, watch=watch))
    computed = rerun_after_missed_events(job, compute)
    trajectory, rows = computed.trajectory, computed.rows
    if not len(rows.t):
        raise AssemblyError(
            f"no accelerations could be computed at the start: {failure(job.dynamics, rows.status, job.grid.start)}"
        )
    outcome, message = _ending(job, rows, trajectory)
    system = job.dynamics.system
    balance, broken = _balance(computed.job, trajectory, rows)
    channels = channels_of(job.data, system, rows) if job.data.requests or not rows.finite else None
    several = tuple(several_solutions_note(job.dynamics, rows)) if system.forces_by_reactions else ()
    structure = structure_notes(job.redundancy, job.subsystems, job.dynamics)
    again = partial(_reported_at, job)
    notes = notes_on(
        Integrated(job, system, trajectory, rows, structure, computed.notes, channels, several or broken, again)
    )
    return Finished(
        job, trajectory, rows, outcome, _headline(outcome, message, notes), notes, structure, balance, channels
    )


def _balance(job: Job, trajectory: Trajectory, rows: OutputRows) -> tuple[Balance, tuple[Note, ...]]:
    """Return the energy balance of a run, and a note if it is certainly broken."""
    system, settings = job.dynamics.system, job.settings
    balance = energy_balance(system, rows)
    if not is_broken(system, balance, rows, settings):
        return balance, ()
    from .balance_within_steps import balance_within_steps  # few runs need it

    within = balance_within_steps(job, trajectory, rows)
    balance, rows = within or (balance, rows)
    if balance.resolved and is_broken(system, balance, rows, settings):
        return balance, (broken_balance(system, balance, rows, settings),)
    return balance, ()


def _headline(outcome: Outcome, message: str, notes: Sequence[Note]) -> str:
    """Return the final message of a run, with the first of the notes that question its results."""
    doubt = next((note for note in notes if note.severity is Severity.DOUBT), None)
    if outcome is not Outcome.DONE or doubt is None:
        return message
    return message.replace(Outcome.DONE.value, f"{IN_DOUBT}: {doubt.partition(';')[0]}", 1)


def solved(job: Job, watch: ProgressCallback | None = None) -> Solution:
    """Integrate a prepared job and return its channels; errors as for `run`."""
    found = finished(job, watch)
    trajectory, rows, structure = found.trajectory, found.rows, found.structure
    statistics = {"name": trajectory.solver or job.settings.solver, **trajectory.statistics}
    if job.on_constraints:
        statistics["drift"] = float(np.fmax.reduce(rows.drift))
    requested = units(job.data.outputs()) if job.data.requests else {}
    solution = Solution(
        name=job.data.name,
        time=found.time,
        channels=found.channels,
        outcome=found.outcome,
        message=found.message,
        notes=found.notes,
        solver=statistics,
        history=trajectory.history,
        balance=found.balance,
        not_unique=structure.not_unique,
        requested=requested,
        figure=job.data.figure if isinstance(job.data, Scene) else None,
        display=job.data.display if isinstance(job.data, Scene) else SI_UNITS,
        presolve=structure.of_presolve,
        provenance=provenance_of(job.data, job.settings, state=job.start_from),
        turns=turns_of(job.dynamics.system, rows.q),
    )
    return assessed(job, trajectory, solution) if job.grid.recorded.most else solution


def _computed(job: Job, watch: ProgressCallback | None) -> Computed:
    """Integrate a job and compute its output rows."""
    trajectory = _sound_part(job, up_to_a_fault(job.dynamics.system, job.integrate(watch)))
    system = job.dynamics.system
    if system.has_tables and (left := _refused_table(job, trajectory)):
        trajectory = _up_to(left, job, trajectory)
    rows, left_out = reported(job.dynamics, trajectory, job.on_constraints, job.settings.rtol)
    if job.data.requests and (left := _refused_request(job, rows)):
        trajectory = _up_to(left, job, trajectory)
        rows, left_out = reported(job.dynamics, trajectory, job.on_constraints, job.settings.rtol)
    return Computed(trajectory, rows, job, tuple(left_out))


def _refused_table(job: Job, trajectory: Trajectory) -> Departure | None:
    """Return the first departure of a run from a table with ``beyond: error``, or None."""
    from ..run_checks.tables import left_tables

    return refused_departure(left_tables(job.dynamics.system, trajectory, job.settings))


def _refused_request(job: Job, rows: OutputRows) -> Departure | None:
    """Return the first departure of a request from a table with ``beyond: error``, or None."""
    outputs = job.data.outputs().values()
    if not any(table.beyond == "error" for output in outputs for table in output.tables.values()):
        return None
    from ..run_checks.tables import left_by_requests

    system = job.dynamics.system
    return refused_departure(left_by_requests(job.data, system, rows, channels_of(job.data, system, rows)))


def _up_to(departure: Departure, job: Job, trajectory: Trajectory) -> Trajectory:
    """Return a run up to where it leaves a table, repeated with a row there."""
    from ..run_checks.tables import stopped_at

    grid, end = job.grid, departure.first
    if end > grid.start:
        times = None if grid.times is None else np.append(grid.times[grid.times < end], end)
        trajectory = replace(job, grid=replace(grid, end=end, times=times)).integrate()
    return stopped_at(departure, trajectory)


def _reported_at(job: Job, times: np.ndarray) -> OutputRows:
    """Repeat the run up to the last of the given times, with rows at its start and at these times."""
    again = job.varied(times=np.union1d(job.grid.start, times))
    trajectory = up_to_a_fault(job.dynamics.system, again.integrate())
    rows = reported(job.dynamics, trajectory, job.on_constraints, job.settings.rtol)[0]
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
    return trajectory if found is None else trajectory.stopped_after(*found)


def _ending(job: Job, rows: OutputRows, trajectory: Trajectory) -> tuple[Outcome, str]:
    """Return the outcome and message of a run; a row without accelerations and reactions counts as a stop."""
    if len(rows.t) == len(trajectory.t):
        return trajectory.outcome, trajectory.message
    t, q, u = (array[len(rows.t)] for array in (trajectory.t, trajectory.q, trajectory.u))
    sentence = f"no accelerations and reactions were found at t = {t:.9g} s: {failure(job.dynamics, rows.status, t)}"
    fault = fault_of(job.dynamics.system)
    if fault:
        return Outcome.STOPPED, Reason.FUNCTION.of(f"{sentence}; {fault.clause}")
    from ..solve.suspect import suspect

    return Outcome.STOPPED, OF_STATUS[rows.status].of(sentence + suspect(job.dynamics, t, q, u))
