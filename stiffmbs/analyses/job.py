"""Jobs: compiled models, examined for redundant equations and assembled."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from operator import attrgetter
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias, TypeVar

import numpy as np

from ..compile.callbacks import fault_of
from ..compile.compile_model import compile_model
from ..compile.system import System
from ..dynamics.dynamics import Dynamics
from ..dynamics.initial import InitialValues, consistent_values, initial_values
from ..dynamics.native.parameters import CONSISTENCY
from ..dynamics.turns import counted_angles, take_nearest_turns
from ..elements.turns import GROUND_AXES
from ..errors import AssemblyError, InputError, StiffmbsError
from ..model.model_builder import ModelBuilder
from ..model.model_data import ModelData
from ..model.scene import Scene
from ..model.settings import RunSettings, SteadyMotion
from ..notes import NoteKind, Severity
from ..reading.did_you_mean import instead_of
from ..redundancy.redundancy import Redundancy, examine
from ..results.saved_state import SavedState
from ..results.solution import Solution
from ..run_checks.motion import refuse_far_away
from ..solve import SOLVERS
from ..solve.reasons import Reason
from ..solve.sampling import held
from ..solve.settings import changed, near_constraints, output_grid
from ..solve.subsystems import Subsystem, presolved, solve_subsystems
from ..solve.trajectory import Grid, Outcome, ProgressCallback, Trajectory, unwatched
from ..tuning import changed_values, described, in_use
from .driven_turns import in_turns_of_new_drives, note_on_turns, turns_of_drives, with_turns
from .load_scene import load_scene
from .start_from import StartFrom, in_pose_of, started_from, starting_at, state_to_start_from
from .stored_start import StoredStart

if TYPE_CHECKING:
    from .conditions import Monitor

Data = TypeVar("Data", bound=ModelData)
DEPENDENT = 1e-9
"""Singular value of equations that depend on others, relative to the largest."""


def hold_at_start(dynamics: Dynamics, scene: Scene, t: float) -> None:
    """Move the current state by the least amount to satisfy the joints that hold at the start alone, at t = `t` s.

    They constrain positions and velocities, as in a run, except for the position of a drive, which leaves the velocity
    free.  Raise an AssemblyError if no such state is found.
    """

    held = scene.held_at_start
    if held is None:
        return
    from ..elements.joints.drive import Drive

    found = examined(held, RunSettings(start=t, tuning=changed_values()))
    placed = initial_values(found.dynamics(), t)
    system, names = found.redundancy.system, {name for name in scene.at_start if isinstance(held.joints[name], Drive)}
    of_drives = np.array([name in names for name, _ in system.equations], dtype=bool)
    active = np.where(of_drives, ~system.holonomic, found.redundancy.active)
    moving = Dynamics(replace(system, active=active, q=placed.q))
    velocities = consistent_values(moving, t).u
    n_pose = dynamics.system.n_pose
    dynamics.state.q[:n_pose], dynamics.state.u[:] = placed.q[:n_pose], velocities
    dynamics.system.start_angles.update(
        (angle.channel, placed.q[angle.place]) for angle in counted_angles(system) if angle.channel
    )


@contextmanager
def reported_faults(system: System) -> Iterator[None]:
    """Replace an error that a faulty function caused by an AssemblyError with the message of that fault."""
    try:
        yield
    except (StiffmbsError, ArithmeticError, ValueError) as error:
        fault = fault_of(system)
        if fault is None:
            raise
        raise AssemblyError(f"the start cannot be computed: {fault.clause}") from error
    fault = fault_of(system) if system.has_functions else None
    if fault and not isinstance(fault.raised, Exception):
        raise fault.raised


def up_to_a_fault(system: System, trajectory: Trajectory) -> Trajectory:
    """Return a trajectory with the message of the fault that ended it, if any."""
    fault = fault_of(system) if system.has_functions else None
    if fault is None or trajectory.outcome is Outcome.DONE:
        return trajectory
    if isinstance(fault.raised, KeyboardInterrupt):
        return replace(trajectory, outcome=Outcome.INTERRUPTED, message=Outcome.INTERRUPTED.value)
    reached = trajectory.t[-1]
    message = Reason.FUNCTION.of(f"stopped at t = {reached:.9g} s: {fault.clause}")
    return replace(trajectory, outcome=Outcome.STOPPED, message=message)


LOGGER = logging.getLogger(__name__)


class Examined(NamedTuple):
    """Model compiled and examined for redundant equations."""

    data: ModelData
    settings: RunSettings
    grid: Grid
    redundancy: Redundancy
    placed: ModelData  # with the pose of a saved state, or the turns of drives
    turns: Mapping[str, int]  # added to described angles
    start_from: SavedState | None = None

    def dynamics(self) -> Dynamics:
        """Return the dynamics of the system without its redundant equations."""
        system = self.redundancy.system
        active = self.redundancy.active
        return Dynamics(system if active.all() else replace(system, active=active))


@dataclass(frozen=True)
class Job:
    """Model compiled and assembled, ready to be integrated any number of times."""

    data: ModelData
    settings: RunSettings
    grid: Grid
    redundancy: Redundancy
    dynamics: Dynamics
    start: InitialValues
    subsystems: tuple[Subsystem, ...] = ()
    turns: Mapping[str, int] = field(default_factory=dict)
    start_from: SavedState | None = None
    monitor: Callable[[Job], Monitor] | None = None  # makes the monitor of an integration

    def placed(self, data: Data) -> Data:
        """Return a model of the same bodies in the pose in which the elements of the job were set up."""
        placed = in_pose_of(self.start_from, data) if self.start_from else data
        return with_turns(placed, self.turns) if self.turns else placed

    def shown(self, t: np.ndarray) -> np.ndarray:
        """Return the times of rows as the user knows them: those just before or after a breakpoint at that breakpoint."""
        if not self.dynamics.system.has_inputs:
            return t
        return replace(self.grid, start=self.settings.start).shown(t)

    @cached_property
    def on_constraints(self) -> bool:
        """Return True if states satisfy the constraints up to the tolerance."""
        return near_constraints(self.settings)

    def evaluations(self) -> int:
        """Return the number of evaluations of the equations of the system and its subsystems so far."""
        parts = (self.dynamics, *(subsystem.dynamics for subsystem in self.subsystems))
        return sum(dynamics.state.evaluations for dynamics in parts)

    def varied(self, changes: dict[str, Any] | None = None, times: np.ndarray | None = None) -> Job:
        """Return the job with changed settings, and with other output times, s, the last of which is its end."""
        grid = self.grid if times is None else replace(self.grid, end=float(times[-1]), times=times)
        return replace(self, settings=changed(self.settings, changes) if changes else self.settings, grid=grid)

    def of_one_solver(self, trajectory: Trajectory) -> Job:
        """Return a job with the solver that `auto` chose for the whole run; for a part of the run it may choose another one."""
        solver = trajectory.solver
        chosen = self.settings.solver == "auto" and solver in SOLVERS
        return self.varied({"solver": solver}) if chosen else self

    def integrate(self, watch: ProgressCallback | None = None) -> Trajectory:
        """Integrate the presolved model from its start; see `stiffmbs.solve.trajectory`."""
        solve, watch = SOLVERS[self.settings.solver].solve, watch or unwatched
        LOGGER.info("solving %s by %s", self.data.name, self.settings.solver)

        def over(grid: Grid) -> Trajectory:
            if self.dynamics.system.has_inputs:
                grid = grid.before_breakpoints(self.dynamics.input_features(grid.start, grid.end))
            if self.subsystems:
                return solve_subsystems(solve, self.subsystems, self.start, grid, self.settings, watch)
            return solve(self.dynamics, self.start, grid, self.settings, watch)

        monitor = self.monitor(self) if self.monitor else None
        grid = replace(self.grid, monitor=monitor.look) if monitor else self.grid
        with in_use(self.settings.tuning):
            if LOGGER.isEnabledFor(logging.DEBUG):
                for line in described():
                    LOGGER.debug("%s", line)
            if not self.dynamics.system.has_inputs:
                found = over(grid)
            else:
                from ..solve.events.narrow_inputs import solve_up_to_the_inputs_end

                found = solve_up_to_the_inputs_end(self.dynamics, grid, over)
        return replace(found, outcome=Outcome.DONE, message=Outcome.DONE.value) if monitor and monitor.met else found


Runnable: TypeAlias = ModelBuilder | ModelData | str | Path
"""Solvable input: a model, a scene, or the file of a scene."""


def data_of(model: Runnable) -> ModelData:
    """Return the data of a model or a file; raise an InputError if it is neither, or the file cannot be read."""
    match model:
        case ModelBuilder():
            data: ModelData = model.data()
            return data
        case ModelData():
            return model
        case str() | Path():
            return load_scene(model)
    raise InputError(f"found {model!r}, expected a Model, a Scene, or the name of a scene's file")


def settings_of(data: ModelData, settings: RunSettings | None, changes: Mapping[str, object]) -> RunSettings:
    """Return the given settings, or those of a scene, with changes; raise an InputError if one is invalid."""
    return changed(settings or (data.run if isinstance(data, Scene) else RunSettings()), dict(changes))


def with_elements(data: ModelData, solve: Callable[[Scene], Solution]) -> ModelData:
    """Return a model whose beams have as many elements as their tolerances require; see `beam_elements.divided_by`."""
    if not isinstance(data, Scene) or not data._beams.by_tolerance:
        return data
    from .beam_elements import divided_by

    return divided_by(data, solve)


def refuse_tolerances(data: ModelData) -> None:
    """Raise an InputError if the number of elements of a beam depends on a tolerance that was not followed yet."""
    if isinstance(data, Scene) and data._beams.by_tolerance:
        raise InputError(
            f"bodies.{data._beams.by_tolerance[0]}.elements: found a tolerance, expected a number: "
            "only run, equilibrium and studies of runs accept a tolerance"
        )


def prepare(
    model: Runnable, settings: RunSettings | None = None, start_from: StartFrom | None = None, **changes: object
) -> Job:
    """Compile and assemble a model; parameters and errors as for `run`."""
    found = examined(model, settings, start_from, **changes)
    refuse_tolerances(found.data)
    if found.redundancy.rank_results:
        from ..redundancy.messages.redundancy import refuse_inconsistencies

        refuse_inconsistencies(found.redundancy)
    with in_use(found.settings.tuning):
        dynamics = found.dynamics()
    LOGGER.info("assembling %s", found.data.name)
    before = StoredStart(found.data, found.settings, found.start_from)
    grid = found.grid
    if dynamics.system.has_inputs and _begins_at_breakpoint(dynamics, grid):
        grid = replace(grid, start=grid.start + grid.aside)
        dynamics.forget_inputs()  # those from the new start, as after a change of numbers
    with reported_faults(dynamics.system), in_use(found.settings.tuning):
        start = before.get("start", lambda: _start(found.data, dynamics, grid.start, found.start_from))
        if before.name:
            dynamics.place(start.q, start.u, start.lam)
        if found.turns and found.data.dimensions == 2:
            start = replace(start, notes=(*start.notes, note_on_turns(found.turns)))
        if isinstance(found.data, Scene) and found.data.start != "described":
            start = replace(start, notes=(*start.notes, *held(dynamics.system)))
        subsystems = presolved(found.placed, dynamics, start, grid, found.settings, partial(before.get, "implicit"))
    before.keep()
    dynamics.system.known_terms.clear()
    parts = found.data, found.settings, grid, found.redundancy, dynamics, start, subsystems
    return Job(*parts, found.turns, found.start_from)


def _begins_at_breakpoint(dynamics: Dynamics, grid: Grid) -> bool:
    """Return True if an input has a breakpoint at the start of a run."""
    at_ends = dynamics.input_features(grid.start, grid.end).at_ends
    return bool(np.any(at_ends <= grid.start + 2.0 * grid.aside))


def assembled(data: ModelData, dynamics: Dynamics, t: float) -> InitialValues:
    """Make the described start consistent; flexible bodies are moved, and deformed only if no move satisfies the joints.

    The smallest move of all coordinates would deform stiff bodies, and the smallest change of velocities would excite
    their modes. All others are therefore fitted first, positions by Gauss and Newton's method. Errors as for `stiffmbs.dynamics.initial.initial_values`.
    """
    first: np.ndarray | None = None
    modal = {name for name, body in data.bodies.items() if not getattr(body, "weighs", True)}
    if modal:
        system, state = dynamics.system, dynamics.state
        first = np.flatnonzero(np.repeat([name not in modal for name in system.bodies], system.of_body.n_u))
        rows = np.flatnonzero(system.active & system.holonomic)
        start, move = state.q.copy(), np.zeros(system.n_u)
        for _ in range(CONSISTENCY.most_moves):
            state.evaluate("position", t)
            gaps = state.vector("position", "C")[rows].copy()
            state.evaluate("motion", t)
            slopes = state.matrix("motion", "J")[np.ix_(rows, first)]
            move[first] = np.linalg.lstsq(slopes, -gaps, rcond=DEPENDENT)[0]
            state.q[:] = system.of_body.moved(state.q, move)
            if not np.isfinite(state.q).all():
                state.q[:] = start
                break
            if np.abs(move).max() <= CONSISTENCY.position_tolerance * system.size:
                break
    found = initial_values(dynamics, t, first)
    node = next(
        (move.body for move in found.moved_far if GROUND_AXES in getattr(data.bodies[move.body], "markers", ())), None
    )
    hint = f"; the axes of a beam's node are along the beam, those of its marker {node}.{GROUND_AXES} are ground axes"
    return replace(found, hint=hint) if node else found


def start_of_job(job: Job) -> InitialValues:
    """Return the start of a job after a parameter change; errors as for `run`."""
    with reported_faults(job.dynamics.system), in_use(job.settings.tuning):
        job.dynamics.return_to_start()
        return _start(job.data, job.dynamics, job.grid.start, job.start_from)


FROM_STATE = NoteKind(
    "from-state", "the run starts from the state at t = {t:g} s of {source}", severity=Severity.REMARK
)


def _start(data: ModelData, dynamics: Dynamics, t: float, state: SavedState | None) -> InitialValues:
    """Return the saved state if given, else the equilibrium or the described state, as the scene requests."""
    if state is not None:
        take_nearest_turns(dynamics, t, lambda element: state.turn(element) is None)
        start = consistent_values(dynamics, t)
        return replace(start, notes=(*start.notes, FROM_STATE(t=state.t, source=state.source)))
    if isinstance(data, Scene) and data.at_start:
        hold_at_start(dynamics, data, t)
        start = assembled(data, dynamics, t).as_asked_by([*data.at_start])
    else:
        start = assembled(data, dynamics, t)
    asked = data.start if isinstance(data, Scene) else "described"
    if isinstance(asked, SteadyMotion):
        from .steady import start_in_motion

        return start_in_motion(data, dynamics, start, t, asked)
    if asked == "equilibrium":
        from .settled import driven_in_equilibrium

        return driven_in_equilibrium(dynamics, start, t)
    if asked == "settled":
        from .settled import moving_in_equilibrium
        from .steady import rotation_left_out

        found = moving_in_equilibrium(dynamics, start, t)
        return replace(found, notes=(*found.notes, *rotation_left_out(data, dynamics, start)))
    return start


def examined(
    model: Runnable, settings: RunSettings | None = None, start_from: StartFrom | None = None, **changes: object
) -> Examined:
    """Compile a model and examine it for redundant equations; parameters and errors as for `run`."""
    data = data_of(model)
    if isinstance(data, Scene) and data.stages:
        raise InputError("found a scene with stages, which only `run` accepts, expected a scene of one run")
    state = state_to_start_from(start_from)
    chosen = settings_of(data, settings, starting_at(state, settings, changes))
    grid = output_grid(chosen)
    for name in chosen.drop_first:
        if name not in data.joints:
            raise InputError(f"drop_first: found no joint '{name}'{instead_of(name, data.joints)}")
    order = [*(name for name in data.joints if name not in chosen.drop_first), *chosen.drop_first]
    placed, turns = in_pose_of(state, data), {}
    system = compile_model(placed)
    driven = "drive" in map(attrgetter("kind"), data.joints.values()) or getattr(data, "at_start", None)
    if state is None and driven and (turns := turns_of_drives(data, system, grid.start)):
        placed = with_turns(data, turns)
        system = compile_model(placed)
    with in_use(chosen.tuning):
        refuse_far_away(system)
    system = started_from(system, placed, state)
    if state is not None and (turned := in_turns_of_new_drives(placed, system, grid.start)) is not placed:
        placed = turned
        system = started_from(compile_model(placed), placed, state)
    with reported_faults(system), in_use(chosen.tuning):
        return Examined(data, chosen, grid, examine(system, grid.start, chosen.duration, order), placed, turns, state)
