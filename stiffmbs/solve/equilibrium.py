"""Static equilibrium: Newton's method on the balance of forces, with the constraints, from poses far away too.

A motion in a thick fluid is followed by implicit steps (pseudo-transient continuation: Kelley and Keyes, SIAM J. Numer.
Anal. 35, 1998), which lead to stable equilibria alone: from the pose q_n each step seeks, at rest,

    s M (q - q_n) + J^T lam = f(q),    C(q) = 0,

by Newton's method on (s M - f_q + d(J^T lam)/dq) d = what is left.  s falls where Newton's moves become smaller quickly, as
where forces change along the step as their derivatives predict, and rises where they do not, as where a wheel meets the
road.  With s = 0 this is Newton's method for the equilibrium itself.  States x of the user's own are unknowns too: a step
seeks sqrt(s) (x - x_n) = x'(q, x), as the implicit Euler step of its length.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import block_array, csc_array, diags_array
from scipy.sparse.linalg import splu

from ..compile.system import System
from ..compile.terms import TERM_AXES
from ..errors import SolverError
from .dynamics import Dynamics
from .failures import FAILURES

MOST_MOVES = 2000
TRANSLATION, ROTATION = 0.25, 0.5
"""Longest move of a body, relative to the mechanism's size, and rad (Adams: EQUILIBRIUM/TLIMIT, ALIMIT)."""
SLOWEST, STIFFEST = 1e-3, 1e15
"""Bounds of the root of s, rad/s: the least holds free directions where they are."""
FALLS, RISES = 0.1, 4.0
WANTED, CLOSE, TOO_FAR = 0.1, 0.05, 0.6
"""Newton's moves in a step: each relative to the one before, which s is chosen for; relative to the whole step, which ends
the step, and from which on it is taken back."""
MOST_CORRECTIONS = 8
SLOW = 0.5
"""Part that has to be left after one of the last moves for another one."""
BALANCED, ROUNDING = 1e-10, 8
"""Imbalance of forces that counts as none, relative to the largest force; roundings of the coordinates that may be left in them."""


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
    """What is known at a pose.

    Attributes
    ----------
    n_u : int
        Number of velocities.
    left : ndarray, shape (n_u + states,)
        What is left of the forces, and the rates of the states.
    lam : ndarray
    largest : float
        The largest force.
    allowed : ndarray, shape (n_u + states,)
        What may be left.
    stiffness : sparse array
        Derivatives of what is left, with the opposite sign.
    jacobian, reactions : sparse arrays
        Of the constraints, and of what is left by multipliers, with the opposite sign.
    """

    n_u: int
    left: np.ndarray
    lam: np.ndarray
    largest: float
    allowed: np.ndarray
    stiffness: csc_array
    jacobian: csc_array
    reactions: csc_array

    @property
    def imbalance(self) -> float:
        """Of forces, relative to the largest."""
        return float(np.max(np.abs(self.left[: self.n_u]), initial=0.0) / (self.largest or 1.0))

    @property
    def balanced(self) -> bool:
        """Whether no more is left than rounding and a little of the largest force."""
        return bool(np.all(np.abs(self.left) <= self.allowed))


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
    state = dynamics.state
    state.u[:] = 0.0
    shift, known, moves = 1.0, _balance(dynamics, t), 0
    while moves < MOST_MOVES and shift < STIFFEST:
        if known.balanced:
            known, more = _polished(dynamics, t, known)
            return Equilibrium(state.q.copy(), known.lam, moves + more, known.imbalance)
        before = state.q.copy()
        step = _step(dynamics, t, shift, known)
        moves += step.moves
        shift = max(SLOWEST, step.factor * shift)
        if step.known is None:
            state.q[:] = before
        else:
            known = step.known
    raise SolverError(_unbalanced(dynamics, known))


@dataclass(frozen=True)
class _Step:
    """What came of an implicit step: the balance there, or None where it was none; what the root of s is multiplied by."""

    known: _Balance | None
    factor: float
    moves: int


def _step(dynamics: Dynamics, t: float, shift: float, known: _Balance) -> _Step:
    """An implicit step from the present pose; the pose is wherever it led."""
    system, state = dynamics.system, dynamics.state
    of_states = np.maximum(system.state_scales, np.abs(state.q[system.first_state :]))
    limits = np.append(system.per_velocity(TRANSLATION * system.size, ROTATION), of_states)
    start, first = state.q.copy(), 0.0
    for count in range(1, MOST_CORRECTIONS + 1):
        whole = _way(system, start, state.q)
        move = _move(dynamics, shift, known, whole)
        if (
            count == 1 and not system.states and not known.left @ np.nan_to_num(move) >= 0
        ):  # towards an unstable equilibrium
            break
        longest, longest_of_all = (float(np.max(np.abs(way) / limits, initial=0.0)) for way in (move, whole + move))
        if longest_of_all > 1.0:
            return _Step(None, max(2.0, float(np.sqrt(longest_of_all))), count)
        if count > 1 and longest > TOO_FAR * longest_of_all:
            break
        state.q[:] = _moved(system, state.q, move)
        if dynamics.assemble(t) < 0:
            break
        known, first = _balance(dynamics, t), first or longest
        if known.balanced:
            return _Step(known, 1.0, count)
        if count > 1 and longest <= CLOSE * longest_of_all:
            ratio = (longest / first) ** (1 / (count - 1))
            factor = np.sqrt(np.clip(max(ratio / WANTED, longest_of_all), FALLS**2, 1.0))
            return _Step(known, float(factor), count)
    return _Step(None, RISES, count)


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
    rates = dynamics.position_rates(state.q, state.u)[system.first_state :]
    stiffness, jacobian, reactions, sizes = _derivatives(dynamics, t)
    farthest = np.max(np.abs(state.q[system.of_body.straight(len(system.bodies))[0]]), initial=system.size)
    of_poses = abs(stiffness[: system.n_u, : system.n_u])
    rounding = ROUNDING * np.finfo(float).eps * (of_poses @ system.per_velocity(float(farthest), 1.0))
    allowed = np.append(np.maximum(BALANCED * largest, rounding), BALANCED * sizes)
    left, lam = np.append(system.mass * acceleration, rates), state.lam[: system.n_c].copy()
    return _Balance(system.n_u, left, lam, float(largest), allowed, stiffness, jacobian, reactions)


