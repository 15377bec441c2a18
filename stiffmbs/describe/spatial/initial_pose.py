"""Spatial markers with numbers at the described poses."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class InitialMarker:
    """Marker with numbers, in ground axes.

    Attributes
    ----------
    point : ndarray, shape (3,)
        m.
    axes : ndarray, shape (3, 3)
        Its unit axes as columns.
    """

    point: np.ndarray
    axes: np.ndarray

    @property
    def x(self) -> np.ndarray:
        return self.axes[:, 0]

    @property
    def y(self) -> np.ndarray:
        return self.axes[:, 1]

    @property
    def z(self) -> np.ndarray:
        return self.axes[:, 2]
