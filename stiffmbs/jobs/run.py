"""The main job: a model is compiled, assembled, solved and turned into channels."""

from __future__ import annotations

import logging
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, TypeAlias, Unpack

import numpy as np

from ..compile.callbacks import fault_of, notes_on_functions
from ..compile.compile_model import compile_model
from ..describe.building.model_builder import ModelBuilder
from ..describe.model_data import ModelData
from ..describe.requests.order import units
from ..describe.scene import Scene, notes_of
from ..describe.settings import RunSettings, Settings, SteadyMotion, takes_settings
from ..diagnostics.far_away import refuse_far_away
from ..diagnostics.glance import glance_at
from ..diagnostics.motion import motion_notes
from ..diagnostics.overlooked import OVERLOOKED_PART
from ..errors import AssemblyError, InputError
from ..results.channels import named, series_of
from ..results.energy_balance import may_be_broken
from ..results.of_run import RunResults, results_of_run
from ..results.saved_state import SavedState
from ..results.solution import Solution
from ..solve import SOLVERS
from ..solve.algebraic_states import failure
from ..solve.dynamics import Dynamics, OutputRows
from ..solve.events.input_ends import solve_up_to_the_inputs_end
from ..solve.initial import InitialValues, consistent_values, initial_values
from ..solve.missing_rows import reported
from ..solve.nearest_turns import take_nearest_turns
from ..solve.settings import changed, near_constraints, output_grid, settings_notes
from ..solve.subsystems import Subsystem, presolved, solve_subsystems
from ..solve.suspect import suspect
from ..solve.trajectory import Grid, Outcome, ProgressCallback, Trajectory, unwatched
from ..structure.messages.of_run import StructureNotes, structure_notes
from ..structure.redundancy import Redundancy, examine
from .given_inputs import Given, with_inputs
from .load_scene import load_scene
from .python_faults import told_faults, up_to_a_fault
from .start_from import StartFrom, started_from, starting_at, state_to_start_from
from .taken_again import Computed, on_exact_constraints, seen_through

LOGGER = logging.getLogger(__name__)


@dataclass(frozen=True)
class Examined:
    """A model compiled and examined for redundant equations."""

    data: ModelData
    settings: RunSettings
    grid: Grid
    redundancy: Redundancy
    start_from: SavedState | None = None

    def dynamics(self) -> Dynamics:
        """Of the system without its redundant equations."""
        system = self.redundancy.system
        active = self.redundancy.active
        return Dynamics(system if active.all() else replace(system, active=active))


@dataclass(frozen=True)
class Job:
    """A model compiled and assembled, ready to be integrated any number of times."""

    data: ModelData
    settings: RunSettings
    grid: Grid
    redundancy: Redundancy
    dynamics: Dynamics
    start: InitialValues
    subsystems: tuple[Subsystem, ...] = ()
    start_from: SavedState | None = None

    @cached_property
    def on_constraints(self) -> bool:
        """Whether states are on the constraints but for the tolerance."""
        return near_constraints(self.settings)

    def evaluations(self) -> int:
        """How often the equations of the system and of its parts were evaluated so far."""
        parts = (self.dynamics, *(subsystem.dynamics for subsystem in self.subsystems))
        return sum(dynamics.state.evaluations for dynamics in parts)

    def integrate(self, watch: ProgressCallback | None = None) -> Trajectory:
        """Integrate from the start, what the presolve made of the model; see `stiffmbs.solve.trajectory`."""
        solve, watch = SOLVERS[self.settings.solver].solve, watch or unwatched
        LOGGER.info("solving %s by %s", self.data.name, self.settings.solver)

        def over(grid: Grid) -> Trajectory:
            if self.subsystems:
                return solve_subsystems(solve, self.subsystems, self.start, grid, self.settings, watch)
            return solve(self.dynamics, self.start, grid, self.settings, watch)

        if not self.dynamics.system.has_inputs:
            return over(self.grid)
        return solve_up_to_the_inputs_end(self.dynamics, self.grid, over)


