"""Step-by-step simulation of a model, with inputs that change between steps."""

from __future__ import annotations

import math
import numbers
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import TypeVar, Unpack

import numpy as np

from ..analyses.job import Job, Runnable, data_of, prepare
from ..analyses.rerun import DRIFTED, exactly, relaxed
from ..analyses.start_from import StartFrom, in_pose_of, started_from, state_to_start_from
from ..dynamics.algebraic_states import failure
from ..dynamics.dynamics import OutputRows
from ..elements.turns import TURN
from ..errors import AssemblyError, ChannelError, InputError, SolverError, StiffmbsError, prefixed
from ..model.settings import RunSettings, Settings, takes_settings
from ..results.channels import channels_of, turns_of
from ..results.frames import places_of_channels
from ..results.instant import Instant
from ..results.joint_coordinates import JointCoordinates
from ..results.provenance import provenance_of
from ..results.saved_state import SavedState
from ..run_checks.tables import may_refuse, refuse_departure
from ..solve.error_control.relaxation import drift_at
from ..solve.events.restart import restarted
from ..solve.settings import changed
from ..solve.stiff_rows import with_stiff_forces
from ..tuning import in_use
from .case_solver import CaseSolver, Task, written_scene
from .input_numbers import InputNumbers, Inputs
from .joint_pose import JointPose, named_coordinates
from .saved_simulation import exactly_saved, inputs_and_state, write_simulation
from .stepping import FixedSteps, Stepper, stepper_of

S = TypeVar("S", bound="Simulation")
OWN_INPUTS = "inputs"
"""Section of a scene with its inputs."""
DRIFT_CHECK_INTERVAL = 64
"""Number of steps between checks for drift of relaxed constraints, in addition to those at steps 1, 2, 4, 8, ..."""


@takes_settings
def simulation(
    model: Runnable,
    inputs: Mapping[str, float] | None = None,
    settings: RunSettings | None = None,
    **changes: Unpack[Settings],
) -> Simulation:
    """Return a simulation of a model that is advanced step by step.

    Parameters
    ----------
    model : Model, Scene, str or Path
    inputs : mapping of str to float, optional
        Inputs to change between steps, with their initial values, SI units.  They are parameters or paths of the scene
        that occur only in forces and states, such as ``{"F": 0.0}`` or ``{"forces.motor.torque": 0.0}``.  Numeric
        inputs of the model are always included, by their names.
    settings : RunSettings, optional
        Settings of the run; by default those of the scene.
    **changes
        Fields of the settings to change.

    Raises
    ------
    InputError
        If the model, a setting or an input is invalid.
    AssemblyError
        If no consistent start is found.

    Examples
    --------
    >>> sim = stiffmbs.simulation("examples/cart_pendulum.yaml", inputs={"forces.spring.stiffness": 270.0})
    >>> while sim.t < 1.0:
    ...     sim.step(0.01, inputs={"forces.spring.stiffness": 270.0 if sim["cart.vx"] > 0 else 300.0})
    """
    return simulation_of(Simulation, model, inputs, settings, changes)


def simulation_of(
    kind: type[S], model: Runnable, inputs: Mapping[str, float] | None, settings: RunSettings | None, changes: Settings
) -> S:
    """Return a simulation of a kind; see `simulation`."""
    data = data_of(model)
    own = {name: float(value) for name, value in data.inputs.items() if isinstance(value, float)}
    given = dict(inputs or {})
    given |= {name: value for name, value in own.items() if name not in given}
    paths = (f"{OWN_INPUTS}.{name}" if name in own else name for name in given)
    solver = CaseSolver(Task(written_scene(data), tuple(paths), {}, ()))
    scene = solver.scene([float(value) for value in given.values()])
    return kind(solver, given, changed(settings or scene.run, dict(changes)))