def _entries(dynamics: Dynamics) -> np.ndarray:
    """The single contributions to applied forces: they may cancel in the sum."""
    term = dynamics.system.term("motion", "f")
    entries: np.ndarray = dynamics.state.values["motion"][term.source]
    return entries


def _derivatives(dynamics: Dynamics, t: float) -> tuple[csc_array, csc_array, csc_array, np.ndarray]:
    """-f_q + d(J^T lam)/dq, J and J^T of the equations that are not redundant, by velocities, all with rows and columns of
    states; and the sizes of what the rates of states are made of."""
    system, q = dynamics.system, dynamics.state.q
    dynamics.state.evaluate("tangent", t)
    rates = _sparse(dynamics, "tangent", "Z") + _identity(dynamics)
    by_pose = _sparse(dynamics, "tangent", "G_lam") - _sparse(dynamics, "tangent", "f_q")
    stiffness, rows = by_pose @ rates, np.flatnonzero(system.active)
    jacobian = _sparse(dynamics, "tangent", "J")[rows]
    if not system.states:
        return stiffness, jacobian, jacobian.T, np.empty(0)
    own = slice(system.first_state, None)
    of_rates = _sparse(dynamics, "tangent", "rate_q")[own]
    whole = block_array([[stiffness, by_pose[:, own]], [-of_rates @ rates, -of_rates[:, own]]], format="csc")
    wide = block_array([[jacobian, csc_array((len(rows), len(system.states)))]], format="csc")
    reactions = block_array([[jacobian.T], [-_sparse(dynamics, "tangent", "rate_lam")[own][:, rows]]], format="csc")
    sizes = system.per_coordinate(system.size, 1.0)
    sizes[own] = system.state_scales
    return whole, wide, reactions, abs(of_rates) @ np.maximum(sizes, np.abs(q))


def _way(system: System, start: np.ndarray, there: np.ndarray) -> np.ndarray:
    """What leads from a pose and states to others."""
    return np.append(system.move(start, there), (there - start)[system.first_state :])


def _moved(system: System, q: np.ndarray, move: np.ndarray) -> np.ndarray:
    """The pose and states after a move."""
    there = system.of_body.moved(q, move[: system.n_u])
    there[system.first_state :] += move[system.n_u :]
    return there


def _move(dynamics: Dynamics, shift: float, known: _Balance, whole: np.ndarray) -> np.ndarray:
    """Newton's move in a step that has come so far as a whole; `shift` is the root of s."""
    system, jacobian = dynamics.system, known.jacobian
    inertia = np.append(shift**2 * system.mass, np.full(len(system.states), shift))
    matrix = block_array([[diags_array(inertia) + known.stiffness, known.reactions], [jacobian, None]], format="csc")
    right = np.concatenate([known.left - inertia * whole, np.zeros(jacobian.shape[0])])
    try:
        found: np.ndarray = splu(matrix).solve(right)[: len(inertia)]
    except RuntimeError:  # exactly singular: a larger shift ends it
        return np.full(len(inertia), np.inf)
    return found


def _polished(dynamics: Dynamics, t: float, known: _Balance) -> tuple[_Balance, int]:
    """Newton's moves from a balanced pose as long as less and less is left, and their number."""
    system, state = dynamics.system, dynamics.state
    for count in range(MOST_CORRECTIONS):
        before = state.q.copy()
        move = _move(dynamics, SLOWEST, known, np.zeros(len(known.left)))
        if not np.all(np.isfinite(move)):
            return known, count
        state.q[:] = _moved(system, before, move)
        found = _balance(dynamics, t) if dynamics.assemble(t) >= 0 else None
        if found is None or not np.max(np.abs(found.left)) < SLOW * np.max(np.abs(known.left)):
            state.q[:] = before
            return known, count
        known = found
    return known, MOST_CORRECTIONS


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


def _unbalanced(dynamics: Dynamics, known: _Balance) -> str:
    system = dynamics.system
    forces, rates = np.split(known.left, [system.n_u])
    if system.states and np.all(np.abs(forces) <= known.allowed[: system.n_u]):
        worst = int(np.argmax(np.abs(rates) / np.maximum(known.allowed[system.n_u :], np.finfo(float).tiny)))
        return (
            f"no equilibrium was found: the state {system.states[worst]} goes on changing ({rates[worst]:.3g} per second), "
            "expected rates of states that can vanish"
        )
    worst = int(np.argmax(np.abs(forces)))
    name = system.name_of(worst, system.of_body.reactions)
    return (
        f"no equilibrium was found: the largest imbalance is left in {name} ({forces[worst]:.3g} of "
        f"{known.largest:.3g}), expected forces that hold every free motion"
    )
