"""Nearest equilibrium, stable or not, by Newton's method with a line search.

Spinning tops and rolling discs have equilibria that overdamped motion does not reach.
"""

from __future__ import annotations

import numpy as np

from ..compile.system import System
from ..dynamics.dynamics import Dynamics
from ..errors import SolverError
from .equilibrium import Equilibrium, as_equilibrium, at_start, moved_on, newton_move, unbalanced
from .force_balance import Balance, balance_at
from .parameters import EQUILIBRIA
from .steady_motion import SteadyMotion


def nearest_equilibrium(dynamics: Dynamics, t: float, motion: SteadyMotion) -> Equilibrium:
    """Find the equilibrium in steady motion nearest to the pose; parameters and errors as for `find_equilibrium`."""
    system = dynamics.system
    limits = system.per_velocity(EQUILIBRIA.translation * system.size, EQUILIBRIA.rotation)
    known = balance_at(dynamics, t, motion)
    for count in range(EQUILIBRIA.most_nearest_moves):
        if known.balanced:
            return as_equilibrium(dynamics, t, known, count)
        move = newton_move(dynamics, EQUILIBRIA.least_shift, known, at_start(known))
        part = 1.0 / max(1.0, float(np.max(np.abs(move[: system.n_u]) / limits)))
        found = _along(dynamics, t, known, part * move) if np.isfinite(part) else None
        if found is None:
            break
        known = found
    raise SolverError(unbalanced(dynamics, known))


def _along(dynamics: Dynamics, t: float, known: Balance, move: np.ndarray) -> Balance | None:
    """Return the balance after the longest fraction of a move that reduces the residual, or None."""
    system, before = dynamics.system, dynamics.state.q.copy()
    for halving in range(EQUILIBRIA.most_halvings):
        found = moved_on(dynamics, t, known, before, 0.5**halving * move)
        if found is not None and _left(system, known, found) < _left(system, known, known):
            return found
    return None


def _left(system: System, before: Balance, found: Balance) -> float:
    """Return the residual of forces in the mass metric and of rates of states, relative to that before."""
    forces, rates = np.split(found.left, [system.n_u])
    total = float(np.sum(forces**2 / system.mass))
    if not system.states:
        return total
    of_forces, of_rates = np.split(before.left, [system.n_u])
    scales = float(np.sum(of_forces**2 / system.mass)) or 1.0, float(np.sum(of_rates**2)) or 1.0
    return total / scales[0] + float(np.sum(rates**2)) / scales[1]
