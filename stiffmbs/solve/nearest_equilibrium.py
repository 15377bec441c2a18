"""The equilibrium nearest to a pose, whether forces return the bodies there or not: Newton's method with a line search.

Spinning tops and rolling discs stay in equilibria that no motion in a thick fluid comes to.
"""

from __future__ import annotations

import numpy as np

from ..errors import SolverError
from .dynamics import Dynamics
from .equilibrium import ROTATION, SLOWEST, TRANSLATION, Equilibrium, as_equilibrium, newton_move, unbalanced
from .force_balance import Balance, balance_at
from .steady_motion import SteadyMotion

MOST_MOVES, MOST_HALVINGS = 100, 12


def nearest_equilibrium(dynamics: Dynamics, t: float, motion: SteadyMotion) -> Equilibrium:
    """The equilibrium in steady motion nearest to the pose of a system; parameters and errors as for `find_equilibrium`."""
    system = dynamics.system
    limits = system.per_velocity(TRANSLATION * system.size, ROTATION)
    known = balance_at(dynamics, t, motion)
    for count in range(MOST_MOVES):
        if known.balanced:
            return as_equilibrium(dynamics, t, motion, known, count)
        move = newton_move(dynamics, SLOWEST**2, known, np.zeros(system.n_u))
        part = 1.0 / max(1.0, float(np.max(np.abs(move) / limits)))
        found = _along(dynamics, t, motion, known, part * move) if np.isfinite(part) else None
        if found is None:
            break
        known = found
    raise SolverError(unbalanced(dynamics, known))


def _along(dynamics: Dynamics, t: float, motion: SteadyMotion, known: Balance, move: np.ndarray) -> Balance | None:
    """What is known after the longest part of a move that leaves less; None where none does."""
    system, state, before = dynamics.system, dynamics.state, dynamics.state.q.copy()
    for halving in range(MOST_HALVINGS):
        state.q[:] = system.of_body.moved(before, 0.5**halving * move)
        if dynamics.assemble(t) >= 0:
            found = balance_at(dynamics, t, motion)
            if np.sum(found.left**2 / system.mass) < np.sum(known.left**2 / system.mass):
                return found
    return None