Runnable: TypeAlias = ModelBuilder[Any, Any, Any] | ModelData | str | Path
"""What can be solved: a model, a scene, or a scene's file."""


def data_of(model: Runnable) -> ModelData:
    """What a model or a file holds.

    Raises
    ------
    InputError
        When it is neither, or the file cannot be read.
    """
    match model:
        case ModelBuilder():
            data: ModelData = model.data()
            return data
        case ModelData():
            return model
        case str() | Path():
            return load_scene(model)
    raise InputError(f"found {model!r}, expected a Model, a Scene, or the name of a scene's file")


def prepare(
    model: Runnable, settings: RunSettings | None = None, start_from: StartFrom | None = None, **changes: Any
) -> Job:
    """Compile and assemble a model; parameters and errors as for `run`."""
    found = examined(model, settings, start_from, **changes)
    if found.redundancy.rank_results:
        from ..structure.messages.redundancy import refuse_inconsistencies

        refuse_inconsistencies(found.redundancy)
    dynamics = found.dynamics()
    LOGGER.info("assembling %s", found.data.name)
    with told_faults(dynamics.system):
        start = _start(found.data, dynamics, found.grid.start, found.start_from)
        subsystems = presolved(found.data, dynamics, start, found.grid, found.settings)
    return Job(found.data, found.settings, found.grid, found.redundancy, dynamics, start, subsystems, found.start_from)


def start_of_job(job: Job) -> InitialValues:
    """The start of a job whose numbers have changed; errors as for `run`."""
    with told_faults(job.dynamics.system):
        job.dynamics.return_to_start()
        return _start(job.data, job.dynamics, job.grid.start, job.start_from)


def _start(data: ModelData, dynamics: Dynamics, t: float, state: SavedState | None) -> InitialValues:
    """The saved state that is given, else the equilibrium or the described state, whichever the scene asks for."""
    if state is not None:
        take_nearest_turns(dynamics, t, state.is_new)
        start = consistent_values(dynamics, t)
        return replace(
            start, notes=(*start.notes, f"the run starts from the state at t = {state.t:g} s of {state.source}")
        )
    if isinstance(data, Scene) and data.at_start:
        from .held_at_start import hold_at_start

        hold_at_start(dynamics, data, t)
        start = initial_values(dynamics, t).as_asked_by([*data.at_start])
    else:
        start = initial_values(dynamics, t)
    asked = data.start if isinstance(data, Scene) else "described"
    if isinstance(asked, SteadyMotion):
        from .steady import start_in_motion

        return start_in_motion(data, dynamics, start, t, asked)
    if asked == "equilibrium":
        from .settled import settled

        return settled(dynamics, start, t).start
    if asked == "settled":
        from .settled import moving_in_equilibrium

        return moving_in_equilibrium(dynamics, start, t)
    return start


def examined(
    model: Runnable, settings: RunSettings | None = None, start_from: StartFrom | None = None, **changes: Any
) -> Examined:
    """Compile a model and look for redundant equations; parameters and errors as for `run`."""
    data = data_of(model)
    if isinstance(data, Scene) and data.stages:
        raise InputError("found a scene with stages, which only a run follows, expected a scene of one run")
    state = state_to_start_from(start_from)
    given = settings or (data.run if isinstance(data, Scene) else RunSettings())
    chosen = changed(given, starting_at(state, settings, changes))
    grid = output_grid(chosen)
    for name in chosen.drop_first:
        if name not in data.joints:
            raise InputError(f"drop_first: found no joint '{name}', expected one of {', '.join(data.joints) or 'none'}")
    order = [*(name for name in data.joints if name not in chosen.drop_first), *chosen.drop_first]
    system = compile_model(data)
    refuse_far_away(system)
    system = started_from(system, data, state)
    with told_faults(system):
        return Examined(data, chosen, grid, examine(system, grid.start, chosen.duration, order), state)


