"""Runs with sampled states: a solver integrates from sample to sample, and the states change in between.

All states that are sampled at one time take values that follow from the state just before it. Output at the time of a
sample is the state before it; a run that starts there begins with the sample. Runs in succession, as in a simulation
step by step or from a saved state, thus take every sample once.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..compile.system import System
from ..dynamics.dynamics import Dynamics
from ..dynamics.failures import FAILURES
from ..dynamics.initial import InitialValues
from ..errors import SolverError
from ..model.settings import RunSettings
from ..tuning import tuned
from .events.restart import just_after, restarted
from .trajectory import Ending, Grid, History, Outcome, ProgressCallback, Solver, Trajectory, summed


@dataclass(frozen=True)
class SamplingParameters:
    """Parameters of sampled states."""

    same_time: float = 1e-9
    """Difference of two times, in periods, up to which they are the same sample."""
    most_notes: int = 3
    """Notes of the intervals that the run reports."""


SAMPLING = tuned("sampling", SamplingParameters())


def solved_between_samples(
    solve: Solver, dynamics: Dynamics, start: InitialValues, grid: Grid, settings: RunSettings, watch: ProgressCallback
) -> Trajectory:
    """Solve from sample to sample; the contract is in `stiffmbs.solve.trajectory`.

    Parameters
    ----------
    solve : Solver
        For each interval, or for the whole run without sampled states.
    """
    if not dynamics.system.sampled.any():
        return solve(dynamics, start, grid, settings, watch)
    dynamics.input_features(grid.start, grid.end)  # once for all intervals
    parts: list[Trajectory] = []
    now, t = start, grid.start
    with Ending() as ending:
        for time, due in samples(dynamics.system, grid):
            if time > t:
                parts.append(solve(dynamics, now, _up_to(grid, t, time), settings, watch))
                if parts[-1].outcome is not Outcome.DONE:
                    break
            if len(due):
                q, u = (parts[-1].q[-1], parts[-1].u[-1]) if parts else (start.q, start.u)
                now = sampled(dynamics, time, q, u, due, settings)
                t = min(just_after(time), grid.end)
    return _joined(parts, start, grid, ending)


def held(system: System) -> Iterator[str]:
    """Yield a note on states that an analysis of one instant keeps constant."""
    names = [system.states[k] for k in np.flatnonzero(system.sampled)]
    if names:
        yield f"sampled states keep their values: {', '.join(names[:4])}{', ...' if len(names) > 4 else ''}"


def samples(system: System, grid: Grid) -> Iterator[tuple[float, np.ndarray]]:
    """Yield the times of samples from the start of a run to before its end, s, with the states that are due; then the end.

    A time that differs from an output time by rounding alone is that output time.
    """
    periods, offsets = system.sampling[system.sampled].T
    states = np.flatnonzero(system.sampled)
    outputs = np.array([grid.start, grid.end]) if grid.times is None else grid.times
    number = np.ceil((grid.start - offsets) / periods - SAMPLING.same_time)
    while True:
        times = offsets + number * periods
        time = float(np.min(times))
        due = times <= time + SAMPLING.same_time * periods
        near = np.searchsorted(outputs, time + SAMPLING.same_time * np.min(periods[due])) - 1
        if time - outputs[near] <= SAMPLING.same_time * np.min(periods[due]):
            time = float(outputs[near])
        if time >= grid.end:
            break
        yield time, states[due]
        number[due] += 1
    yield grid.end, np.empty(0, dtype=int)


def sampled(
    dynamics: Dynamics, t: float, q: np.ndarray, u: np.ndarray, due: np.ndarray, settings: RunSettings
) -> InitialValues:
    """Return consistent values just after a sample.

    Parameters
    ----------
    t : float
        s.
    q, u : ndarrays, shapes (n_q,), (n_u,)
        State just before it.
    due : ndarray of int
        Numbers of the states that are sampled.

    Raises
    ------
    SolverError
        If there are no accelerations, or a formula has no finite value.
    """
    system = dynamics.system
    with dynamics.state.unchanged():
        rows = dynamics.report(np.array([t]), q[None], u[None], project=False)
    if not len(rows.t):
        raise SolverError(f"stopped at t = {t:.9g} s: {FAILURES[rows.status]}")
    names = [system.states[k] for k in due]
    values = rows.values[0, [system.signals[name] for name in names]]
    if not np.isfinite(values).all():
        name = names[np.argmin(np.isfinite(values))]
        raise SolverError(f"stopped at t = {t:.9g} s: the formula of the sampled state '{name}' has no finite value")
    after = q.copy()
    after[system.first_state + due] = values
    return restarted(dynamics, just_after(t), after, u, settings.projection)


def _up_to(grid: Grid, start: float, end: float) -> Grid:
    """Return the part of a grid between two times."""
    inside = grid.stops[(grid.stops > start) & (grid.stops < end)]
    if grid.times is None:
        return Grid(start, end, None, inside)
    between = grid.times[(grid.times > start) & (grid.times < end)]
    return Grid(start, end, np.concatenate([[start], between, [end]]), inside)


def _joined(parts: list[Trajectory], start: InitialValues, grid: Grid, ending: Ending) -> Trajectory:
    """Join the intervals to one trajectory whose first row is the start, before a sample there."""
    kept = [_output_rows(part, grid) for part in parts]
    first = np.array([grid.start]), start.q[None], start.u[None]
    t, q, u = (np.concatenate(columns) for columns in zip(first, *kept, strict=True))
    if ending.outcome is Outcome.DONE:
        ending.outcome, ending.message = parts[-1].outcome, parts[-1].message
    times, orders = zip(*((part.history.t, part.history.order) for part in parts), strict=True) if parts else ((), ())
    known = [np.abs(part.displaced) for part in parts if part.displaced is not None]
    return Trajectory(
        t, q, u, ending.outcome, ending.message,
        summed([{"steps": 0, "seconds": 0.0}, *(part.statistics for part in parts)]),
        History(np.concatenate([*times, np.empty(0)]), np.concatenate([*orders, np.empty(0, dtype=int)])),
        "; ".join([*dict.fromkeys(part.note for part in parts if part.note)][: SAMPLING.most_notes]),
        ", ".join(dict.fromkeys(part.solver for part in parts if part.solver)),
        tuple(steps for part in parts for steps in part.long_steps),
        np.sum(known, axis=0) if known else None,
    )  # fmt: skip


def _output_rows(part: Trajectory, grid: Grid) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the rows of an interval at output times, or at all its steps, without its first one."""
    wanted = np.full(len(part.t), True) if grid.times is None else np.isin(part.t, grid.times)
    wanted[0] = False
    return part.t[wanted], part.q[wanted], part.u[wanted]
