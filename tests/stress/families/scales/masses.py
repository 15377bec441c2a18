"""Masses that differ by up to 1e9 in one mechanism, against its two Euler-Lagrange equations."""

from __future__ import annotations

from functools import partial

import numpy as np

from stiffmbs.results.solution import Solution

from ...mechanisms.double_pendulum import angles, double_pendulum
from ...simulation import simulation

RATIOS = (1e-9, 1e-6, 1e-3, 1e3, 1e6, 1e9)


def _error(solution: Solution, masses: tuple[float, float]) -> float:
    expected = angles(solution.t, masses=masses)
    found = np.column_stack([solution["inner.angle"], solution["outer.angle"]])
    return float(np.max(np.abs(found - expected)))


def _case(ratio: float, solver: str):
    masses = (1.0, ratio)
    return simulation(
        f"mass ratio {ratio:.0e}, {solver}",
        "double pendulum, the outer bar's mass over the inner one's; angles against the Euler-Lagrange equations",
        partial(double_pendulum, masses=masses), partial(_error, masses=masses), 1e-5,
        duration=1.5, points=31, rtol=1e-8, solver=solver,
    )  # fmt: skip


CASES = tuple(_case(ratio, solver) for ratio in RATIOS for solver in ("bdf", "projected"))
