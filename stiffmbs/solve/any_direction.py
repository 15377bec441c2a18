"""A direction with a part along each axis."""

from __future__ import annotations

from random import Random  # that of NumPy takes longer to import

import numpy as np


def any_direction(n: int, seed: int) -> np.ndarray:
    """Return n numbers of random signs and of sizes from 0.5 to 1, the same for each seed."""
    random = Random(seed)
    return np.array([random.choice((-1.0, 1.0)) * random.uniform(0.5, 1.0) for _ in range(n)])
