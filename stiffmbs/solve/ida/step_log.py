"""Log of time, order and size of each step of an integrator."""

from __future__ import annotations

import numpy as np

from .native.layouts import STEP
from .native.parameters import LOOP

ROW = np.dtype([(name, float) for name in STEP])


class StepLog:
    """Log of steps, filled by compiled code in each call and read as arrays. `count`: number of steps."""

    def __init__(self) -> None:
        self._rows = np.empty(0, dtype=ROW)
        self.forget()

    def rows(self, steps: int) -> np.ndarray:
        """Return memory for the steps of one call, numbers in the order of `STEP`."""
        self._rows = np.empty(steps, dtype=ROW)
        return self._rows.view(float)

    def forget(self) -> None:
        """Drop all steps."""
        self._chunks: list[np.ndarray] = []
        self.count = self._kept = 0

    def begin(self, t: float) -> None:
        """Note a start at `t`; a last step beyond it, within which an event was found, is shortened."""
        if self._chunks:
            last = self._chunks[-1][-1]
            if last["end"] > t:
                last["size"] -= last["end"] - t
                last["end"] = t

    def add(self, steps: int) -> None:
        """Store the first rows."""
        self.count += steps
        kept = min(steps, LOOP.most_kept - self._kept)
        if kept > 0:
            self._chunks.append(self._rows[:kept].copy())
            self._kept += kept

    @property
    def last(self) -> tuple[float, int] | None:
        """Return the size, s, and order of the last stored step."""
        if not self._chunks:
            return None
        last = self._chunks[-1][-1]
        return float(last["size"]), int(last["order"])

    def stored(self) -> np.ndarray:
        """Return the stored steps."""
        return np.concatenate([self._rows[:0], *self._chunks])

    @property
    def t(self) -> np.ndarray:
        """Return the ends of the steps, s."""
        return self.stored()["end"].copy()

    @property
    def order(self) -> np.ndarray:
        """Return the order of each step."""
        return self.stored()["order"].astype(int)

    @property
    def step(self) -> np.ndarray:
        """Return the size of each step, s."""
        return self.stored()["size"].copy()
