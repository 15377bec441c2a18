"""Static equilibrium: Newton's method on the balance of forces, with the constraints, from poses far away too.

Each move d solves, at rest and with the multipliers of the current pose,

    (s M - f_q + d(J^T lam)/dq) d + J^T lam+ = f,    J d = -C.

With s = 0 it is Newton's; s > 0 is an implicit step of a motion in a thick fluid (pseudo-transient continuation: Kelley and
Keyes, SIAM J. Numer. Anal. 35, 1998), which leads to stable equilibria alone.  s falls where forces change along the move
as the linear equations predict, and rises where they do not, as where a wheel meets the road.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import block_array, csc_array, diags_array
from scipy.sparse.linalg import splu

from ..errors import SolverError
from .dynamics import Dynamics
from .failures import FAILURES

MOST_MOVES = 500
TRANSLATION, ROTATION = 0.25, 0.2
"""Longest move of a body, relative to the mechanism's size, and rad (Adams: EQUILIBRIUM/TLIMIT, ALIMIT)."""
SLOWEST, STIFFEST = 1e-3, 1e15
"""Bounds of the root of s, rad/s: the least holds free directions where they are."""
FALLS, RISES = 0.125, 8.0
TRUSTED, REFUSED = 0.25, 1.0
"""Error of the predicted forces relative to the imbalance, up to which s falls, and from which a move is taken back."""
BALANCED = 1e-11
"""Imbalance of forces that counts as none, relative to the largest force."""


@dataclass(frozen=True)
class Equilibrium:
    """A pose at rest in which forces balance.

    Attributes
    ----------
    q, lam : ndarrays
    moves : int
        That led there.
    imbalance : float
        Largest generalised force that is left, relative to the largest that acts.
    """

    q: np.ndarray
    lam: np.ndarray
    moves: int
    imbalance: float


@dataclass(frozen=True)
class _Balance:
    """What is known at a pose: the multipliers, what is left of the forces, and the largest of them."""

    left: np.ndarray
    lam: np.ndarray
    largest: float

    def norm(self, mass: np.ndarray) -> float:
        return float(np.sqrt(np.sum(self.left**2 / mass)))


def find_equilibrium(dynamics: Dynamics, t: float) -> Equilibrium:
    """The equilibrium that a system comes to from its pose if it moves slowly; the state is at rest there afterwards.

    Parameters
    ----------
    dynamics : Dynamics
        At an assembled pose.
    t : float
        At which forces and drives are taken, s.

    Raises
    ------
    SolverError
        Where none is found; names the body with the largest imbalance.
    """
    system, state = dynamics.system, dynamics.state
    state.u[:] = 0.0
    limits = system.per_velocity(TRANSLATION * system.size, ROTATION)
    shift, known = 1.0, _balance(dynamics, t)
    for count in range(MOST_MOVES):
        if np.max(np.abs(known.left), initial=0.0) <= BALANCED * known.largest:
            return Equilibrium(
                state.q.copy(),
                known.lam,
                count,
                float(np.max(np.abs(known.left), initial=0.0) / (known.largest or 1.0)),
            )
        before = state.q.copy()
        move = _move(dynamics, t, shift**2, known)
        longest = float(np.max(np.abs(move) / limits, initial=0.0))
        if known.left @ move < 0 and shift < STIFFEST:  # towards an unstable equilibrium
            shift *= RISES
            continue
        if longest > 1.0:
            shift = max(2.0 * shift, shift * float(np.sqrt(longest)))
            continue
        state.q[:] = system.of_body.moved(before, move)
        found = _balance(dynamics, t) if dynamics.assemble(t) >= 0 else None
        off = _misjudged(system.mass, known, found, shift**2, move)
        if found is None or off > REFUSED:
            state.q[:] = before
            if shift > STIFFEST:
                break
            shift *= RISES
            continue
        known = found
        if off < TRUSTED:
            shift = max(SLOWEST, FALLS * shift)
    raise SolverError(_unbalanced(dynamics, known))


def _balance(dynamics: Dynamics, t: float) -> _Balance:
    """Multipliers that balance forces best (in the metric of the masses), and what they leave."""
    state, system = dynamics.state, dynamics.system
    state.u[:] = 0.0
    state.count_anew(t)
    status, acceleration = dynamics.accelerate(t)
    if status < 0:
        raise SolverError(f"no equilibrium was found: {FAILURES[status]}")
    state.evaluate("motion", t)
    largest = max(
        np.max(np.abs(state.vector("motion", "f")), initial=0.0), np.max(np.abs(_entries(dynamics)), initial=0.0)
    )
    return _Balance(system.mass * acceleration, state.lam[: system.n_c].copy(), float(largest))


def _entries(dynamics: Dynamics) -> np.ndarray:
    """The single contributions to applied forces: they may cancel in the sum."""
    term = dynamics.system.term("motion", "f")
    entries: np.ndarray = dynamics.state.values["motion"][term.source]
    return entries


def _move(dynamics: Dynamics, t: float, shift: float, known: _Balance) -> np.ndarray:
    system, state = dynamics.system, dynamics.state
    state.lam[: system.n_c] = known.lam
    state.evaluate("tangent", t)
    rows = np.flatnonzero(system.active)
    rates = _sparse(dynamics, "tangent", "Z") + _identity(dynamics)
    stiffness = (_sparse(dynamics, "tangent", "G_lam") - _sparse(dynamics, "tangent", "f_q")) @ rates
    jacobian = _sparse(dynamics, "tangent", "J")[rows]
    state.evaluate("motion", t)
    matrix = block_array([[diags_array(shift * system.mass) + stiffness, jacobian.T], [jacobian, None]], format="csc")
    right = np.concatenate([known.left, np.zeros(len(rows))])
    try:
        found: np.ndarray = splu(matrix).solve(right)[: system.n_u]
    except RuntimeError:  # exactly singular: a larger shift ends it
        return np.full(system.n_u, np.inf)
    return found


def _identity(dynamics: Dynamics) -> csc_array:
    """q' of the coordinates whose rate is a velocity."""
    system = dynamics.system
    q, u = system.of_body.straight(len(system.bodies))
    return csc_array((np.ones(len(q)), (q, u)), shape=(system.n_q, system.n_u))


def _sparse(dynamics: Dynamics, term_set: str, name: str) -> csc_array:
    system = dynamics.system
    term = system.term(term_set, name)
    shape = {"Z": (system.n_q, system.n_u), "J": (system.n_c, system.n_u)}.get(name, (system.n_u, system.n_q))
    return csc_array((dynamics.state.values[term_set][term.source], (term.row, term.column)), shape=shape)


def _misjudged(mass: np.ndarray, known: _Balance, found: _Balance | None, shift: float, move: np.ndarray) -> float:
    """How far the forces left after a move are from the predicted s M d, relative to those before."""
    if found is None:
        return np.inf
    off = np.sqrt(np.sum((found.left - shift * mass * move) ** 2 / mass))
    return float(off / known.norm(mass))


def _unbalanced(dynamics: Dynamics, known: _Balance) -> str:
    system = dynamics.system
    worst = int(np.argmax(np.abs(known.left)))
    name = system.name_of(worst, system.of_body.reactions)
    return (
        f"no equilibrium was found: the largest imbalance is left in {name} ({known.left[worst]:.3g} of "
        f"{known.largest:.3g}), expected forces that hold every free motion"
    )
