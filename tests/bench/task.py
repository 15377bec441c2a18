"""What other tools need to know of a problem."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stiffmbs.model.model_data import ModelData


@dataclass(frozen=True)
class Minimal:
    """A problem in as few coordinates as it has degrees of freedom, or as are easily found.

    Attributes
    ----------
    rates : callable
        ``rates(t, y)``, compiled.
    start : ndarray
        y at the start.
    places : callable
        Coordinates of all bodies, rows of (x1 y1 phi1 x2 ...), from rows of y.
    jacobian : callable, optional
        ``jacobian(t, y)``, compiled; the tool's own differences without it.
    """

    rates: Callable[..., np.ndarray]
    start: np.ndarray
    places: Callable[[np.ndarray], np.ndarray]
    jacobian: Callable[..., np.ndarray] | None = None


@dataclass(frozen=True)
class Task:
    """A problem as it is put to other tools.

    Attributes
    ----------
    scene : ModelData
    times : ndarray
        Of output, s.
    minimal : Minimal
    breakpoints : tuple of float
        Times within at which forces change their law, s.
    """

    scene: ModelData
    times: np.ndarray
    minimal: Minimal
    breakpoints: tuple[float, ...] = ()
