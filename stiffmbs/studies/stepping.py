"""Steppers of a simulation: the steps of an implicit solver, explicit steps of fixed length, or short runs."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, Protocol

import numpy as np

from ..analyses.job import Job
from ..compile.inputs.features import NO_FEATURES, InputFeatures
from ..compile.machine.layout import addresses
from ..dynamics.held_inputs import HeldInputs
from ..dynamics.initial import InitialValues
from ..dynamics.native.parameters import CONSISTENCY
from ..errors import SolverError
from ..results.joint_coordinates import JointCoordinates
from ..solve import SOLVERS
from ..solve.bdf import bdf_integrator
from ..solve.engine import Reached
from ..solve.events.refusals import refuse_beyond_limits
from ..solve.events.restart import restarted
from ..solve.explicit.fixed import (
    EACH_IN_LOOP,
    MANY_IN_LOOP,
    ONE_IN_LOOP,
    failed,
    restart_after,
    steps_between,
    take_steps_to,
    unresolved_growth,
)
from ..solve.explicit.integration import Integration
from ..solve.explicit.projected import scheme_of
from ..solve.ida.native_engine import NativeEngine
from ..solve.integrator import Integrator
from ..solve.radau.radau import radau_integrator
from ..solve.settings import traits_of
from ..solve.stiff_rows import lengths_of_steps, projected
from ..solve.trajectory import Grid, Outcome, just_after, just_before
from ..tuning import in_use, tuned


@dataclass(frozen=True)
class SteppingParameters:
    """Parameters of the steps of a simulation whose inputs change."""

    unchanged: int = 6
    """Number of steps after a jump of inputs before the solver of the run starts; inputs that jump again make its start
    useless. Source: evaluations of a start of `bdf` relative to those of a step that starts by a Radau method."""
    reach: float = 0.02
    """Part of a value by which the bounds of an input go beyond it, for which times without features of its formulas of time
    are known. Source: slow changes of a speed, against the length of the times that wide bounds leave out."""
    cells: int = 1024
    """Number of intervals of the duration that are without such features, or not. Source: steps of a thousandth of it."""


STEPPING = tuned("stepping", SteppingParameters())


class StartedSteps:
    """Starts of Radau methods, each with the steps to the next instant, in one compiled call if possible.

    One-step methods need no history, so that their first step has the full order; it is as long as the last call left
    it, and has the number of stages of that call. `q`, `u`: memory of the current state.
    """

    def __init__(self, job: Job, q: np.ndarray, u: np.ndarray) -> None:
        self._dynamics, self._q, self._u = job.dynamics, q, u
        self._integrator = radau_integrator(job.dynamics, job.settings, "starts")
        self._engine = self._integrator.engine
        self._features: InputFeatures | None = None

    def advance(self, t: float, end: float, features: InputFeatures) -> None:
        """Advance the state from time t to a later time.

        `t`, `end`: times, s. `features`: features of the inputs around these times. Raises SolverError if the end
        cannot be reached; the state is then unchanged.
        """
        if not (self._quickly(t, end, features) and self._engine.advance_from(self._q, self._u, t, end)):
            self._run(t, end)

    def _quickly(self, t: float, end: float, features: InputFeatures) -> bool:
        """Return True if no breakpoint lies between; the integrator then has the inputs."""
        if self._features is not features:
            self._engine.ida.see_inputs(features, end - t)
            self._features = features
        return not _breaks(features, t, end)

    def _run(self, t: float, end: float) -> None:
        self._features = None  # the run has the inputs up to its end only
        self._engine.ida.pause_after(np.iinfo(np.int32).max)  # never
        start = restarted(self._dynamics, t, self._q, self._u)
        for reached in self._integrator.run(start, Grid(t, end, np.array([end]))):
            last = sound(self._integrator, reached)
        self._q[:], self._u[:] = last.state()


def sound(integrator: Integrator[NativeEngine], reached: Reached) -> Reached:
    """Return the state that an integrator has reached. Raises SolverError if the integrator fails."""
    integrator.reached = reached
    if reached.failure:
        raise SolverError(f"stopped at t = {reached.t:.9g} s: {reached.failure}")
    return reached


def _breaks(features: InputFeatures, t: float, end: float) -> bool:
    """Return True if an input has a breakpoint between two times, s."""
    between = features.breakpoints
    first = int(between.searchsorted(just_before(t))) if len(between) else 0
    return first < len(between) and bool(between[first] <= just_after(end))


class Stepper(Protocol):
    """Stepper from consistent values.

    `q`, `u`: current state, overwritten by each step. `time`: time at which equations hold for it, s: just before a
    breakpoint of an input that was reached, just after one at a start. `length`: length of the implicit step that contains
    it, s; 0 for explicit steps.
    """

    time: float
    q: np.ndarray
    u: np.ndarray
    length: float

    def advance(self, t: float) -> None:
        """Advance to a later time. Raises SolverError if it cannot be reached."""

    def jump(self) -> None:
        """Discard the history before the current state, as inputs jump here."""

    def restart(self, t: float, q: np.ndarray, u: np.ndarray) -> None:
        """Continue from another state."""


class Moment(NamedTuple):
    """All that the next step of a simulation depends on, but for the history of `bdf` and `radau`; or one row for each of many.

    - `t`: time, s. `state` of shape (n_q + n_u,): (q, u). `inputs` of shape (inputs,).
    - `coordinates`, `rates` of shape (joints,): those of joints.
    """

    t: np.ndarray
    state: np.ndarray
    inputs: np.ndarray
    coordinates: np.ndarray
    rates: np.ndarray


def stepper_of(job: Job, start: InitialValues, t: float) -> Stepper:
    """Return a stepper: by the steps of bdf, radau or a scheme of fixed steps; by short runs otherwise, or with sampled states."""
    if job.dynamics.system.sampled.any():
        return ShortRuns(job, start, t)
    if job.settings.solver in ("bdf", "radau"):
        made = bdf_integrator if job.settings.solver == "bdf" else radau_integrator
        return ImplicitSteps(job, made(job.dynamics, job.settings), start, t)
    return FixedSteps(job, start, t) if traits_of(job.settings).fixed_steps else ShortRuns(job, start, t)


class ImplicitSteps:
    """Steps of bdf or radau, as long as in one run, with interpolation in the last step.

    After a jump of inputs, steps of the simulation are those of `StartedSteps`, as inputs mostly jump again; the solver
    starts if they do not. `t`: time, s.
    """

    def __init__(self, job: Job, integrator: Integrator[NativeEngine], start: InitialValues, t: float) -> None:
        self._job, self._dynamics, self._integrator = job, job.dynamics, integrator
        self._engine, self._changes = integrator.engine, self._dynamics.input_changes
        self._one_step = job.settings.solver == "radau"
        self._first = self._end = t
        self._look_through(t)
        self._begin(start, t)
        self._present, self.time, self.q, self.u, self.length = t, t, start.q.copy(), start.u.copy(), 0.0

    @cached_property
    def _started(self) -> StartedSteps:
        return StartedSteps(self._job, self.q, self.u)

    @property
    def _starts_soon(self) -> bool:
        """True while inputs are likely to jump again."""
        return self._jumped or self._since_jump < STEPPING.unchanged

    def _look_through(self, t: float) -> None:
        """Determine the features of the inputs once for all following steps, and again if formulas of time change."""
        if not self._first <= t < self._end:
            self._first, self._end = t, t + self._job.settings.duration
        elif self._changes == self._dynamics.input_changes:
            return
        self._features = self._dynamics.input_features(self._first, self._end)
        self._changes = self._dynamics.input_changes

    def _begin(self, start: InitialValues, t: float) -> None:
        self._t, self._jumped, self._since_jump = t, False, 0
        self._engine.ida.pause_after(1)
        self._steps: Iterator[Reached] = self._integrator.run(
            start, Grid(t, self._end, None).before_breakpoints(self._features)
        )

    def advance(self, t: float) -> None:
        """See `Stepper`."""
        with in_use(self._job.settings.tuning):
            self._advance(t)

    def _advance(self, t: float) -> None:
        place = self._dynamics.times_around(t)[0]
        if self._jumped or self._since_jump:
            calm = self._dynamics.meets_no_feature(self._t, t)
            if not calm:
                self._look_through(self._t)
            self.q[:], self.u[:] = self._integrator.closed(self._t, (self.q, self.u), self.length)
            begin = self._dynamics.times_around(self._t)[1]
            if self._starts_soon and (calm or t <= self._end):
                if place > just_after(begin):
                    self._started.advance(begin, place, NO_FEATURES if calm else self._features)
                    self.length = t - self._t
                self._since_jump = 1 if self._jumped else self._since_jump + 1
                self._t, self._present, self.time, self._jumped = t, t, place, False
                return
            self._look_through(begin)
            self._begin(restarted(self._dynamics, begin, self.q, self.u), begin)
        while self._t < place:
            reached = next(self._steps, None)
            if reached is None:  # end of the interval with known input features, up to rounding
                self._end = self._t
                self._look_through(self._t)
                state = self._integrator.closed(self._t, self._at(self._t), self._last_step())
                begin = self._dynamics.times_around(self._t)[1]
                self._begin(restarted(self._dynamics, begin, *state), begin)
            else:
                self._t = sound(self._integrator, reached).t
        self.q[:], self.u[:] = self._at(place)
        self._present, self.time, self.length = t, place, self._last_step()

    def _last_step(self) -> float:
        return float(self._engine.ida.cells["size"])

    def _at(self, t: float) -> tuple[np.ndarray, np.ndarray]:
        """Return q and u at a time within the last step; no error test of radau sees the drift of its polynomial."""
        (q,), (u,) = self._engine.equations.states(self._engine.ida.reported_at(t)[None])
        return projected(self._dynamics, t, (q, u), self._last_step()) if self._one_step else (q, u)

    def jump(self) -> None:
        """See `Stepper`."""
        self._t, self._jumped = self._present, True

    def restart(self, t: float, q: np.ndarray, u: np.ndarray) -> None:
        """See `Stepper`."""
        self._t, self._present, self.time, self._jumped = t, t, self._dynamics.times_around(t)[1], True
        self.q[:], self.u[:], self.length = q, u, 0.0


class FixedSteps:
    """Explicit steps of fixed length, which depend on time, state and inputs alone. `t`: time, s.

    A step of the simulation is one compiled call. It is a short run if an input has a breakpoint in it. Event functions are not located, but a start at the zero of one, after a jump, is that of a run.
    """

    def __init__(self, job: Job, start: InitialValues, t: float) -> None:
        dynamics, settings = job.dynamics, job.settings
        self._dynamics, self._settings, self._step = dynamics, settings, settings.step
        self._first, self._end, self._changes = t, t, dynamics.input_changes
        grid = Grid(t, t + settings.duration, None)
        self._work = Integration.of(scheme_of(settings), dynamics, start, grid, settings)
        self.q, self.u, self.time, self.length = self._work.q, self._work.u, t, 0.0
        self._t, self._at = t, self._work.at
        self._one, self._one_long, self._many = ONE_IN_LOOP.short_call, ONE_IN_LOOP.call, MANY_IN_LOOP.call
        self._each = EACH_IN_LOOP.call
        system = dynamics.system
        self._has_events, self._has_inputs = system.n_event_functions > 0, system.has_inputs
        self._has_limits = system.first_limit < system.n_event_functions
        self._may_grow = self._work.scheme.columns > 0

    def advance(self, t: float) -> None:
        """See `Stepper`."""
        if self._has_inputs and self._breaks(t):
            self.pass_breakpoints(t)
            return
        start, kept = self._t, (self.q.copy(), self.u.copy()) if self._has_limits else None
        steps = steps_between(start, t, self._step)
        one = self._one if steps <= self._work.capacity else self._one_long
        status = one(start, t, steps, self._at)
        if status < 0:
            raise failed(start, status)
        if kept:
            try:
                refuse_beyond_limits(self._dynamics, t, self.q, self.u)
            except SolverError:
                self.q[:], self.u[:] = kept
                raise
        self._t = self.time = t
        self._warn_of_growth()

    def advance_many(self, t: float, dt: float, values: np.ndarray, held: HeldInputs, joints: JointCoordinates) -> int:
        """Advance by as many steps of dt as there are rows of inputs, if none has a breakpoint.

        Returns the number of these steps; 0 if they must be taken one by one. Raises SolverError if a step fails, with the
        state before it.
        """
        if self._t != t or self._has_events or (self._has_inputs and self._breaks(t + len(values) * dt)):
            return 0
        steps = steps_between(t, t + dt, self._step)
        for first in range(0, len(values), self._work.capacity):  # an interrupt is noticed between calls
            rows = values[first : first + self._work.capacity]
            done = self._many(self._t, dt, steps, len(rows), *addresses(rows, held.table, joints.table), self._at)
            for _ in range(done):
                self._t += dt
            self.time = self._t
            if done < len(rows):
                raise failed(self._t, self._dynamics.status)
        self._warn_of_growth()
        return len(values)

    def may_take_each(self, t: float, end: float) -> bool:
        """Return True if steps between two times, s, may be taken by `take_each`."""
        return not (self._has_limits or (self._has_inputs and self._meets(t, end)))

    def take_each(self, dt: float, of: Moment, statuses: np.ndarray, held: HeldInputs, joints: JointCoordinates) -> str:
        """Take one step of dt from each of many moments, which are overwritten if their statuses are not negative.

        Return a sentence if a linearly implicit step has not resolved a growing motion, else an empty string.
        """
        count = steps_between(0.0, dt, self._step)
        self._each(dt, count, len(of.t), *addresses(*of, statuses, held.table, joints.table), self._at)
        return unresolved_growth(self._work) if self._may_grow else ""

    def _warn_of_growth(self) -> None:
        """Warn once if a linearly implicit step has not resolved a growing motion."""
        if self._may_grow and (sentence := unresolved_growth(self._work)):
            self._may_grow = False
            warnings.warn(sentence, RuntimeWarning, stacklevel=4)

    def _breaks(self, end: float) -> bool:
        """Return True if an input has a breakpoint between the current state and a time, s."""
        return self._t != self.time or self._meets(self._t, end)

    def _meets(self, t: float, end: float) -> bool:
        """Return True if an input has a breakpoint between two times, s."""
        if self._dynamics.meets_no_feature(t, end):
            return False
        if not self._first <= t < end <= self._end or self._changes != self._dynamics.input_changes:
            self._first, self._end = t, end + self._settings.duration
            self._features = self._dynamics.input_features(self._first, self._end)
            self._changes = self._dynamics.input_changes
        return _breaks(self._features, t, end)

    def pass_breakpoints(self, t: float) -> None:
        """Advance to a time by steps that end at breakpoints of inputs, with restarts there; the state is kept if one fails."""
        dynamics, kept = self._dynamics, (self.q.copy(), self.u.copy())
        if self._t != self.time:  # just after a breakpoint
            self._begin(self._t, *kept)
        dynamics.forget_pivots()
        self._work.forget_rates()
        place = dynamics.times_around(t)[0]
        try:
            with in_use(self._settings.tuning):
                self._run(place)
        except (SolverError, KeyboardInterrupt):
            self.q[:], self.u[:] = kept
            raise
        self._t, self.time = dynamics.times_around(t)[1], place
        self._warn_of_growth()

    def _run(self, end: float) -> None:
        """Take steps to a time, and restart at breakpoints of inputs before it."""
        t, grid = self._t, Grid(self._t, end, None)
        features = self._dynamics.input_features(t, end)
        stops = features.breakpoints - grid.aside
        for stop in sorted({*grid.before(np.array([end]), features).tolist(), *stops.tolist()}):
            take_steps_to(self._dynamics, self._work, t, stop, steps_between(t, stop, self._step))
            t = stop
            if stop in stops:
                restart_after(self._dynamics, self._work, stop, grid.aside, self._settings)
                t = self._work.t

    def _begin(self, t: float, q: np.ndarray, u: np.ndarray) -> None:
        """Start from consistent values near given ones at a time, s."""
        self._work.t = t
        with in_use(self._settings.tuning):
            self._work.begin(restarted(self._dynamics, t, q, u, self._settings.projection))

    def jump(self) -> None:
        """See `Stepper`."""
        if self._has_events:
            self._begin(self._t, self.q.copy(), self.u.copy())

    def restart(self, t: float, q: np.ndarray, u: np.ndarray) -> None:
        """See `Stepper`. A state that satisfies the constraints is not changed; the next step closes small violations."""
        self._t = self.time = self._dynamics.times_around(t)[1]
        if self._has_events or self._is_off_constraints(q, u):
            self._begin(self._t, q, u)
        else:
            self.q[:], self.u[:] = q, u

    def _is_off_constraints(self, q: np.ndarray, u: np.ndarray) -> bool:
        system, state = self._dynamics.system, self._dynamics.state
        if not (system.n_c and self._settings.projection):
            return False
        state.q[:], state.u[:] = q, u
        state.evaluate("motion", self._t)
        of_positions, of_velocities = np.abs(state.values["motion"][: 2 * system.n_c].reshape(2, -1)[:, system.active])
        allowed = self._settings.rtol * max(1.0, np.abs(u).max(initial=0.0))
        return not (
            of_positions.max(initial=0.0) <= CONSISTENCY.position_tolerance
            and of_velocities.max(initial=0.0) <= allowed
        )


class ShortRuns:
    """Runs from each instant to the next, by a solver without history. `t`: time, s."""

    def __init__(self, job: Job, start: InitialValues, t: float) -> None:
        self._job, self._start, self._t, self.time = job, start, t, t
        self._settings, self._end = job.settings, t
        self.q, self.u, self.length = start.q.copy(), start.u.copy(), 0.0

    def advance(self, t: float) -> None:
        """See `Stepper`."""
        with in_use(self._settings.tuning):
            self._advance(t)

    def _advance(self, t: float) -> None:
        if t > self._t:
            if t > self._end:  # input features are determined once for all following steps
                self._end = t + self._settings.duration
                self._job.dynamics.input_features(self._t, self._end)
            place = self._job.dynamics.times_around(t)[0]
            grid = Grid(self._t, place, np.array([self._t, place]))
            run = SOLVERS[self._settings.solver].solve
            found = run(self._job.dynamics, self._start, grid, self._settings, lambda _: None)
            if found.outcome is Outcome.INTERRUPTED:
                raise KeyboardInterrupt
            if found.outcome is not Outcome.DONE:
                raise SolverError(found.message)
            self.length = float(lengths_of_steps(found)[-1])
            q, u = projected(self._job.dynamics, place, (found.q[-1], found.u[-1]), self.length)
            self.restart(t, q, u)
            if place < t:
                self.time, self.q[:], self.u[:] = place, q, u

    def jump(self) -> None:
        """See `Stepper`."""
        self.restart(self._t, self.q, self.u)

    def restart(self, t: float, q: np.ndarray, u: np.ndarray) -> None:
        """See `Stepper`."""
        self._t = self.time = self._job.dynamics.times_around(t)[1]
        with in_use(self._settings.tuning):
            self._start = restarted(self._job.dynamics, self._t, q, u)
        self.q[:], self.u[:] = self._start.q, self._start.u