class Simulation:
    """Model that is solved step by step; made by `stiffmbs.simulation`.

    Attributes
    ----------
    t : float
        Current time, s.
    """

    def __init__(self, solver: CaseSolver, inputs: Mapping[str, float], settings: RunSettings) -> None:
        scene = solver.scene([float(value) for value in inputs.values()])
        job = prepare(scene, settings)
        self._job: Job = prepare(scene, changed(settings, {"presolve": False})) if job.subsystems else job
        self._first = dict(inputs)
        self._bounded = may_refuse(self._job.dynamics.system)
        self._inputs = InputNumbers(self._job, solver, self._first)
        self._joints = joints = JointCoordinates(self._job.dynamics.system, self._job.data.joints)
        self._places_of_joints = {
            name + ending: (values, k)
            for values, ending in ((joints.coordinates, ""), (joints.rates, "_rate"))
            for k, name in enumerate(joints.names)
        }
        self._instant = Instant(self._job.data, self._job.dynamics.system, self._row, self._angle)
        self._known: dict[str, float] | None = None
        self.reset()

    def reset(
        self,
        state: StartFrom | None = None,
        joints: Mapping[str, float] | None = None,
        rates: Mapping[str, float] | None = None,
    ) -> None:
        """Return to the start, with the initial values of the inputs, or to another state.

        Parameters
        ----------
        state : SavedState, Solution, str or Path, optional
            State to continue from, as by `load`.
        joints : mapping of str to float, optional
            Coordinates of joints, m or rad, by channel (``hinge.angle``), or by joint if it has one. The others are
            those of the start, unless loops move them.
        rates : mapping of str to float, optional
            Rates of coordinates, m/s or rad/s, by the names of `joints`. With either of both, all others are zero.

        Raises
        ------
        InputError
            If the state cannot be read or belongs to another model, or if the joints cannot have these coordinates or
            rates; the simulation is then at its start.
        """
        if state is not None and (joints is not None or rates is not None):
            raise InputError("reset: found a state and coordinates or rates of joints, expected one of both")
        job = self._job
        self._inputs.set(self._first)
        job.dynamics.forget_pivots()
        self.t = job.settings.start
        with in_use(job.settings.tuning):
            self._stepper = stepper_of(job, job.start, job.grid.start)
        self._steps = 0
        self._go_on_with(self._stepper, relaxed(job))
        self._follow_from({})
        self._forget()
        if state is not None:
            self.load(state)
        elif joints is not None or rates is not None:
            self._pose(joints or {}, rates or {})

    def _pose(self, joints: Mapping[str, float], rates: Mapping[str, float]) -> None:
        """Take coordinates and rates of joints at the start."""
        dynamics, names = self._job.dynamics, self._joints.names
        wanted = named_coordinates(self._joints, joints, "reset: joint")
        rates_wanted = named_coordinates(self._joints, rates, "reset: rate of joint")
        pose = JointPose(dynamics, self._joints, self.t, self._stepper.q)
        try:
            with dynamics.state.unchanged():
                pose.move_to(wanted)
                u = pose.velocities(self._stepper.u, rates_wanted)
            self._stepper.restart(self.t, pose.q, u)
        finally:
            self._joints.watch(self._stepper.q, self._stepper.u)
            self._follow_from({names[k]: value for k, value in wanted.items()})

    def _follow_from(self, known: Mapping[str, float]) -> None:
        """Count the turns of joint angles from the current time and known channels on."""
        self._joints.begin(self.t, known)
        self._followed = True

    @property
    def q(self) -> np.ndarray:
        """Return the current coordinates: those of each body in the order of the scene, then counters of turns and states.

        A body has ``x y angle`` in the plane and ``x y z q0 q1 q2 q3`` in space, of its centre of mass and principal axes.
        """
        return self._stepper.q.copy()

    @property
    def u(self) -> np.ndarray:
        """Return the current velocities of all bodies: ``vx vy omega``, or ``vx vy vz`` and ``wx wy wz`` in body axes."""
        return self._stepper.u.copy()

    @property
    def joints(self) -> tuple[str, ...]:
        """Return the channels of all coordinates of joints, in the order of the scene, such as ``hinge.angle``."""
        return self._joints.names

    @property
    def joint_coordinates(self) -> np.ndarray:
        """Return the current coordinates of joints in the order of `joints`, m or rad; angles count their turns."""
        return self._current_joints().coordinates.copy()

    @property
    def joint_rates(self) -> np.ndarray:
        """Return the current rates of the coordinates of joints in the order of `joints`, m/s or rad/s."""
        return self._current_joints().rates.copy()

    def _current_joints(self) -> JointCoordinates:
        """Return the coordinates of joints at the current state."""
        if not self._followed:
            self._joints.follow(self._stepper.time)
            self._followed = True
        return self._joints

    @property
    def inputs(self) -> dict[str, float]:
        """Return the current values of the inputs."""
        return dict(self._inputs.values)

    def step(self, dt: float, inputs: Inputs | None = None) -> None:
        """Advance by a time step, with inputs that are constant from now on.

        If no input changes, `bdf` and `radau` keep their history, as in one run; otherwise steps start by a Radau method.

        Parameters
        ----------
        dt : float
            Time step, s, greater than 0.
        inputs : mapping of str to float, or sequence of float, optional
            New values by name, where other inputs keep theirs, or of all inputs in the order of `inputs`.

        Raises
        ------
        InputError
            If dt is not positive, or an input is unknown or not finite.
        SolverError
            If the solver fails; the state is then the previous one.
        """
        if not isinstance(dt, numbers.Real) or not 0 < dt < math.inf:
            raise InputError(f"step: found dt = {dt!r}, expected a time greater than 0 s")
        self._forget()
        held, end = self._inputs.held.values.copy(), self.t + float(dt)
        try:
            if inputs is not None:
                self.set_inputs(inputs)
            self._step_to(end)
        except StiffmbsError:
            self.set_inputs(held)
            raise
        self.t = end
        self._followed = self._joints.any_followed
        if self._followed:
            self._joints.follow(end)

    def _step_to(self, end: float) -> None:
        """Advance the stepper to a later time, s."""
        before = (self.q, self.u) if self._bounded else None
        self._steps += 1
        if self._relaxed and (self._steps % DRIFT_CHECK_INTERVAL == 0 or self._steps & (self._steps - 1) == 0):
            with in_use(self._job.settings.tuning):
                self._advance_without_drift(end)
        else:
            self._advance(end)
        if before:
            self._stay_within_tables(end, *before)

    def steps(self, n: int, inputs: Inputs | None = None, dt: float | None = None) -> None:
        """Advance by several steps; schemes of fixed steps take them in one compiled call.

        Parameters
        ----------
        n : int
            Number of steps.
        inputs : mapping of str to float, or array of shape (inputs,) or (n, inputs), optional
            Inputs of all steps, or one row for each of them, in the order of `inputs`.
        dt : float, optional
            Time step, s; by default `step` of the run.

        Raises
        ------
        InputError
            If n or dt is not positive, or inputs have another shape, are unknown or not finite; nothing is changed. If the
            scene refuses an input of a row; the steps of the rows before it are kept.
        SolverError
            If a step fails; the state is then that before this step.
        """
        dt = self._job.settings.step if dt is None else dt
        valid = isinstance(n, numbers.Integral) and isinstance(dt, numbers.Real)
        if not valid or n < 1 or not 0 < dt < math.inf:
            raise InputError(f"steps: found n = {n!r} and dt = {dt!r}, expected a number and a time greater than 0")
        rows, done = self._inputs.rows(inputs, n), 0
        if self._inputs.affine and not (self._inputs.of_time or self._bounded or self._relaxed):
            done = self._taken_together(dt, rows[: self._inputs.valid_rows(rows)])
        for k, row in enumerate(rows[done:], done):
            with prefixed(f"row {k} of the inputs: "):
                self.step(dt, row)

    def _taken_together(self, dt: float, rows: np.ndarray) -> int:
        """Take steps in one compiled call if the stepper can; return their number."""
        if not isinstance(self._stepper, FixedSteps):
            return 0
        held = self._inputs.held.values.copy()
        try:
            return self._stepper.advance_many(self.t, dt, rows, self._inputs.held, self._joints)
        except SolverError:
            taken = round((self._stepper.time - self.t) / dt)
            self.set_inputs(rows[taken - 1] if taken else held)
            raise
        finally:
            self._followed = self._followed and self._stepper.time == self.t
            self.t = self._stepper.time
            self._forget()

    def _stay_within_tables(self, end: float, q: np.ndarray, u: np.ndarray) -> None:
        """Return to a state, and raise a SolverError, if the current one is outside a table with ``beyond: error``."""
        try:
            refuse_departure(self._job.dynamics.system, end, self._stepper.q, self._stepper.u)
        except SolverError:
            self._stepper.restart(self.t, q, u)
            raise

    def _forget(self) -> None:
        """Discard the channels of an earlier state."""
        self._known = None
        self._instant.forget()

    def _advance(self, end: float) -> None:
        """Advance to a later time; use relaxed constraints again if exact ones fail, as in a singular pose."""
        try:
            self._stepper.advance(end)
        except SolverError:
            if self._relaxed or not relaxed(self._job):
                raise
            with in_use(self._job.settings.tuning):
                self._go_on_with(self._steps_of(self._job, self.q, self.u), relaxed=True)
            self._stepper.advance(end)

    def _advance_without_drift(self, end: float) -> None:
        """Advance to a later time; if relaxed constraints drift, repeat this with exact ones and keep these."""
        q, u = self.q, self.u
        self._stepper.advance(end)
        dynamics, settings = self._job.dynamics, self._job.settings
        with dynamics.state.unchanged():
            dynamics.state.q[:] = self._stepper.q
            drift = drift_at(dynamics, self._stepper.time, self._stepper.u, settings)
        if drift > DRIFTED:
            with suppress(SolverError):  # in a singular pose, which only relaxed constraints pass
                exact = self._steps_of(exactly(self._job), q, u)
                exact.advance(end)
                self._go_on_with(exact, relaxed=False)

    def _steps_of(self, job: Job, q: np.ndarray, u: np.ndarray) -> Stepper:
        """Return a stepper from a state at the current time."""
        t = job.dynamics.times_around(self.t)[1]
        return stepper_of(job, restarted(job.dynamics, t, q, u), t)

    def _go_on_with(self, stepper: Stepper, relaxed: bool) -> None:
        self._stepper, self._relaxed = stepper, relaxed
        self._places = places_of_channels(self._job.dynamics.system, stepper.q, stepper.u)
        self._joints.watch(stepper.q, stepper.u)

    def set_inputs(self, inputs: Inputs) -> None:
        """Set inputs from now on, by name, where others keep their values, or all in the order of `inputs`.

        Raises
        ------
        InputError
            If an input is unknown, or its value is invalid.
        """
        if self._inputs.set(inputs):
            self._stepper.jump()
            self._forget()

    @property
    def channels(self) -> dict[str, float]:
        """Return every channel at the current time, as in a solution.

        Raises
        ------
        AssemblyError
            If no accelerations and reactions are found at the current time.
        """
        if self._known is None:
            self._known = {name: float(values[0]) for name, values in self._report()[0].items()}
        return dict(self._known)

    def __getitem__(self, channel: str) -> float:
        """Return the current value of a channel; only this one is computed."""
        place = self._places.get(channel)
        if place:
            values, number = place
            return values.item(number)
        place = self._places_of_joints.get(channel)
        if place:
            self._current_joints()
            values, number = place
            return values.item(number)
        try:
            return self._instant.value(channel)
        except ChannelError as error:
            raise InputError(str(error)) from None

    @property
    def state(self) -> SavedState:
        """Return the current state, from which a run may start: ``stiffmbs.run(model, start_from=sim.state)``."""
        channels, turns = self._report()
        known, counted = ({name: float(values[0]) for name, values in part.items()} for part in (channels, turns))
        return SavedState("the simulation", self.t, known, counted, exact=np.concatenate([self.q, self.u]))

    def _report(self) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
        """Return the current channels and revolution counters, one value each."""
        job, system, rows = self._job, self._job.dynamics.system, self._instant.rows
        channels = channels_of(job.data, system, rows)
        channels |= {name: np.array([self._angle(rows, name)]) for name in self._joints.angles}
        return channels, turns_of(system, rows.q)

    def _row(self) -> OutputRows:
        """Return the output row of the current state."""
        dynamics = self._job.dynamics
        with dynamics.state.unchanged():
            q, u = self.q[None], self.u[None]
            rows = dynamics.report(np.array([self._stepper.time]), q, u, project=self._job.on_constraints)
            lengths, rtol = np.array([self._stepper.length]), self._job.settings.rtol
            rows = with_stiff_forces(dynamics, (q, u), rows, lengths, rtol)
        if not len(rows.t):
            raise AssemblyError(
                f"no accelerations and reactions were found at t = {self.t:.9g} s: {failure(dynamics, rows.status, self.t)}"
            )
        return rows

    def _angle(self, rows: OutputRows, channel: str) -> float:
        """Return a continuous angle of a joint."""
        angle = rows.values.item(0, self._job.dynamics.system.reported[channel])
        near = self._current_joints().coordinates.item(self._joints.names.index(channel))
        return angle + TURN * round((near - angle) / TURN)

    def save(self, path: str | Path) -> None:
        """Write the current state and inputs to a file .npz, which `load` and ``stiffmbs run --from`` read.

        Raises
        ------
        InputError
            If the file has another suffix.
        """
        write_simulation(
            path,
            self.t,
            self.state,
            self._inputs.values,
            provenance_of(self._job.data, self._job.settings, state=self._job.start_from),
        )

    def load(self, path: StartFrom) -> None:
        """Continue from a saved state: a file that `save` or ``stiffmbs run -o`` wrote, a `SavedState` or a `Solution`.

        Raises
        ------
        InputError
            If the file cannot be read, or belongs to another model.
        """
        found = state_to_start_from(path)
        if found is None:
            raise InputError("load: found None, expected a file of results, a Solution, or a state of one")
        job = self._job
        placed = started_from(job.dynamics.system, in_pose_of(found, job.data), found)
        inputs, exact = inputs_and_state(path, found.exact)
        self._inputs.set(inputs)
        self._stepper.restart(found.t, *exactly_saved(placed.q, placed.u, exact))
        self.t = found.t
        self._follow_from(found.channels)
        self._forget()
