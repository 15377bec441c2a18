"""A study of how evenly the error of bdf falls with its tolerance, for steps that grow late, as IDA has it, and early.

Run it by ``python -m tests.bench.evenness [PROBLEM...]``; it prints a table of ``docs/error_control.md``.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from stiffmbs.analyses.job import Job, prepare
from stiffmbs.solve.bdf import solve
from stiffmbs.solve.error_control.error_test import CHOSEN, ErrorControl
from stiffmbs.solve.trajectory import Trajectory

from .error_bars import PROBLEMS, Problem

CONTROLS: Mapping[str, ErrorControl] = {
    "IDA's growth": ErrorControl(margin=0.15),
    "growth 1.3": ErrorControl(margin=0.12, growth=1.3),
    "present": CHOSEN[3],
}
RTOLS = 10.0 ** -np.arange(4, 10.1, 0.25)
POINTS, REFERENCE = 401, 1e-12
IN_SPACE = (
    "heavy_top", "governor", "door", "bricard", "dzhanibekov", "spatial_chain", "rolling_disc", "spatial_slider_crank",
)  # fmt: skip


@dataclass(frozen=True)
class Evenness:
    """The straight line through logarithms of errors over those of tolerances.

    Attributes
    ----------
    slope : float
    scatter : float
        By which factor errors usually lie beside the line.
    usual : float
        Geometric mean of the errors.
    risen : int
        How often a tighter tolerance has the larger error.
    steps : int
        Of all runs.
    """

    slope: float
    scatter: float
    usual: float
    risen: int
    steps: int


def evenness(problem: Problem, control: ErrorControl) -> Evenness:
    """Errors of positions, quaternions and velocities of all bodies over time, at all tolerances."""
    model = problem.model()

    def job(solver: str, rtol: float) -> Job:
        return prepare(model, duration=problem.duration, points=POINTS, presolve=False, solver=solver, rtol=rtol)

    exact = _states(job("projected", REFERENCE).integrate())
    largest = np.maximum(np.max(np.abs(exact), axis=0), 1e-3)
    errors, steps = [], 0
    for rtol in RTOLS:
        own = job("bdf", float(rtol))
        found = solve(own.dynamics, own.start, own.grid, own.settings, lambda t: None, control)
        steps += int(found.statistics["steps"])
        errors.append(float(np.sqrt(np.mean(np.max(np.abs(_states(found) - exact) / largest, axis=0) ** 2))))
    over, of = np.log10(RTOLS), np.log10(errors)
    slope, at_one = np.polyfit(over, of, 1)
    scatter, risen = np.std(of - slope * over - at_one), int(np.sum(np.diff(of) > 0))
    return Evenness(float(slope), float(10**scatter), float(10 ** np.mean(of)), risen, steps)


def _states(trajectory: Trajectory) -> np.ndarray:
    return np.hstack([trajectory.q, trajectory.u])


def main(names: list[str]) -> None:
    """Print the table, in the form of a page."""
    print(f"| problem | {' | '.join(CONTROLS)} |")
    print("|---" * (1 + len(CONTROLS)) + "|")
    for name in names or IN_SPACE:
        found = [evenness(PROBLEMS[name], control) for control in CONTROLS.values()]
        cells = (f"{e.slope:.2f} / {e.scatter:.2f} / {e.risen} / {e.usual:.1e} / {e.steps}" for e in found)
        print(f"| {name} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
