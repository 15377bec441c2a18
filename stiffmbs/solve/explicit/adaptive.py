"""Explicit Runge-Kutta steps that are chosen by the error."""

from __future__ import annotations

import time

import numpy as np

from ...compile.corners import corner_times
from ...compile.routines import Routine
from ...describe.settings import RunSettings
from ...errors import SolverError
from ..initial import InitialValues
from ..mechanics import Mechanics
from ..restart import restarted
from ..tolerances import absolute_tolerances
from ..trajectory import Grid, History, Outcome, Rows, Trajectory, Watch
from .integration import Integration
from .scheme import Scheme
from .sentences import REASONS, stiff_sentence

ADVANCE = Routine("stiffmbs.solve.native.runge_kutta", "advance", "int64(float64, int64, int64, int64*)")
PAUSED, AT_END = 0, 1
"""Statuses of a call: to be called again, and done."""
WORTH_TELLING = 0.1
"""Part of the steps that stability must have held back for the summary to name bdf."""


def solve_adaptively(
    scheme: Scheme, mechanics: Mechanics, start: InitialValues, grid: Grid, settings: RunSettings, watch: Watch
) -> Trajectory:
    """Integrate with a scheme that estimates its error; the contract is in `stiffmbs.solve.trajectory`.

    Steps are not cut by output times: states there come from the scheme's interpolant.  They are cut by corners in
    time, which long steps of a motion at rest would jump over.
    """
    system = mechanics.system
    work = Integration(scheme, mechanics, start, grid, settings)
    rows = Rows(system.n_q, system.n_u, len(grid.times) if grid.times is not None else work.room + 1)
    own_steps = grid.times is None
    if own_steps:
        rows.append(grid.start, start.q, start.u)
    outcome, message, status = Outcome.DONE, Outcome.DONE.value, AT_END
    advance = ADVANCE.load()
    corners = corner_times(system, grid.start, grid.end)
    begun = time.perf_counter()
    try:
        for stop in (*corners, grid.end):
            work.h = first_step(scheme, mechanics, start, work.t, grid.end, settings)
            status = PAUSED
            while status == PAUSED:
                status = advance(stop, work.room, own_steps, work.at)
                work.collect(rows)
                watch(work.t)
            if status < 0:
                break
            if stop < grid.end:
                start = restarted(mechanics, stop, work.q, work.u, settings.projection)
                work.begin(start)
    except SolverError as error:
        outcome, message = Outcome.STOPPED, str(error)
    except KeyboardInterrupt:
        outcome, message = Outcome.INTERRUPTED, Outcome.INTERRUPTED.value
    if status < 0:
        outcome, message = Outcome.STOPPED, f"stopped at t = {work.t:.9g} s: {REASONS[status]}"
    elif work.count("stiff_steps") > WORTH_TELLING * work.count("steps"):
        message = f"{message}; {stiff_sentence(work)}"
    statistics: dict[str, int | float] = {n: work.count(n) for n in ("steps", "rejected", "accelerations")}
    statistics["corners"] = int(np.sum(corners < work.t))
    statistics["seconds"] = time.perf_counter() - begun
    history = History(np.concatenate([*work.step_times, np.empty(0)]), np.empty(0, dtype=int))
    return Trajectory(*rows.stored, outcome, message, statistics, history)


def first_step(
    scheme: Scheme, mechanics: Mechanics, start: InitialValues, t: float, end: float, settings: RunSettings
) -> float:
    """A first step whose error will be small (Hairer, Norsett, Wanner I, ch. II.4, "starting step size"), s."""
    atol = np.tile(absolute_tolerances(mechanics.system, settings), 2)
    y, rate = np.concatenate([start.q, start.u]), np.concatenate([start.u, start.acceleration])
    scale = atol + settings.rtol * np.abs(y)

    def size(vector: np.ndarray) -> float:
        return float(np.sqrt(np.mean((vector / scale) ** 2))) if len(vector) else 0.0

    of_state, of_rate = size(y), size(rate)
    h = 0.01 * of_state / of_rate if min(of_state, of_rate) > 1e-5 else 1e-6
    mechanics.state.q[:], mechanics.state.u[:] = start.q + h * start.u, start.u + h * start.acceleration
    status, acceleration = mechanics.accelerate(t + h)
    change = size(np.concatenate([mechanics.state.u, acceleration]) - rate) / h
    largest = max(of_rate, change)
    if status < 0 or not np.isfinite(largest):
        return h
    longer = (0.01 / largest) ** (1 / scheme.order) if largest > 1e-15 else max(1e-6, 1e-3 * h)
    return min(100 * h, longer, end - t)
