"""Static equilibrium: Newton's method on the balance of forces, with the constraints, from poses far away too.

Each move d solves, at rest and with the multipliers of the current pose,

    (s M - f_q + d(J^T lam)/dq) d + J^T lam+ = f,    J d = -C.

With s = 0 it is Newton's; s > 0 is an implicit step of a motion in a thick fluid (pseudo-transient continuation: Kelley and
Keyes, SIAM J. Numer. Anal. 35, 1998), which leads to stable equilibria alone.  s falls where forces change along the move
as the linear equations predict, and rises where they do not, as where a wheel meets the road.  States of the user's own
are unknowns beside d: their rates have to vanish, and sqrt(s) stands for one over the length of the implicit step.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.sparse import block_array, csc_array, diags_array
from scipy.sparse.linalg import splu

from ..compile.terms import TERM_AXES
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
class RatesOfStates:
    """How fast states of the user's own change, and the sizes of what their rates are made of."""

    rates: np.ndarray
    sizes: np.ndarray


@dataclass(frozen=True)
class _Balance:
    """What is known at a pose: the multipliers, what is left of the forces, and the largest of them."""

    left: np.ndarray
    lam: np.ndarray
    largest: float
    states: RatesOfStates

    def is_found(self) -> bool:
        """Whether forces balance and states stay as they are."""
        forces = np.max(np.abs(self.left), initial=0.0) <= BALANCED * self.largest
        return bool(forces and np.all(np.abs(self.states.rates) <= BALANCED * self.states.sizes))

    def norm(self, mass: np.ndarray, left: np.ndarray | None = None, rates: np.ndarray | None = None) -> float:
        """Of what is left of the forces, or of other forces and rates as measured beside these."""
        left, rates = self.left if left is None else left, self.states.rates if rates is None else rates
        forces = float(np.sqrt(np.sum(left**2 / mass)))
        if not len(rates):
            return forces
        of_one = self.largest / np.sqrt(mass.mean()) or 1.0
        return float(
            np.hypot(forces / of_one, np.linalg.norm(rates / np.where(self.states.sizes, self.states.sizes, 1.0)))
        )


def rates_of_states(dynamics: Dynamics, t: float) -> RatesOfStates:
    """At the state at hand, of which accelerations are known."""
    system, state = dynamics.system, dynamics.state
    if not system.states:
        return RatesOfStates(np.empty(0), np.empty(0))
    own = slice(system.first_state, None)
    rates = dynamics.position_rates(state.q, state.u)[own]
    state.evaluate("tangent", t)
    sizes = system.per_coordinate(system.size, 1.0)
    sizes[own] = system.state_scales
    return RatesOfStates(rates, np.abs(state.matrix("tangent", "rate_q")[own]) @ np.maximum(sizes, np.abs(state.q)))


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
        if known.is_found():
            return Equilibrium(
                state.q.copy(),
                known.lam,
                count,
                float(np.max(np.abs(known.left), initial=0.0) / (known.largest or 1.0)),
            )
        before = state.q.copy()
        move, change = _move(dynamics, t, shift, known)
        longest = float(np.max(np.abs(move) / limits, initial=0.0))
        if not system.states and known.left @ move < 0 and shift < STIFFEST:  # towards an unstable equilibrium
            shift *= RISES
            continue
        if longest > 1.0:
            shift = max(2.0 * shift, shift * float(np.sqrt(longest)))
            continue
        state.q[:] = system.of_body.moved(before, move)
        state.q[system.first_state :] += change
        found = _balance(dynamics, t) if dynamics.assemble(t) >= 0 else None
        off = _misjudged(system.mass, known, found, shift, move, change)
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
    return _Balance(
        system.mass * acceleration, state.lam[: system.n_c].copy(), float(largest), rates_of_states(dynamics, t)
    )


