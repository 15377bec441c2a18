"""Kinematic analysis: the motion of a scene whose drives prescribe every coordinate, by Newton continuation."""

from __future__ import annotations

import math

import numpy as np

from ..compile.inputs.features import InputFeatures
from ..compile.inputs.of_time import inputs_of
from ..compile.machine.native.statuses import NO_BALANCE, NO_MEMORY, NO_STATE, NOT_FINITE
from ..dynamics.algebraic_states import failure
from ..dynamics.dynamics import Dynamics
from ..dynamics.initial import InitialValues
from ..errors import InputError, SolverError
from ..model.settings import DEFAULT_POINTS, RunSettings
from ..notes import Note
from ..tuning import parameters_of
from .driven_states import KINEMATIC, Instant, IntegratedMotion, states_after
from .events.discontinuity import Jumps
from .events.narrow_inputs import hidden_peak, narrower_than
from .events.native.parameters import INDISTINCT, SEARCH
from .events.refusals import refuse_beyond_limits
from .explicit.native.parameters import CONTROL
from .reasons import OF_STATUS, Reason
from .solver import Traits
from .trajectory import Ending, Grid, ProgressCallback, Rows, Trajectory


def _length(vector: np.ndarray) -> float:
    """Return the Euclidean norm, faster than `numpy.linalg.norm` for short vectors."""
    return math.sqrt(vector.dot(vector))


def traits(settings: RunSettings) -> Traits:
    """Return the traits of the kinematic solver, which reads neither tolerances nor step from the settings."""
    return Traits("kinematic", exact=True)


def solve(
    dynamics: Dynamics, start: InitialValues, grid: Grid, settings: RunSettings, watch: ProgressCallback
) -> Trajectory:
    """Compute the motion that the drives prescribe; the contract is in `stiffmbs.solve.trajectory`.

    Each step predicts q + h u + h^2/2 u' and corrects it by Newton's method. It is halved until positions and
    velocities are near their prediction, so that the solution cannot jump to another branch. Velocities that drives
    prescribe are integrated to 1e-11 (`IntegratedMotion`). If the mechanism locks (dead centre under its drive), the
    run stops with a message that names time and pose. Velocities and accelerations are recomputed after breakpoints of
    the drives. The features of the drives between breakpoints bound the step. Raises InputError when the drives leave
    a freedom, prescribe one twice, or depend on a state.
    """
    _refuse_freedoms(dynamics)
    _refuse_followed_states(dynamics)
    times = grid.times if grid.times is not None else np.linspace(grid.start, grid.end, DEFAULT_POINTS)
    system = dynamics.system
    rows = Rows(system.n_q, system.n_u, len(times))
    features = dynamics.input_features(grid.start, grid.end)
    narrowest = min(grid.end - grid.start, features.narrowest()[0])
    shortest = max(CONTROL.shortest * narrowest, INDISTINCT * max(abs(grid.start), abs(grid.end)))
    motion: _Motion | IntegratedMotion
    if _by_velocities(dynamics):
        longest = float(np.min(features.longest, initial=np.inf))
        motion = IntegratedMotion(dynamics, start, times[0], max(longest, 2 * shortest))
    else:
        motion = _Motion(dynamics, start, times[0], shortest, features)
    jumps, breakpoints = Jumps(dynamics, settings), iter((*features.breakpoints, np.inf))
    breakpoint = next(breakpoints)
    rows.append(times[0], motion.q, motion.u)
    with Ending() as ending:
        for t, place in zip(times[1:], grid.before(times, features)[1:], strict=True):
            while breakpoint < place:
                motion.go_to(breakpoint - grid.aside)
                before = motion.q, motion.u
                motion.go_past(breakpoint + grid.aside)
                jumps.note(breakpoint, *before)
                breakpoint = next(breakpoints)
            motion.go_to(place)
            refuse_beyond_limits(dynamics, t, motion.q, motion.u)
            rows.append(t, motion.q, motion.u)
            watch(t)
            grid.look(rows)
    statistics = {"steps": motion.steps, "moves": motion.moves, "seconds": ending.seconds}
    spacing = float(np.max(np.diff(times), initial=0.0))
    missed = f"{spacing:.2g} s between output times; the results may not show its peaks: use a shorter output interval or --verify"
    narrow = narrower_than(features, spacing, missed)
    hidden = narrow or hidden_peak(inputs_of(system), features, times)
    note = "; ".join(filter(None, (jumps.sentence(), hidden)))
    return Trajectory(*rows.stored, ending.outcome, ending.message, statistics, note=note)


