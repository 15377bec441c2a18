"""Runs whose inputs end on the way: integrated up to there by every solver, and told in one sentence."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from ...compile.inputs.ends import InputEnd
from ..dynamics import Dynamics
from ..trajectory import Grid, Outcome, Trajectory

NEAR_INPUT_END = 1e-3
"""Part of the run before the end of an input within which a solver that stops by itself stops for that input."""


def solve_up_to_the_inputs_end(dynamics: Dynamics, grid: Grid, solve: Callable[[Grid], Trajectory]) -> Trajectory:
    """Solve over a grid, or over as much of it as all inputs have values for.

    Parameters
    ----------
    dynamics : Dynamics
        Of the whole.
    grid : Grid
        Of the whole run.
    solve : callable
        Gives the trajectory over a grid.
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
    """The grid up to where the input's values still have their digits."""
    last = max(end.t - end.near, 0.5 * (grid.start + end.t))
    return replace(grid, end=last, times=None if grid.times is None else grid.times[grid.times <= last])


def _reached(found: Trajectory) -> float:
    return float(max(found.t[-1], found.step_times[-1] if len(found.step_times) else found.t[-1]))
