"""Log of time, order and size of each step of an integrator."""

from __future__ import annotations

import numpy as np

WIDTH = 3
MOST_KEPT = 1_000_000
"""Largest number of stored steps; later ones are only counted."""


class StepLog:
    """Log of steps, filled by compiled code in each call and read as arrays.

    Attributes
    ----------
    count : int
        Number of steps.
    """

    def __init__(self) -> None:
        self._rows = np.empty((0, WIDTH))
        self._chunks: list[np.ndarray] = []
        self.count = self._kept = 0

    def rows(self, steps: int) -> np.ndarray:
        """Return memory for the steps of one call; each row is end time, order and size."""
        self._rows = np.empty((steps, WIDTH))
        return self._rows

    def forget(self) -> None:
        """Drop all steps."""
        self._chunks.clear()
        self.count = self._kept = 0

    def begin(self, t: float) -> None:
        """Note a start at `t`; a last step beyond it, within which an event was found, is shortened."""
        if self._chunks and len(self._chunks[-1]):
            last = self._chunks[-1][-1]
            if last[0] > t:
                last[2] -= last[0] - t
                last[0] = t

    def add(self, steps: int) -> None:
        """Store the first rows."""
        self.count += steps
        kept = min(steps, MOST_KEPT - self._kept)
        if kept > 0:
            self._chunks.append(self._rows[:kept].copy())
            self._kept += kept

    @property
    def last(self) -> tuple[float, int] | None:
        """Return the size, s, and order of the last stored step."""
        if not self._chunks or not len(self._chunks[-1]):
            return None
        _, order, size = self._chunks[-1][-1]
        return float(size), int(order)

    def ends(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the ends of the steps, s, and their orders."""
        rows = self._all()
        return rows[:, 0].copy(), rows[:, 1].astype(int)

    def _all(self) -> np.ndarray:
        return np.concatenate([np.empty((0, WIDTH)), *self._chunks])

    @property
    def t(self) -> np.ndarray:
        """Return the ends of the steps, s."""
        return self._all()[:, 0].copy()

    @property
    def order(self) -> np.ndarray:
        """Return the order of each step."""
        return self._all()[:, 1].astype(int)

    @property
    def step(self) -> np.ndarray:
        """Return the size of each step, s."""
        return self._all()[:, 2].copy()
