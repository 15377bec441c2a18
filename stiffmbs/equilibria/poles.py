"""Poles of forces between two poses, which an overdamped motion cannot pass."""

from __future__ import annotations

import numpy as np

from ..dynamics.dynamics import Dynamics
from .force_balance import moved
from .parameters import EQUILIBRIA

GOLDEN = (np.sqrt(5.0) - 1.0) / 2.0


def passes_a_pole(dynamics: Dynamics, t: float, start: np.ndarray, move: np.ndarray, largest: float) -> bool:
    """Return True if forces along a move from the pose `start` exceed by far the largest one at its ends.

    A long step may pass the pole of a law such as 1/(d - x)^2.  Forces are sampled ever more closely towards both ends, and
    the largest one is refined by golden section.  The state stays at the end of the move.
    """
    system, state = dynamics.system, dynamics.state
    end = state.q.copy()

    def force(part: float) -> float:
        state.q[:] = moved(system, start, part * move)
        state.evaluate("motion", t)
        return float(np.max(np.abs(state.vector("motion", "f")), initial=0.0))

    halves = 0.5 ** np.arange(1, EQUILIBRIA.halvings + 1)
    parts = np.concatenate([[0.0], halves[::-1], 1.0 - halves[1:], [1.0]])
    forces = [force(part) for part in parts[1:-1]]
    found = int(np.argmax(forces)) + 1
    low, high, peak = parts[found - 1], parts[found + 1], forces[found - 1]
    if peak > largest:
        for _ in range(EQUILIBRIA.sections):
            first, second = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
            at_first, at_second = force(first), force(second)
            peak = max(peak, at_first, at_second)
            low, high = (low, second) if at_first > at_second else (first, high)
    state.q[:] = end
    return not peak <= EQUILIBRIA.pole * largest
