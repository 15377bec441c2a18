"""The explicit integrator with projection: Euler-Cromer, each step brought back to the constraints."""

from __future__ import annotations

import itertools
import math
import time

import numpy as np

from ..describe.settings import RunSettings
from .initial import InitialValues
from .mechanics import EULER_CROMER, NO_CONVERGENCE, NOT_FINITE, SINGULAR, Mechanics
from .trajectory import Grid, Outcome, Rows, Trajectory, Watch

_REASONS = {
    SINGULAR: "the constraint equations have become dependent on each other",
    NO_CONVERGENCE: "the positions could not be brought back to the constraints",
    NOT_FINITE: "the motion has grown beyond all numbers; the step is too long for the stiffness of the scene",
}
ROUNDING = 1e-9
"""Part of a step by which an output time may miss a whole number of steps."""


def solve(mechanics: Mechanics, start: InitialValues, grid: Grid, settings: RunSettings, watch: Watch) -> Trajectory:
    """Integrate with semi-implicit Euler steps; the contract is in `stiffmbs.solve.trajectory`.

    u_{n+1} = u_n + h u'(q_n, u_n), q_{n+1} = q_n + h u_{n+1}; with projection, positions then return by Newton's
    smallest moves to |C| < 1e-12 and velocities by the smallest correction in the mass matrix.  Between two output
    times the step is the largest that is no longer than the one asked for and divides the time between them.
    """
    system, state = mechanics.system, mechanics.state
    times = grid.times if grid.times is not None else _own_steps(grid, settings.step)
    rows = Rows(system.n_q, system.n_u, len(times))
    state.q[:], state.u[:] = start.q, start.u
    rows.append(times[0], state.q, state.u)
    outcome, message, steps = Outcome.DONE, Outcome.DONE.value, 0
    EULER_CROMER.load()  # compiled before the clock runs, should it not be in the cache
    begun = time.perf_counter()
    try:
        for t, end in itertools.pairwise(times):
            count = max(1, math.ceil((end - t) / settings.step - ROUNDING))
            status = mechanics.euler_cromer(t, (end - t) / count, count, settings.projection)
            if status < 0:
                outcome, message = Outcome.STOPPED, f"stopped after t = {t:.9g} s: {_REASONS[status]}"
                break
            steps += count
            rows.append(end, state.q, state.u)
            watch(end)
    except KeyboardInterrupt:
        outcome, message = Outcome.INTERRUPTED, Outcome.INTERRUPTED.value
    seconds = time.perf_counter() - begun
    return Trajectory(*rows.stored, outcome, message, {"steps": steps, "accelerations": steps, "seconds": seconds})


def _own_steps(grid: Grid, step: float) -> np.ndarray:
    count = max(1, math.ceil((grid.end - grid.start) / step - ROUNDING))
    return grid.start + (grid.end - grid.start) * np.arange(count + 1) / count
