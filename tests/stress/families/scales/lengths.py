"""Mechanisms from a micrometre to ten kilometres, against their Euler-Lagrange equations."""

from __future__ import annotations

from functools import partial

import numpy as np

from stiffmbs.results.solution import Solution

from ...mechanisms.double_pendulum import angles, double_pendulum
from ...simulation import simulation

LENGTHS = (1e-6, 1e-4, 1e-2, 1e2, 1e4)


def _error(solution: Solution, length: float) -> float:
    expected = angles(solution.t, length)
    found = np.column_stack([solution["inner.angle"], solution["outer.angle"]])
    return float(np.max(np.abs(found - expected)))


def _case(length: float, solver: str):
    return simulation(
        f"bars of {length:.0e} m, {solver}",
        "double pendulum over the time that its length asks for; angles against the Euler-Lagrange equations",
        partial(double_pendulum, length), partial(_error, length=length), 1e-5,
        duration=1.5 * length**0.5, points=31, rtol=1e-8, solver=solver,
    )  # fmt: skip


CASES = tuple(_case(length, solver) for length in LENGTHS for solver in ("bdf", "projected"))
