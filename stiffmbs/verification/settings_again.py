"""Settings of the reruns: tolerances, steps, and their names."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..describe.settings import RunSettings
from ..results.solution import Solution
from ..solve.settings import changed, traits_of

EXPLICIT: dict[str, Any] = {"solver": "projected", "scheme": "dop853", "projection": True}
IMPLICIT: dict[str, Any] = {"solver": "bdf", "formulation": "SI2"}
"""Integrators for the comparison with the other kind."""
TIGHTEST_RTOL = 1e-13
"""Relative tolerance below which steps fail by rounding."""
CLEARLY_TIGHTER = 2.0
"""Smallest ratio of tolerances that makes a comparison useful."""
MORE_STEPS, LEAST_STEPS = 4, 1000
"""Ratio of the number of steps of a rerun with a shorter longest step, and its minimum."""


def levels_of(rtol: float) -> tuple[int, ...]:
    """Return the levels of tighter tolerances, in powers of ten: a hundredth and a tenth if rounding permits."""
    return tuple(level for level, most in ((2, 10 * CLEARLY_TIGHTER), (1, 0.0)) if rtol > most * TIGHTEST_RTOL)


def tolerances(settings: RunSettings, level: int) -> dict[str, Any]:
    """Return tolerances tighter by powers of ten, down to the tightest; looser ones if that is hardly tighter."""
    rtol = max(settings.rtol / 10**level, TIGHTEST_RTOL)
    if settings.rtol < CLEARLY_TIGHTER * rtol:
        rtol = 10 * settings.rtol
    return {"rtol": rtol, **({"atol": settings.atol * rtol / settings.rtol} if settings.atol else {})}


def shorter_step(first: Solution) -> float:
    """Return a longest step, s, that multiplies the number of steps of a run."""
    steps, whole = np.diff(first.step_times), float(first.time[-1] - first.time[0])
    if not len(steps):
        return whole / LEAST_STEPS
    wanted = max(MORE_STEPS * len(steps), LEAST_STEPS)
    few, many = whole / (8 * wanted), whole
    for _ in range(60):  # bisection of the number of steps, which decreases with their length
        middle = np.sqrt(few * many)
        few, many = (middle, many) if np.sum(np.ceil(steps / middle)) > wanted else (few, middle)
    return float(f"{many:.2g}")


def other_integrator(first: Solution, settings: RunSettings) -> dict[str, Any]:
    """Return the settings of the explicit integrator after implicit steps and vice versa: errors are independent."""
    names = str(first.solver["name"]).split(", ")
    implicit = all(traits_of(changed(settings, {"solver": name})).implicit for name in names)
    return EXPLICIT if implicit else IMPLICIT
