"""Runs with sampled states: a solver integrates from sample to sample, and the states change in between.

All states that are sampled at one time take values that follow from the state just before it. Output at the time of a
sample is the state before it; a run that starts there begins with the sample. Runs in succession, as in a simulation
step by step or from a saved state, thus take every sample once.

Many samples change nothing that acts: a controller at rest, or a filter that only other samples read. The solver
integrates over as many of them at once as have gone before, and from the first one that changes a value that acts it
starts again.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ..compile.inputs.features import InputFeatures
from ..compile.system import System
from ..dynamics.dynamics import Dynamics
from ..dynamics.initial import InitialValues
from ..dynamics.storage import FAILURES
from ..errors import SolverError
from ..model.settings import RunSettings
from ..notes import Note, NoteKind, Severity
from ..reading.files.quoted import MOST_LISTED
from .events.discontinuity import Jumps
from .events.restart import restarted
from .ida.native.parameters import LOOP
from .trajectory import (
    SAME_TIME,
    Ending,
    Grid,
    History,
    Outcome,
    ProgressCallback,
    Solver,
    Trajectory,
    in_common,
    just_after,
)


class Sample(NamedTuple):
    """Time of a sample, s, and the numbers of the states that are due; none at the end of a run."""

    t: float
    due: np.ndarray


def solved_between_samples(
    solve: Solver, dynamics: Dynamics, start: InitialValues, grid: Grid, settings: RunSettings, watch: ProgressCallback
) -> Trajectory:
    """Solve from sample to sample; the contract is in `stiffmbs.solve.trajectory`.

    `solve`: for the intervals between samples, or for the whole run without sampled states.
    """
    system = dynamics.system
    if not system.sampled.any():
        return solve(dynamics, start, grid, settings, watch)
    features = dynamics.input_features(grid.start, grid.end)  # once for all intervals
    left = _before_breakpoints(samples(system, grid), grid, features)
    watched, grid = grid.monitor, replace(grid, monitor=None)  # rows past a sample do not have its values yet
    acts, own = _acting(system), slice(system.first_state, None)
    parts: list[Trajectory] = []
    jumps = Jumps(dynamics, settings)
    now, t, idle, finer = start, grid.start, 0, 1
    with Ending() as ending:
        if left[0].t == grid.start:
            values = next_values(dynamics, left[0], start.q, start.u)
            now, t = _restarted(dynamics, left.pop(0).t, start.q, start.u, values, settings, jumps)
        while left:
            passes = grid.times is not None or watched
            ahead = left[: min(max(idle, 1), LOOP.most_passed) if passes else 1]
            found = solve(dynamics, now, _up_to(grid, t, [sample.t for sample in ahead], finer), settings, watch)
            finer = len(found.t) - 1 if len(ahead) == 1 else finer
            row, values = 0, now.q[own]
            for number, sample in enumerate(ahead, 1):
                row = int(np.searchsorted(found.t, sample.t))
                if row == len(found.t) or found.t[row] != sample.t:
                    break
                try:
                    values = next_values(dynamics, sample, found.q[row], found.u[row])
                except SolverError:
                    parts.append(_up_to_row(found, row))
                    raise
                changed = (values != found.q[row, own])[acts].any()
                idle = 0 if changed else idle + 1
                if changed or (number == len(ahead) and found.outcome is Outcome.DONE):
                    found = _up_to_row(found, row)
                    break
                found.q[row + 1 :, own][:, ~acts] = values[~acts]
            parts.append(found)
            if watched:
                watched(*(column[1:] for column in (found.t, found.q, found.u)))
            if found.outcome is not Outcome.DONE:
                break
            del left[:number]
            if left:
                now, t = _restarted(dynamics, sample.t, found.q[row], found.u[row], values, settings, jumps)
    return _joined(parts, start, grid, ending, jumps.sentence())


HELD = NoteKind("sampled-states-held", "sampled states keep their values: {names}", severity=Severity.REMARK)


def held(system: System) -> Iterator[Note]:
    """Yield a note on states that an analysis of one instant keeps constant."""
    names = [system.states[k] for k in np.flatnonzero(system.sampled)]
    if names:
        yield HELD(names=", ".join(names[:4]) + (", ..." if len(names) > 4 else ""))


def samples(system: System, grid: Grid) -> Iterator[Sample]:
    """Yield the samples from the start of a run to before its end, and its end.

    A time that differs from an output time by rounding alone is that output time.
    """
    periods, offsets = system.sampling[system.sampled].T
    states = np.flatnonzero(system.sampled)
    outputs = np.array([grid.start, grid.end]) if grid.times is None else grid.times
    number = np.ceil((grid.start - offsets) / periods - SAME_TIME)
    while True:
        times = offsets + number * periods
        time = float(np.min(times))
        due = times <= time + SAME_TIME * periods
        near = np.searchsorted(outputs, time + SAME_TIME * np.min(periods[due])) - 1
        if time - outputs[near] <= SAME_TIME * np.min(periods[due]):
            time = float(outputs[near])
        if time >= grid.end:
            break
        yield Sample(time, states[due])
        number[due] += 1
    yield Sample(grid.end, np.empty(0, dtype=int))


def _before_breakpoints(found: Iterable[Sample], grid: Grid, features: InputFeatures) -> list[Sample]:
    """Return samples of which those at breakpoints are just before them, as output times are."""
    listed = list(found)
    times = np.array([sample.t for sample in listed])
    before = grid.before(times, features)
    moved = times - before > 0.5 * grid.aside  # a sample at an output time is there already, up to rounding
    return [
        sample._replace(t=t) if by else sample for sample, t, by in zip(listed, before.tolist(), moved, strict=True)
    ]


def restarts(dynamics: Dynamics, grid: Grid) -> np.ndarray:
    """Return the times at which a run restarts by inputs and samples, s, in increasing order."""
    system, found = dynamics.system, grid.stops
    if system.has_inputs:
        found = grid.with_stops(dynamics.input_features(grid.start, grid.end).all_breakpoints)
    return np.union1d(found, [sample.t for sample in samples(system, grid)]) if system.sampled.any() else found


def next_values(dynamics: Dynamics, sample: Sample, q: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Return all states just after a sample, from coordinates and velocities just before it, shape (states,).

    Raises SolverError if there are no accelerations, or a formula has no finite value.
    """
    system, t = dynamics.system, sample.t
    found: np.ndarray = q[system.first_state :].copy()
    if not len(sample.due):
        return found
    with dynamics.state.unchanged():
        rows = dynamics.report(np.array([t]), q[None], u[None], project=False)
    if not len(rows.t):
        raise SolverError(f"stopped at t = {t:.9g} s: {FAILURES[rows.status]}")
    names = [system.states[k] for k in sample.due]
    found[sample.due] = rows.values[0, [system.signals[name] for name in names]]
    if not np.isfinite(found).all():
        name = names[np.argmin(np.isfinite(found[sample.due]))]
        raise SolverError(f"stopped at t = {t:.9g} s: the formula of the sampled state '{name}' has no finite value")
    return found


