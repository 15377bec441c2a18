"""Negligible masses and moments of inertia for bodies of other programs without them; bodies of scenes require both."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from .body import MOMENT_ROUNDING

BEYOND = (
    "found numbers too large to compute with, expected lengths, masses and moments of inertia below 1e100 in SI units"
)
MASSLESS = 1e-8
"""Mass relative to the lightest one, and moment relative to its moment at the mechanism's reach; smaller values
increase the rounding errors of reactions."""
NO_MOMENT = 1e-12
"""Rounding tolerance of a zero moment, relative to the largest principal moment."""


def massless_moment(least: float, places: Iterable[np.ndarray]) -> float:
    """Return a moment of inertia that is negligible next to the lightest mass at the mechanism's reach, kg m^2."""
    points = np.array([np.zeros(3), *places])
    with np.errstate(over="ignore"):  # numbers beyond all bounds are refused when the scene is read
        reach = float(np.linalg.norm(np.ptp(points, axis=0))) or 1.0
    return MASSLESS * least * reach**2


def lacks_inertia(tensor: np.ndarray) -> bool:
    """Return True if a body has no moment of inertia about some axis."""
    moments = np.linalg.eigvalsh(tensor)
    return bool(np.any(np.abs(moments) <= NO_MOMENT * moments[-1]))


def breaks_triangle(tensor: np.ndarray) -> bool:
    """Return True if a principal moment exceeds the sum of the other two beyond rounding."""
    small, middle, large = np.linalg.eigvalsh(tensor)
    return bool(small + middle < large * (1 - MOMENT_ROUNDING))


def filled(tensor: np.ndarray, moment: float) -> np.ndarray:
    """Return an inertia tensor with the given moment in place of zero principal moments."""
    moments, axes = np.linalg.eigh(tensor)
    whole: np.ndarray = (axes * np.where(np.abs(moments) <= NO_MOMENT * moments[-1], moment, moments)) @ axes.T
    return whole
