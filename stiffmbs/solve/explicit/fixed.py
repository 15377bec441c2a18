"""Explicit steps of fixed length: semi-implicit Euler (Euler-Cromer) and Runge-Kutta schemes."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ...compile.machine.routines import Routine
from ...dynamics.dynamics import Dynamics
from ...dynamics.initial import InitialValues
from ...dynamics.native.parameters import CONSISTENCY
from ...errors import SolverError
from ...model.settings import RunSettings
from ...tuning import tuned
from ..events.chattering import CHATTERING, jump_sentence
from ..events.discontinuity import JUMP, Jumps, sliding
from ..events.narrow_inputs import narrower_than_steps
from ..events.refusals import refuse_beyond_limits
from ..events.restart import restarted
from ..reasons import OF_STATUS
from ..trajectory import SAME_TIME, Ending, Grid, ProgressCallback, Rows, Trajectory
from .integration import REASONS, Integration
from .scheme import Scheme


@dataclass(frozen=True)
class FixedStepParameters:
    """Parameters of explicit steps of fixed length."""

    checks: int = 50
    """Checks of a run for chattering forces."""


FIXED_STEP = tuned("fixed_steps", FixedStepParameters())

EULER_CROMER = Routine(
    "stiffmbs.solve.explicit.native.euler_cromer",
    "euler_cromer",
    "int64(float64, float64, int64, int64, float64, int64*)",
)
FIXED_STEPS = Routine(
    "stiffmbs.solve.explicit.native.runge_kutta", "fixed_steps", "int64(float64, float64, int64, int64*)"
)


class Stepper(NamedTuple):
    """Integrator that takes steps of fixed length from its state.

    `q`, `u`: current state. `take`: ``take(t, h, steps)`` takes steps from time t and returns 0 or a negative status.
    `begin`: ``begin(t, start)`` restarts from consistent values. `accelerations`: accelerations computed in a step.
    """

    scheme: str
    q: np.ndarray
    u: np.ndarray
    take: Callable[[float, float, int], int]
    begin: Callable[[float, InitialValues], None]
    accelerations: int


def euler_cromer(dynamics: Dynamics, start: InitialValues, settings: RunSettings) -> Stepper:
    """Return a semi-implicit Euler stepper: u_{n+1} = u_n + h u'(q_n, u_n), q_{n+1} = q_n + h u_{n+1}, projected."""
    state, table, steps_of = dynamics.state, dynamics.table.ctypes.data, EULER_CROMER.call

    def begin(t: float, values: InitialValues) -> None:
        state.q[:], state.u[:] = values.q, values.u

    def take(t: float, h: float, steps: int) -> int:
        return steps_of(t, h, steps, settings.projection, CONSISTENCY.position_tolerance, table)

    begin(0.0, start)
    return Stepper("euler_cromer", state.q, state.u, take, begin, 1)


def runge_kutta(scheme: Scheme, dynamics: Dynamics, start: InitialValues, grid: Grid, settings: RunSettings) -> Stepper:
    """Return a stepper of a Runge-Kutta scheme, with projection after each step."""
    work, steps_of = Integration(scheme, dynamics, start, grid, settings), FIXED_STEPS.call

    def take(t: float, h: float, steps: int) -> int:
        return steps_of(t, h, steps, work.at)

    def begin(t: float, values: InitialValues) -> None:
        work.t = t
        work.begin(values)

    return Stepper(scheme.name, work.q, work.u, take, begin, scheme.stages)


def solve_with_fixed_steps(
    dynamics: Dynamics, stepper: Stepper, grid: Grid, settings: RunSettings, watch: ProgressCallback
) -> Trajectory:
    """Integrate with fixed steps; the contract is in `stiffmbs.solve.trajectory`.

    Between two output times, or breakpoints of inputs, the step is the largest that divides their distance and does not
    exceed the given one.
    """
    features, jumps = dynamics.input_features(grid.start, grid.end), Jumps(dynamics, settings)
    times = grid.times if grid.times is not None else _own_steps(grid, settings.step)
    outputs = grid.before(times, features)
    stops = grid.with_stops(features.breakpoints) - grid.aside
    rows = Rows(len(stepper.q), len(stepper.u), len(times))
    rows.append(times[0], stepper.q, stepper.u)
    t, steps, longest, note, row = grid.start, 0, 0.0, "", 1
    apart = max(1, len(times) // FIXED_STEP.checks)
    with Ending() as ending:
        for end in sorted({*outputs[1:].tolist(), *stops.tolist()}):
            count = max(1, math.ceil((end - t) / settings.step - SAME_TIME))
            longest = max(longest, (end - t) / count)
            status = stepper.take(t, (end - t) / count, count)
            if status < 0:
                raise SolverError(OF_STATUS[status].of(f"stopped after t = {t:.9g} s: {REASONS[status]}"))
            t, steps = end, steps + count
            refuse_beyond_limits(dynamics, t, stepper.q, stepper.u)
            while row < len(times) and outputs[row] <= t:
                rows.append(times[row], stepper.q, stepper.u)
                row += 1
            if not note and (row - 1) % apart == 0:
                note = _jumps(dynamics, stepper, t, settings.step)
            if t in stops:
                t += 2.0 * grid.aside
                u = stepper.u.copy()  # the stepper's state may be that of the dynamics
                before = dynamics.system.of_body.moved(stepper.q, 2.0 * grid.aside * u), u
                start = restarted(dynamics, t, *before, settings.projection)
                jumps.note(t, *before)
                stepper.begin(t, start)
            watch(t)
    statistics: dict[str, int | float | str] = {
        "scheme": stepper.scheme, "steps": steps, "accelerations": stepper.accelerations * steps, "seconds": ending.seconds,
    }  # fmt: skip
    narrow = narrower_than_steps(features, settings.step, stepper.scheme)
    note = "; ".join(filter(None, (note, jumps.sentence(), narrow, _cut(longest, settings))))
    return Trajectory(*rows.stored, ending.outcome, ending.message, statistics, note=note)


def _jumps(dynamics: Dynamics, stepper: Stepper, t: float, step: float) -> str:
    """Return a sentence on a force that chatters about a state, or an empty string."""
    if not dynamics.system.n_event_functions:
        return ""
    q, u = stepper.q.copy(), stepper.u.copy()
    dynamics.state.q[:], dynamics.state.u[:] = q, u
    change = 2.0 * step * float(np.max(np.abs(dynamics.accelerate(t)[1]), initial=0.0))
    found = sliding(dynamics, t, q, u, min(max(change, JUMP.larger_move), CHATTERING.stays_within_at_most))
    stepper.q[:], stepper.u[:] = q, u
    return f"up to t = {t:.6g} s, {jump_sentence(dynamics, int(found[0]))}" if len(found) else ""


def _cut(longest: float, settings: RunSettings) -> str:
    """Return a sentence if every step is shorter than the given one, else an empty string."""
    if "step" not in settings.model_fields_set or longest >= settings.step * (1 - SAME_TIME):
        return ""
    return f"step = {settings.step:.6g} s was reduced to {longest:.6g} s, to divide the output interval"


def _own_steps(grid: Grid, step: float) -> np.ndarray:
    count = max(1, math.ceil((grid.end - grid.start) / step - SAME_TIME))
    return grid.start + (grid.end - grid.start) * np.arange(count + 1) / count
