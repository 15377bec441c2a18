"""Runs beyond the end of an input: integrated up to it, with one message for all solvers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from ...compile.inputs.ends import InputEnd
from ...dynamics.dynamics import Dynamics
from ..trajectory import Grid, Outcome, Trajectory

NEAR_INPUT_END = 1e-3
"""Fraction of the run before the end of an input in which a solver that stops is assumed to stop at that end."""


def solve_up_to_the_inputs_end(dynamics: Dynamics, grid: Grid, solve: Callable[[Grid], Trajectory]) -> Trajectory:
    """Solve over a grid, or up to the first end of an input.

    Parameters
    ----------
    dynamics : Dynamics
        Dynamics of the whole system.
    grid : Grid
        Grid of the whole run.
    solve : callable
        Returns the trajectory over a grid.
    """
    end = dynamics.input_end(grid.start, grid.end)
    if end is None:
        return solve(grid)
    found = solve(_up_to(grid, end))
    own_end = found.outcome is Outcome.INTERRUPTED or (
        found.outcome is Outcome.STOPPED and end.t - _reached(found) > NEAR_INPUT_END * (grid.end - grid.start)
    )
    return found if own_end else replace(found, outcome=Outcome.STOPPED, message=end.sentence())


def _up_to(grid: Grid, end: InputEnd) -> Grid:
    """Return the grid up to the time at which values of the input still have their precision."""
    last = max(end.t - end.near, 0.5 * (grid.start + end.t))
    return replace(grid, end=last, times=None if grid.times is None else grid.times[grid.times <= last])


def _reached(found: Trajectory) -> float:
    return float(max(found.t[-1], found.step_times[-1] if len(found.step_times) else found.t[-1]))