@takes_settings
def run(
    model: Runnable,
    settings: RunSettings | None = None,
    watch: ProgressCallback | None = None,
    start_from: StartFrom | None = None,
    inputs: Mapping[str, Given] | None = None,
    **changes: Unpack[Settings],
) -> Solution:
    """Solve a model.

    Parameters
    ----------
    model : Model, Scene, str or Path
        What to solve: a model, a scene, or the file that a scene or an Adams/Solver dataset is read from.
    settings : RunSettings, optional
        How; the scene's own by default.
    watch : callable, optional
        Called with the time reached, s.
    start_from : Solution, str, Path or SavedState, optional
        A state to start from in place of the described one, at its time unless `start` is given: the last of a solution
        or of a file of results, or ``solution.state(at=2.0)``.
    inputs : mapping of str to float, callable or (times, values), optional
        Values of the model's inputs: constants, functions of t, s, which are read at the output instants, or times and values;
        with straight lines between.
    **changes
        Fields of the settings to change: ``duration=2.0, rtol=1e-8``.

    Returns
    -------
    Solution
        Also for a run that stopped early: it then holds what was computed, and `message` says why it ended.

    Raises
    ------
    InputError
        When the model or a setting is wrong, or the state that of other bodies.
    AssemblyError
        When no consistent start is found.
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
    """A job that was integrated and examined.

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
        Channels and energy balance; None where a glance has shown that there is nothing to say of them.
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


@np.errstate(all="ignore")  # a diverged run has numbers that overflow
def finished(job: Job, watch: ProgressCallback | None = None) -> Finished:
    """Integrate what was prepared, and examine it; errors as for `run`."""
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
    notes = (*_notes(job, trajectory, structure), *overlooked, *computed.left_out, *wrong)
    return Finished(job, trajectory, rows, outcome, message, notes, structure, examined)


def solved(job: Job, watch: ProgressCallback | None = None) -> Solution:
    """Integrate what was prepared, and turn it into channels; errors as for `run`."""
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
    """Integrate a job and report it."""
    trajectory = _sound_part(job, up_to_a_fault(job.dynamics.system, job.integrate(watch)))
    rows, left_out = reported(job.dynamics, trajectory, job.on_constraints)
    seen = glance_at(job.dynamics.system, rows, trajectory.step_times, OVERLOOKED_PART)
    return Computed(trajectory, rows, left_out, seen)


def _reported_at(job: Job, times: np.ndarray) -> OutputRows:
    """The run once more, reported at its start, at other instants, and at its end."""
    again = replace(job, grid=replace(job.grid, times=np.union1d([job.grid.start, job.grid.end], times)))
    return reported(job.dynamics, again.integrate(), job.on_constraints)[0]


def _sound_part(job: Job, trajectory: Trajectory) -> Trajectory:
    """A trajectory up to where a mechanism locks, for equations that were left out, or for prescribed velocities."""
    system = job.dynamics.system
    if job.redundancy.active.all() and system.holonomic.all():
        return trajectory
    from ..diagnostics.locked import locked

    found = locked(job.dynamics, job.redundancy, trajectory)
    if found is None:
        return trajectory
    outputs, sentence = found
    return replace(
        trajectory, t=trajectory.t[:outputs], q=trajectory.q[:outputs], u=trajectory.u[:outputs], outcome=Outcome.STOPPED,
        message=sentence,
    )  # fmt: skip


def _ending(job: Job, rows: OutputRows, trajectory: Trajectory) -> tuple[Outcome, str]:
    """How the run ended, and the sentence for it: also stopped where states have no accelerations and reactions."""
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
    yield from structure.of_joints
    yield from job.start.notes
    if system.has_functions:
        yield from notes_on_functions(system)
    if job.start.moved:
        yield job.start.sentence()
    if trajectory.note:
        yield trajectory.note
    yield from settings_notes(job.settings, system)
