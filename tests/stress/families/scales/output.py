"""Output grids of 2 points and of 10 million, and what the grid must not change."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from stiffmbs.analyses.run import run
from stiffmbs.results.solution import Solution

from ...case import Case, Verdict, measured
from ...mechanisms.pendulum import bar_rate, swing
from ...simulation import refusal, simulation
from .long_runs import bar_pendulum


def _angle(solution: Solution) -> float:
    """In blocks, as ten million angles take much memory."""
    worst = 0.0
    for first in range(0, len(solution.t), 100_000):
        part = slice(first, first + 100_000)
        expected = swing(solution.t[part], np.pi / 2, bar_rate(1.0))
        worst = max(worst, float(np.max(np.abs(solution["bar.angle"][part] + np.pi / 2 - expected))))
    return worst


def _same_steps(solver: str) -> Verdict:
    """The state at the end with 2 points, 1001, and the solver's own steps: output changes no step."""
    how: dict[str, Any] = {"duration": 5.0, "rtol": 1e-8, "solver": solver}
    ends = [run(bar_pendulum(), points=points, **how)["bar.angle"][-1] for points in (2, 1001, "steps")]
    return measured(float(np.ptp(ends)), 1e-5)


CASES = (
    *(
        simulation(
            f"{points} points, {solver}", "pendulum; angle against elliptic functions", bar_pendulum, _angle, 1e-5,
            duration=5.0, points=points, rtol=1e-8, solver=solver,
        )
        for points in (2, 3, 100_001) for solver in ("bdf", "projected")
    ),
    simulation(
        "10 million points", "pendulum; angle against elliptic functions", bar_pendulum, _angle, 1e-5,
        duration=5.0, points=10_000_000, rtol=1e-8, quick=False,
    ),
    refusal("100 million points", "more than a run holds in memory", bar_pendulum, ("output", "1e+07"), points=100_000_000),
    refusal("1 point", "a run has two ends", bar_pendulum, ("points", "found 1"), points=1),
    *(
        Case(f"the grid changes no step, {solver}", "angles at the end of three grids against each other", partial(_same_steps, solver))
        for solver in ("bdf", "projected")
    ),
)  # fmt: skip
