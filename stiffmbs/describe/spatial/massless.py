"""What stands for a body's mass or inertia where another program takes none: so slight that nothing else feels it.

A scene's bodies have both.  A link without mass in a chain changes reactions by some 1e-8
(`tests/adams/trials/test_adams_trial_parts.py`).
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

BEYOND = (
    "found numbers too large to compute with, expected lengths, masses and moments of inertia below 1e100 in SI units"
)
MASSLESS = 1e-8
"""Of the lightest mass, and of that at the mechanism's reach; with a tenth of it reactions feel rounding."""
NO_MOMENT = 1e-12
"""Of the largest principal moment: what rounding leaves of none."""


def massless_moment(least: float, places: Iterable[np.ndarray]) -> float:
    """A moment of inertia that is none beside that of the lightest mass at the far end of all places, kg m^2."""
    points = np.array([np.zeros(3), *places])
    reach = float(np.linalg.norm(np.ptp(points, axis=0))) or 1.0
    return MASSLESS * least * reach**2


def lacks_inertia(tensor: np.ndarray) -> bool:
    """Whether a body has no moment of inertia about some axis."""
    moments = np.linalg.eigvalsh(tensor)
    return bool(np.any(np.abs(moments) <= NO_MOMENT * moments[-1]))


def filled(tensor: np.ndarray, moment: float) -> np.ndarray:
    """A tensor of inertia whose principal moments are the given one where they were nothing."""
    moments, axes = np.linalg.eigh(tensor)
    whole: np.ndarray = (axes * np.where(np.abs(moments) <= NO_MOMENT * moments[-1], moment, moments)) @ axes.T
    return whole
