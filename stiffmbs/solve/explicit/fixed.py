"""Runs by steps of fixed length: Runge-Kutta schemes, semi-implicit Euler (Euler-Cromer) and linearly implicit Euler."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ...compile.machine.routines import Routine, together
from ...dynamics.dynamics import Dynamics
from ...errors import SolverError
from ...model.settings import RunSettings
from ...tuning import tuned
from ..events.chattering import CHATTERING, jump_sentence
from ..events.discontinuity import JUMP, Jumps, sliding
from ..events.narrow_inputs import narrower_than
from ..events.refusals import refuse_beyond_limits
from ..events.restart import restarted
from ..reasons import OF_STATUS
from ..stiff_rows import States
from ..trajectory import SAME_TIME, Ending, Grid, ProgressCallback, Rows, Trajectory
from .integration import REASONS, Integration


@dataclass(frozen=True)
class FixedStepParameters:
    """Parameters of steps of fixed length."""

    checks: int = 50
    """Checks of a run for chattering forces."""


FIXED_STEP = tuned("fixed_steps", FixedStepParameters())

FIXED_STEPS = Routine(
    "stiffmbs.solve.explicit.native.fixed_steps", "fixed_steps", "int64(float64, float64, int64, int64*)"
)
ONE_IN_LOOP, MANY_IN_LOOP, EACH_IN_LOOP = together(
    "stiffmbs.solve.explicit.native.in_loop",
    one_in_loop="int64(float64, float64, int64, int64*)",
    many_in_loop="int64(float64, float64, int64, int64, float64*, int64*, int64*, int64*)",
    each_in_loop="void(float64, int64, int64, float64*, float64*, float64*, float64*, float64*, int64*, int64*, int64*, int64*)",
)


def steps_between(t: float, end: float, step: float) -> int:
    """Return the least number of equal steps between two times that are no longer than a step, up to rounding."""
    return max(1, math.ceil((end - t) / step - SAME_TIME))


def failed(t: float, status: int) -> SolverError:
    """Return the error of a failure after a time, s."""
    return SolverError(OF_STATUS[status].of(f"stopped after t = {t:.9g} s: {REASONS[status]}"))


def solve_with_fixed_steps(
    dynamics: Dynamics, work: Integration, grid: Grid, settings: RunSettings, watch: ProgressCallback
) -> Trajectory:
    """Integrate with fixed steps from the state of an integration; the contract is in `stiffmbs.solve.trajectory`.

    Between two output times, or breakpoints of inputs, the step is the largest that divides their distance and does not
    exceed the given one.
    """
    features, jumps = dynamics.input_features(grid.start, grid.end), Jumps(dynamics, settings)
    times = grid.times
    if times is None:
        count = steps_between(grid.start, grid.end, settings.step)
        times = grid.start + (grid.end - grid.start) * np.arange(count + 1) / count
    outputs = grid.before(times, features)
    stops = grid.with_stops(features.breakpoints) - grid.aside
    rows = Rows(len(work.q), len(work.u), len(times))
    rows.append(times[0], work.q, work.u)
    t, steps, longest, note, row = grid.start, 0, 0.0, "", 1
    apart = max(1, len(times) // FIXED_STEP.checks)
    with Ending() as ending:
        for end in sorted({*outputs[1:].tolist(), *stops.tolist()}):
            count = steps_between(t, end, settings.step)
            longest = max(longest, (end - t) / count)
            take_steps_to(dynamics, work, t, end, count)
            t, steps = end, steps + count
            while row < len(times) and outputs[row] <= t:
                rows.append(times[row], work.q, work.u)
                row += 1
            if not note and (row - 1) % apart == 0:
                note = _jumps(dynamics, work, t, settings.step)
            if t in stops:
                before = restart_after(dynamics, work, t, grid.aside, settings)
                t = work.t
                jumps.note(t, *before)
            watch(t)
            grid.look(rows)
    statistics: dict[str, int | float | str] = {
        "scheme": work.scheme.name, "steps": steps, **work.scheme.work(steps), "seconds": ending.seconds,
    }  # fmt: skip
    missed = f"steps of {settings.step:.2g} s of {work.scheme.name}, which may not resolve it or miss it; use shorter steps, dopri5, dop853 or bdf"
    narrow = narrower_than(features, settings.step, missed)
    note = "; ".join(filter(None, (note, jumps.sentence(), narrow, unresolved_growth(work), _cut(longest, settings))))
    return Trajectory(*rows.stored, ending.outcome, ending.message, statistics, note=note)


def take_steps_to(dynamics: Dynamics, work: Integration, t: float, end: float, count: int) -> None:
    """Take equal steps between two times without breakpoints of inputs; raise a SolverError if one fails."""
    status = FIXED_STEPS.call(t, (end - t) / count, count, work.at)
    if status < 0:
        raise failed(t, status)
    refuse_beyond_limits(dynamics, end, work.q, work.u)


def restart_after(dynamics: Dynamics, work: Integration, t: float, aside: float, settings: RunSettings) -> States:
    """Restart just after a breakpoint of an input; return positions and velocities there before the restart.

    `t`: time just before the breakpoint, s. `aside`: distance of this time from the breakpoint, s.
    """
    after = t + 2.0 * aside
    before = dynamics.system.of_body.moved(work.q, 2.0 * aside * work.u), work.u.copy()
    start = restarted(dynamics, after, *before, settings.projection)
    work.t = after
    work.begin(start)
    return before


def _jumps(dynamics: Dynamics, work: Integration, t: float, step: float) -> str:
    """Return a sentence on a force that chatters about a state, or an empty string."""
    if not dynamics.system.n_event_functions:
        return ""
    q, u = work.q, work.u
    dynamics.state.q[:], dynamics.state.u[:] = q, u
    change = 2.0 * step * float(np.max(np.abs(dynamics.accelerate(t)[1]), initial=0.0))
    found = sliding(dynamics, t, q, u, min(max(change, JUMP.larger_move), CHATTERING.stays_within_at_most))
    return f"up to t = {t:.6g} s, {jump_sentence(dynamics, int(found[0]))}" if len(found) else ""


def unresolved_growth(work: Integration) -> str:
    """Return a sentence if a linearly implicit step did not resolve a growing motion, else an empty string."""
    t = work.unresolved
    if math.isnan(t):
        return ""
    return (
        f"from t = {t:.6g} s on, forces drive a motion that grows faster than a step of {work.scheme.name} resolves, and the result may be "
        "wrong; use a smaller step"
    )


def _cut(longest: float, settings: RunSettings) -> str:
    """Return a sentence if every step is shorter than the given one, else an empty string."""
    if "step" not in settings.model_fields_set or longest >= settings.step * (1 - SAME_TIME):
        return ""
    return f"step = {settings.step:.6g} s was reduced to {longest:.6g} s, to divide the output interval"
