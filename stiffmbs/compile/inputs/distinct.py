"""Sorted values without repeats."""

from __future__ import annotations

import numpy as np


def distinct(*parts: np.ndarray) -> np.ndarray:
    """Return the values of some arrays in increasing order, each once, as `numpy.unique` does, which imports masked arrays."""
    values = np.sort(np.concatenate([part.ravel() for part in parts]))
    return values[np.diff(values, prepend=-np.inf) > 0.0]