def _refuse_followed_states(dynamics: Dynamics) -> None:
    """Refuse drives and constraints that depend on states, as the motion is then not prescribed."""
    system = dynamics.system
    of_velocities = system.term("tangent", "V_q")
    rows = [*system.term("tangent", "C_x").row, *of_velocities.row[of_velocities.column >= system.first_state]]
    if rows:
        raise InputError(
            f"'{system.equations[rows[0]][0]}': found a state in a drive or constraint, expected functions of time with solver "
            "kinematic; use bdf or auto"
        )


def _refuse_freedoms(dynamics: Dynamics) -> None:
    system = dynamics.system
    equations = int(np.sum(system.active))
    if equations != system.n_u:
        raise InputError(
            f"kinematic analysis: found {equations} independent equations for {system.n_u} velocities of the bodies, "
            "expected joints and drives that prescribe every coordinate"
        )


def _by_velocities(dynamics: Dynamics) -> bool:
    """Return True if a drive or joint prescribes a velocity without a position."""
    system = dynamics.system
    return bool(np.any(system.active & ~system.holonomic))


class _Motion:
    """Prescribed motion with its current positions, velocities and accelerations."""

    def __init__(
        self, dynamics: Dynamics, start: InitialValues, t: float, shortest: float, features: InputFeatures
    ) -> None:
        self._dynamics, self._shortest, self._features = dynamics, shortest, features
        self.t, self.steps, self.moves = t, 0, 0
        self._status = 0
        self._parameters = parameters_of(KINEMATIC)
        self.q, self.u, self.a = start.q, start.u, start.acceleration
        state = dynamics.state
        state.q[:], state.u[:] = start.q, start.u
        self._polish(t)
        self.q, self.u = state.q.copy(), state.u.copy()
        self._turns = dynamics.system.per_velocity(0.0, 1.0)  # 1 for angles, 0 for lengths
        self._counters = slice(dynamics.system.n_pose, dynamics.system.first_state)
        self._turning = self._rates_of_counters(t)

    def go_to(self, end: float) -> None:
        """Compute the motion up to a later time, in as many steps as necessary.

        Where the shortest step fails, the search is repeated without the accelerations: where two branches of a drive are
        equal up to rounding, these may be those of the other one.
        """
        h, without = end - self.t, False
        while self.t < end:
            h = min(h, end - self.t, max(self._features.longest_step(self.t), 2 * self._shortest))
            last = end - self.t <= h
            if self._step(end if last else self.t + h, h):
                h, without = 2 * h, False
            elif h > self._shortest:
                h /= 2
            elif not without:
                self.a, h, without = 0.0 * self.a, end - self.t, True
            else:
                raise SolverError(self._stuck())

    def go_past(self, t: float) -> None:
        """Recompute velocities and accelerations just after a breakpoint."""
        state = self._dynamics.state
        state.q[:], state.u[:] = self.q, self.u
        self._status = min(self._dynamics.assemble(t), 0) or self._dynamics.correct_velocities(t)
        if self._status < 0 or not self._take(t):
            raise SolverError(self._stuck())

    def _step(self, t: float, h: float) -> bool:
        """Try one step; return True if positions and velocities are near their prediction."""
        state, dynamics = self._dynamics.state, self._dynamics
        step = h * self.u + h * h / 2 * self.a
        self._status = 0
        if np.abs(step * self._turns).max() > 2.0 * SEARCH.turned:
            return False
        predicted_q, predicted_u = dynamics.system.of_body.moved(self.q, step), self.u + h * self.a
        predicted_q[self._counters] += h * self._turning
        state.q[:], state.u[:] = predicted_q, predicted_u
        moves = dynamics.assemble(t)
        self._status = min(moves, 0)
        if moves < 0 or not self._near(state.q, predicted_q, h):
            return False
        self._status = dynamics.correct_velocities(t)
        if self._status < 0:
            return False
        size = max(_length(self.u), _length(state.u))
        if _length(state.u - predicted_u) > self._parameters.change * size + 1e-9:
            return False
        before = self.u
        if not self._take(t):
            return False
        secant = (self.u - before) / h
        if (
            h * _length(self.a - secant) > self._parameters.change * size + 1e-9
        ):  # forces of 1e23 N leave no significant digit
            self.a = secant
        self.steps, self.moves = self.steps + 1, self.moves + moves
        return True

    def _take(self, t: float) -> bool:
        """Accept the current state and its accelerations as reached; return True if they exist."""
        state = self._dynamics.state
        self._polish(t)
        turning = self._rates_of_counters(t)
        before = Instant(self.t, self.q, self.u, self.a, self._turning)
        state.q[self._dynamics.system.first_state :] = states_after(self._dynamics, before, t)
        state.q[self._counters] = self.q[self._counters] + (t - self.t) / 2 * (self._turning + turning)
        state.restart_counters(t)
        self._status, acceleration = self._dynamics.accelerate(t)
        if self._status == 0:
            self.t, self.q, self.u, self.a = t, state.q.copy(), state.u.copy(), acceleration
            self._turning = turning
        return self._status == 0

    def _rates_of_counters(self, t: float) -> np.ndarray:
        state = self._dynamics.state
        if not self._dynamics.system.n_counters:
            return np.empty(0)
        state.evaluate("acceleration", t)
        return self._dynamics.position_rates(state.q, state.u)[self._counters]

    def _near(self, q: np.ndarray, predicted: np.ndarray, h: float) -> bool:
        own = _length(h * self.u) + _length(h * h / 2 * self.a)
        miss = self._dynamics.system.move(predicted, q)
        return bool(_length(miss) <= self._parameters.surprise * own + 1e-9)

    def _polish(self, t: float) -> None:
        """Correct positions to rounding by up to two more Newton moves, then velocities."""
        self._dynamics.assemble(t, tolerance=0.0, most=2)
        self._dynamics.correct_velocities(t)

    def _stuck(self) -> Note:
        """Return why the shortest step failed: the mechanism locks, unless the last attempt has another cause."""
        if self._status in (NOT_FINITE, NO_BALANCE, NO_MEMORY, NO_STATE):
            reason = failure(self._dynamics, self._status, self.t)
            return OF_STATUS[self._status].of(f"stopped after t = {self.t:.9g} s: {reason}")
        return self._locked()

    def _locked(self) -> Note:
        system, state = self._dynamics.system, self._dynamics.state
        state.q[:], state.u[:] = self.q, self.u
        state.evaluate("motion", self.t)
        directions, _, _ = np.linalg.svd(state.matrix("motion", "J")[system.active])
        names = [name for (name, _), active in zip(system.equations, system.active, strict=True) if active]
        involved = list(dict.fromkeys(names[k] for k in np.argsort(-np.abs(directions[:, -1]))[:4]))
        pose = ", ".join(f"{body} at {system.of_body.place(self.q, k)}" for k, body in enumerate(system.bodies[:6]))
        more = ", ..." if len(system.bodies) > 6 else ""
        return Reason.LOCKED.of(
            f"the mechanism locks at t = {self.t:.9g} s (dead centre): the drives prescribe a motion that "
            f"{', '.join(involved)} do not allow; last pose: {pose}{more}"
        )