def _entries(dynamics: Dynamics) -> np.ndarray:
    """The single contributions to applied forces: they may cancel in the sum."""
    term = dynamics.system.term("motion", "f")
    entries: np.ndarray = dynamics.state.values["motion"][term.source]
    return entries


def _move(dynamics: Dynamics, t: float, shift: float, known: _Balance) -> tuple[np.ndarray, np.ndarray]:
    """The next move of the bodies, and the change of the states."""
    system, state = dynamics.system, dynamics.state
    state.lam[: system.n_c] = known.lam
    state.evaluate("tangent", t)
    rows = np.flatnonzero(system.active)
    rates = _sparse(dynamics, "tangent", "Z") + _identity(dynamics)
    of_poses = _sparse(dynamics, "tangent", "f_q")
    stiffness = (_sparse(dynamics, "tangent", "G_lam") - of_poses) @ rates
    by_state = slice(system.first_state, None)
    forces_by_states = -of_poses[:, by_state]
    of_rates = _sparse(dynamics, "tangent", "rate_q")[by_state]
    by_reactions = -_sparse(dynamics, "tangent", "rate_lam")[by_state][:, rows]
    rates_by_states = diags_array(np.full(len(system.states), shift)) - of_rates[:, by_state]
    jacobian = _sparse(dynamics, "tangent", "J")[rows]
    state.evaluate("motion", t)
    forces: list[Any] = [diags_array(shift**2 * system.mass) + stiffness]
    blocks = [[*forces, jacobian.T], [jacobian, None]]
    if system.states:
        blocks = [
            [*forces, forces_by_states, jacobian.T],
            [-of_rates @ rates, rates_by_states, by_reactions],
            [jacobian, None, None],
        ]
    right = np.concatenate([known.left, known.states.rates, np.zeros(len(rows))])
    try:
        found: np.ndarray = splu(block_array(blocks, format="csc")).solve(right)
    except RuntimeError:  # exactly singular: a larger shift ends it
        return np.full(system.n_u, np.inf), np.zeros(len(system.states))
    return found[: system.n_u], found[system.n_u : system.n_u + len(system.states)]


def _identity(dynamics: Dynamics) -> csc_array:
    """q' of the coordinates whose rate is a velocity."""
    system = dynamics.system
    q, u = system.of_body.straight(len(system.bodies))
    return csc_array((np.ones(len(q)), (q, u)), shape=(system.n_q, system.n_u))


def _sparse(dynamics: Dynamics, term_set: str, name: str) -> csc_array:
    system = dynamics.system
    term = system.term(term_set, name)
    axes = TERM_AXES[name]
    shape = system.extent(axes[0]), system.extent(axes[1])
    return csc_array((dynamics.state.values[term_set][term.source], (term.row, term.column)), shape=shape)


def _misjudged(
    mass: np.ndarray, known: _Balance, found: _Balance | None, shift: float, move: np.ndarray, change: np.ndarray
) -> float:
    """How far the forces left after a move are from the predicted s M d, relative to those before; the same of rates."""
    if found is None:
        return np.inf
    off = known.norm(mass, found.left - shift**2 * mass * move, found.states.rates - shift * change)
    return float(off / known.norm(mass))


def _unbalanced(dynamics: Dynamics, known: _Balance) -> str:
    system = dynamics.system
    forces = np.max(np.abs(known.left), initial=0.0) <= BALANCED * known.largest
    if forces and system.states:
        worst = int(np.argmax(np.abs(known.states.rates) / np.maximum(known.states.sizes, np.finfo(float).tiny)))
        return (
            f"no equilibrium was found: the state {system.states[worst]} goes on changing ({known.states.rates[worst]:.3g} per "
            "second), expected rates of states that can vanish"
        )
    worst = int(np.argmax(np.abs(known.left)))
    name = system.name_of(worst, system.of_body.reactions)
    return (
        f"no equilibrium was found: the largest imbalance is left in {name} ({known.left[worst]:.3g} of "
        f"{known.largest:.3g}), expected forces that hold every free motion"
    )
