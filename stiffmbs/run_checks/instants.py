"""Output times at which a lasting violation is looked for."""

from __future__ import annotations

import numpy as np

from .parameters import RUN_CHECKS


def some_instants(count: int) -> np.ndarray:
    """Return the numbers of evenly spaced ones of `count` output times, with the first and the last."""
    return np.linspace(0, count - 1, min(count, RUN_CHECKS.most_instants)).astype(int)
