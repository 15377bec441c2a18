"""Errors of runs with explicit steps, by a second run at a larger tolerance.

Errors grow about as the tolerance, so that a ninth of the difference from a run with ten times the tolerance is the error.
The second run takes about three quarters of the steps of the first.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..results.error_bars import ErrorBar, between
from ..results.scales import kind_of

LARGER = 10.0
"""Tolerance of the second run in that of the first."""


def bars_by_difference(
    times: np.ndarray, channels: Mapping[str, np.ndarray], others: Mapping[str, np.ndarray]
) -> dict[str, ErrorBar]:
    """Return the error bars of the channels of a run, from those of a run with a larger tolerance at the same times."""
    found = {}
    every = np.arange(len(times))
    for name, values in channels.items():
        if name.startswith("constraint."):
            continue
        error = np.abs(difference(name, values, others[name])) / (LARGER - 1.0)
        sampled = [between(times, sign * values, every) for sign in (-1.0, 1.0)]
        peaks = [error[int(np.nanargmin(values))], error[int(np.nanargmax(values))]]
        found[name] = ErrorBar(
            float(np.nanmax(error)), *(float(peak + more) for peak, more in zip(peaks, sampled, strict=True)), *sampled
        )
    return found


def difference(name: str, values: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Return the difference of a channel in two runs; that of an angle is the one of the least turn."""
    error = values - others
    if kind_of(name) == "angle":
        error = error - 2.0 * np.pi * np.round(error / (2.0 * np.pi))
    return error
