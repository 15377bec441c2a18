"""Output times at which a lasting violation is looked for."""

from __future__ import annotations

import numpy as np

MOST_INSTANTS = 400
"""Largest number of checked output times."""


def some_instants(count: int) -> np.ndarray:
    """Return the numbers of evenly spaced ones of `count` output times, with the first and the last."""
    return np.linspace(0, count - 1, min(count, MOST_INSTANTS)).astype(int)
