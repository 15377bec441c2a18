"""Largest force and torque of each joint and force element of a run, with its time and error bar."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..results.error_bars import UNKNOWN
from ..results.solution import Solution
from .digits import with_bar
from .force_table import LOADS, elements_of, reactions_of


def joint_forces(solution: Solution) -> list[dict[str, str]]:
    """Return rows ``name what peak unit at unique``: one per force, and per torque that is nonzero or not unique.

    The peak is the largest magnitude at the output instants.  Its bar is the magnitude of the components' bars, a bound
    on the error of the vector.
    """
    components, elements = reactions_of(solution), elements_of(solution)
    levels = tuple((unit, [c for c in components if c[0] == kind]) for unit, kind in (("N", "f"), ("N m", "t")))
    noise = {
        unit: LOADS.zero * max((_peak(solution, element, parts)[0] for element in elements), default=0.0)
        for unit, parts in levels
    }
    rows: list[dict[str, str]] = []
    for element in elements:
        for unit, parts in levels:
            peak, at = _peak(solution, element, parts)
            names = [f"{element}.{part}" for part in parts]
            if unit == "N" or peak > noise[unit] or any(name in solution.not_unique for name in names):
                rows.append(_row(solution, element, names, unit, peak, at, noise[unit]))
    return rows


def _row(
    solution: Solution, element: str, names: Sequence[str], unit: str, peak: float, at: float, noise: float
) -> dict[str, str]:
    bars = [solution.errors.get(name, UNKNOWN) for name in names]
    half = math.hypot(*(float(np.max([bar.over_time, bar.least, bar.greatest])) for bar in bars))
    value = 0.0 if peak <= noise else peak
    shown = with_bar(value, half, noise) if any(name in solution.errors for name in names) else f"{value:.6g}"
    unique = not any(name in solution.not_unique for name in names)
    return {
        "name": element, "what": "force" if unit == "N" else "torque", "peak": shown, "unit": unit, "at": f"{at:.6g}",
        "unique": "yes" if unique else "no",
    }  # fmt: skip


def _peak(solution: Solution, element: str, parts: Sequence[str]) -> tuple[float, float]:
    """Return the largest magnitude and its time; zero if all values are nan."""
    sizes = np.sqrt(sum(np.square(solution.channels[f"{element}.{part}"]) for part in parts))
    if np.isnan(sizes).all():
        return 0.0, float(solution.time[0])
    k = int(np.nanargmax(sizes))
    return float(sizes[k]), float(solution.time[k])