def _acting(system: System) -> np.ndarray:
    """Return a mask of the states that are not sampled, or that an equation reads; samples and outputs read the others."""
    acts = ~system.sampled
    for group in system.groups:
        if any(count for term, count in group.entries.items() if term != "signal"):
            acts[group.states.ravel() - system.first_state] = True
    return acts


def _restarted(
    dynamics: Dynamics, t: float, q: np.ndarray, u: np.ndarray, values: np.ndarray, settings: RunSettings, jumps: Jumps
) -> tuple[InitialValues, float]:
    """Return consistent values with given states just after a time and after a breakpoint there, and the time of the restart.

    `jumps`: velocities that jump at such a breakpoint are noted there.
    """
    after = np.append(q[: dynamics.system.first_state], values)
    begins = max(just_after(t), dynamics.times_around(t)[1])
    begun = restarted(dynamics, begins, after, u, settings.projection)
    if begins > just_after(t):
        jumps.note(t, after, u)
    return begun, begins


def _up_to(grid: Grid, start: float, ends: Sequence[float], finer: int) -> Grid:
    """Return the part of a grid from a time to the last of some samples, with all of them among its times.

    `finer`: number of rows between two samples that are passed, if output is at all steps.
    """
    end = ends[-1]
    inside = grid.stops[(grid.stops > start) & (grid.stops < end)]
    if grid.times is None and len(ends) == 1:
        return Grid(start, end, None, inside)
    if grid.times is None:
        known = np.array([start, *ends])
        between = (known[:-1, None] + np.diff(known)[:, None] * np.arange(1, finer) / finer).ravel()
    else:
        between = grid.times[(grid.times > start) & (grid.times < end)]
    return Grid(start, end, np.union1d([start, *ends], between), inside)


def _up_to_row(part: Trajectory, row: int) -> Trajectory:
    """Return a trajectory that ends at a row."""
    if row == len(part.t) - 1 and part.outcome is Outcome.DONE:
        return part
    taken = slice(int(part.history.t.searchsorted(part.t[row])) + 1)  # and the step that contains the row, up to it
    rows = slice(row + 1)
    history = History(np.minimum(part.history.t[taken], part.t[row]), part.history.order[taken])
    return replace(
        part, t=part.t[rows], q=part.q[rows], u=part.u[rows], outcome=Outcome.DONE, message=Outcome.DONE.value,
        history=history, whole_steps=(), recorded=(),
    )  # fmt: skip


def _joined(parts: list[Trajectory], start: InitialValues, grid: Grid, ending: Ending, jumps: str) -> Trajectory:
    """Join the intervals to one trajectory whose first row is the start, before a sample there.

    `jumps`: sentence on the jumps at restarts.
    """
    kept = [_output_rows(part, grid) for part in parts]
    first = np.array([grid.start]), start.q[None], start.u[None]
    t, q, u = (np.concatenate(columns) for columns in zip(first, *kept, strict=True))
    if parts and parts[-1].outcome is not Outcome.DONE:
        ending.outcome, ending.message = parts[-1].outcome, parts[-1].message
    fields = in_common(parts)
    fields["statistics"] = {"steps": 0, "seconds": 0.0, **fields["statistics"]}
    fields["note"] = "; ".join(
        [*dict.fromkeys(note for note in (*(part.note for part in parts), jumps) if note)][:MOST_LISTED]
    )
    return Trajectory(t, q, u, ending.outcome, ending.message, **fields)


def _output_rows(part: Trajectory, grid: Grid) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the rows of an interval at output times, or at all its steps, without its first one."""
    wanted = np.full(len(part.t), True) if grid.times is None else np.isin(part.t, grid.times)
    wanted[0] = False
    return part.t[wanted], part.q[wanted], part.u[wanted]
