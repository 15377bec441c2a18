"""Tolerances from 1e-1 to 1e-14: the error follows what is asked for, or the run says that it cannot."""

from __future__ import annotations

import numpy as np

from stiffmbs.results.solution import Solution

from ...mechanisms.pendulum import bar_rate, swing
from ...simulation import refusal, simulation
from .long_runs import bar_pendulum

RTOLS = tuple(10.0**-k for k in range(1, 15))
GROWTH, FLOOR = 30.0, 1e-11
"""Errors of many steps add up to so many tolerances over a second; no error is below rounding's."""


def _angle(solution: Solution) -> float:
    expected = swing(solution.t, np.pi / 2, bar_rate(1.0))
    return float(np.max(np.abs(solution["bar.angle"] + np.pi / 2 - expected)))


CASES = (
    *(
        simulation(
            f"rtol {rtol:.0e}, {scheme or solver}", "pendulum over a second; angle against elliptic functions", bar_pendulum, _angle,
            max(GROWTH * rtol, FLOOR), duration=1.0, points=21, rtol=rtol, solver=solver, scheme=scheme,
        )
        for solver, scheme in (("bdf", None), ("projected", "dop853"), ("projected", "dopri5")) for rtol in RTOLS
        if not (scheme == "dopri5" and rtol < 1e-11)
    ),
    refusal("rtol 1e-15", "finer than numbers are", bar_pendulum, ("rtol", "1e-14"), rtol=1e-15),
    refusal("rtol 0", "nothing is without error", bar_pendulum, ("rtol", "found 0"), rtol=0.0),
    refusal("rtol 1", "no digit asked for", bar_pendulum, ("rtol", "found 1"), rtol=1.0),
)  # fmt: skip
