"""The settings with which a run is solved again: tolerances, steps, and what these are called."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..describe.settings import RunSettings
from ..results.solution import Solution
from ..solve.settings import changed, traits_of

EXPLICIT: dict[str, Any] = {"solver": "projected", "scheme": "dop853", "projection": True}
IMPLICIT: dict[str, Any] = {"solver": "bdf", "formulation": "SI2"}
"""The integrators that runs of others are compared with."""
TIGHTEST_RTOL = 1e-13
"""Relative tolerance below which steps fail by rounding."""
CLEARLY_TIGHTER = 2.0
"""Times tighter that a tolerance must be at the least to tell anything beside another."""
MORE_STEPS, LEAST_STEPS = 4, 1000
"""Times as many steps, and at least so many, that a run with another longest step takes."""


def levels_of(rtol: float) -> tuple[int, ...]:
    """A hundredth and a tenth of a tolerance, as far as rounding leaves both."""
    return tuple(level for level, most in ((2, 10 * CLEARLY_TIGHTER), (1, 0.0)) if rtol > most * TIGHTEST_RTOL)


def tolerances(settings: RunSettings, level: int) -> dict[str, Any]:
    """Tighter by so many powers of ten, down to the tightest; looser where that is hardly tighter: then that run's error shows."""
    rtol = max(settings.rtol / 10**level, TIGHTEST_RTOL)
    if settings.rtol < CLEARLY_TIGHTER * rtol:
        rtol = 10 * settings.rtol
    return {"rtol": rtol, **({"atol": settings.atol * rtol / settings.rtol} if settings.atol else {})}


def shorter_step(first: Solution) -> float:
    """A longest step with which a run takes some times as many steps as it did, s."""
    steps, whole = np.diff(first.step_times), float(first.time[-1] - first.time[0])
    if not len(steps):
        return whole / LEAST_STEPS
    wanted = max(MORE_STEPS * len(steps), LEAST_STEPS)
    few, many = whole / (8 * wanted), whole
    for _ in range(60):  # by bisection of the number of steps, which falls with their length
        middle = np.sqrt(few * many)
        few, many = (middle, many) if np.sum(np.ceil(steps / middle)) > wanted else (few, middle)
    return float(f"{many:.2g}")


def other_integrator(first: Solution, settings: RunSettings) -> dict[str, Any]:
    """The explicit one after implicit steps, and the implicit one after others: their errors have nothing in common."""
    names = str(first.solver["name"]).split(", ")
    implicit = all(traits_of(changed(settings, {"solver": name})).implicit for name in names)
    return EXPLICIT if implicit else IMPLICIT
