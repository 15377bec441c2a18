"""Static equilibrium by pseudo-transient continuation, which converges from distant poses.

Implicit steps follow a motion in a viscous fluid (Kelley and Keyes, SIAM J. Numer. Anal. 35, 1998), which leads to
stable equilibria only. From the pose q_n each step solves, at rest,

  s M (q - q_n) + J^T lam = f(q),    C(q) = 0,

by Newton's method with the matrix s M - f_q + d(J^T lam)/dq. s decreases if Newton's moves converge fast, and increases
if they do not, as where a wheel meets the road. s = 0 is Newton's method for the equilibrium itself. User-defined
states x are unknowns too: a step solves sqrt(s) (x - x_n) = x'(q, v, x) with v = sqrt(s) (q - q_n), an implicit Euler
step of length 1/sqrt(s). The equations of algebraic states are those at rest.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..compile.system import System
from ..dynamics.dynamics import Dynamics
from ..errors import SolverError
from ..reading.units.quantity import LARGEST
from .force_balance import Balance, balance_at, displacement, moved, strayed
from .matrices import diagonal, joined, solution, zeros
from .parameters import EQUILIBRIA
from .steady_motion import SteadyMotion, at_rest

FAR = LARGEST
"""Move in place of an infinite one, m or rad, whose products with forces are finite."""


GOLDEN = (np.sqrt(5.0) - 1.0) / 2.0
"""Ratio of the golden section."""


@dataclass(frozen=True)
class Equilibrium:
    """Pose at rest, or in a steady motion, in which forces balance."""

    q: np.ndarray
    u: np.ndarray
    acceleration: np.ndarray
    lam: np.ndarray
    moves: int  # number of Newton moves
    imbalance: float  # largest residual of a generalised force, relative to the largest force
    motion: SteadyMotion  # with the speeds that were found


def find_equilibrium(
    dynamics: Dynamics,
    t: float,
    motion: SteadyMotion | None = None,
    most: int | None = None,
    since: np.ndarray | None = None,
) -> Equilibrium:
    """Find the stable equilibrium that a system reaches from its pose in overdamped motion; the state is set to it.

    `dynamics`: at an assembled pose. `t`: time at which forces and drives are evaluated, s. `motion`: steady motion of
    the equilibrium; at rest by default. `most`: largest number of moves. `since`: pose whose values drives of velocities
    keep; by default the current one. Raises SolverError when none is found; names the body with the largest imbalance.
    """
    state = dynamics.state
    shift, moves = 1.0, 0
    known = balance_at(dynamics, t, motion or at_rest(dynamics.system.of_body.dimensions))
    if since is not None:
        known = replace(known, strayed=strayed(dynamics, t, since))
    while moves < (most or EQUILIBRIA.most_moves) and shift < EQUILIBRIA.largest_shift:
        if known.balanced:
            known, more = _polished(dynamics, t, known)
            return as_equilibrium(dynamics, t, known, moves + more)
        before = state.q.copy()
        step = _step(dynamics, t, shift, known)
        moves += step.moves
        shift = max(EQUILIBRIA.least_shift, step.factor * shift)
        if step.known is None:
            state.q[:] = before
            known.motion.put(dynamics, t)
        else:
            known = step.known
    raise SolverError(unbalanced(dynamics, known))


@dataclass(frozen=True)
class _Step:
    """Result of an implicit step: its balance, or None if it failed, and the factor on sqrt(s)."""

    known: Balance | None
    factor: float
    moves: int


def _step(dynamics: Dynamics, t: float, shift: float, known: Balance) -> _Step:
    """Take an implicit step from the current pose and motion; the pose is left where the step ended."""
    system, state = dynamics.system, dynamics.state
    of_states = np.maximum(system.state_scales, np.abs(state.q[system.first_state :]))
    of_speeds = np.zeros(0) if known.speeds is None else EQUILIBRIA.translation * known.speeds.sizes
    limits = np.concatenate(
        [system.per_velocity(EQUILIBRIA.translation * system.size, EQUILIBRIA.rotation), of_states, of_speeds]
    )
    start, first, n, before = state.q.copy(), 0.0, len(known.left), known.largest
    faster = np.zeros(len(of_speeds))
    for count in range(1, EQUILIBRIA.most_corrections + 1):
        whole = np.append(displacement(system, start, state.q), faster)
        move = newton_move(dynamics, shift, known, whole)
        if (
            count == 1 and not system.states and not known.left @ np.nan_to_num(move[:n], posinf=FAR, neginf=-FAR) >= 0
        ):  # towards an unstable equilibrium
            break
        longest, longest_of_all = (
            float(np.max(np.abs(displacement) / limits, initial=0.0)) for displacement in (move, whole + move)
        )
        if longest_of_all > 1.0:
            return _Step(None, max(2.0, float(np.sqrt(longest_of_all))), count)
        if count > 1 and longest > EQUILIBRIA.diverging_move * longest_of_all:
            break
        found = moved_on(dynamics, t, known, state.q, move)
        if found is None:
            break
        known, first, faster = found, first or longest, faster + move[n:]
        ends = known.balanced or (count > 1 and longest <= EQUILIBRIA.last_move * longest_of_all)
        if ends and _passes_a_pole(
            dynamics, t, start, displacement(system, start, state.q), max(before, known.largest)
        ):
            break
        if known.balanced:
            return _Step(known, 1.0, count)
        if ends:
            ratio = (longest / first) ** (1 / (count - 1))
            factor = np.sqrt(
                np.clip(max(ratio / EQUILIBRIA.wanted_ratio, longest_of_all), EQUILIBRIA.shift_falls**2, 1.0)
            )
            return _Step(known, float(factor), count)
    return _Step(None, EQUILIBRIA.shift_rises, count)


def moved_on(dynamics: Dynamics, t: float, known: Balance, q: np.ndarray, move: np.ndarray) -> Balance | None:
    """Return the balance after a move of pose and unknown speeds, or None if the pose cannot be assembled."""
    n, before = len(known.left), q.copy()
    dynamics.state.q[:] = moved(dynamics.system, q, move[:n])
    if dynamics.assemble(t) < 0:
        return None
    off = known.strayed + strayed(dynamics, t, before)
    found = balance_at(dynamics, t, known.motion.faster(move[n:]) if known.speeds else known.motion)
    return replace(found, strayed=off)


def newton_move(dynamics: Dynamics, shift: float, known: Balance, whole: np.ndarray) -> np.ndarray:
    """Return Newton's move in a step with the displacement `whole` so far; `shift` is sqrt(s), speeds come last."""
    system, jacobian, n = dynamics.system, known.jacobian, len(known.left)
    inertia = diagonal(system, np.append(shift**2 * system.mass, np.where(system.algebraic, 0.0, shift)))
    if system.states:
        n_u, n_states = system.n_u, len(system.states)
        inertia = inertia - shift * joined(
            [
                [zeros(system, n_u, n_u), zeros(system, n_u, n_states)],
                [known.dragged, zeros(system, n_states, n_states)],
            ]
        )
    changes, rows = inertia + known.stiffness, jacobian.shape[0]
    right = known.left - inertia @ whole[:n]
    if known.speeds is None:
        matrix = joined([[changes, known.reactions], [jacobian, zeros(system, rows, rows)]])
    else:
        momentum = shift * known.speeds.momentum
        right -= momentum @ whole[n:]
        matrix = joined(
            [
                [changes, known.reactions, known.speeds.effect + momentum],
                [jacobian, None, None],
                [known.speeds.held, None, np.zeros((len(whole) - n,) * 2)],
            ]
        )
    right = np.concatenate([right, -known.strayed, np.zeros(len(whole) - n)])
    found = solution(dynamics, matrix, right, n)
    if found is None:  # a larger shift is needed
        return np.full(len(whole), np.inf)
    return np.append(found[:n], found[n + rows :])


def _polished(dynamics: Dynamics, t: float, known: Balance) -> tuple[Balance, int]:
    """Apply Newton's moves to a balanced pose while the residual decreases; return the balance and their number.

    The first moves may increase the residual, as where a stiff body rotates about a soft direction.
    """
    state = dynamics.state
    best, there, misses, moves = known, state.q.copy(), 0, 0
    while misses < EQUILIBRIA.most_misses and moves < EQUILIBRIA.most_corrections:
        move = newton_move(dynamics, EQUILIBRIA.least_shift, known, at_start(known))
        found = moved_on(dynamics, t, known, state.q.copy(), move) if np.all(np.isfinite(move)) else None
        if found is None:
            break
        known, moves = found, moves + 1
        if np.max(np.abs(known.left)) < EQUILIBRIA.worth_another_move * np.max(np.abs(best.left)):
            best, there, misses = known, state.q.copy(), 0
        else:
            misses += 1
    state.q[:] = there
    return best, moves


def at_start(known: Balance) -> np.ndarray:
    """Return a zero move with zero speed changes."""
    return np.zeros(len(known.left) + known.motion.n_found)


def as_equilibrium(dynamics: Dynamics, t: float, known: Balance, moves: int) -> Equilibrium:
    """Return the current pose, which is balanced, with the velocities of the motion."""
    motion = known.motion
    motion.put(dynamics, t)
    q, u = dynamics.state.q.copy(), dynamics.state.u.copy()
    return Equilibrium(q, u, motion.acceleration(dynamics), known.lam, moves, known.imbalance, motion)


def unbalanced(dynamics: Dynamics, known: Balance) -> str:
    """Return a message on the missing equilibrium, with the body that has the largest imbalance."""
    system = dynamics.system
    if known.at_a_pole:
        return (
            "no equilibrium was found: the derivatives of forces grow without bound where the search ended, and the forces do not "
            "balance; start nearer to the equilibrium, or check divisions in the forces and distances that become zero"
        )
    forces, rates = np.split(known.left, [system.n_u])
    if system.states and np.all(np.abs(forces) <= known.allowed[: system.n_u]):
        worst = int(np.argmax(np.abs(rates) / np.maximum(known.allowed[system.n_u :], np.finfo(float).tiny)))
        return (
            f"no equilibrium was found: the rate of the state {system.states[worst]} stays {rates[worst]:.3g} per second, "
            "expected rates that can vanish"
        )
    worst = int(np.argmax(np.abs(forces)))
    name = system.name_of(worst, system.of_body.reactions)
    return (
        f"no equilibrium was found: the largest imbalance is {name} = {forces[worst]:.3g} ("
        f"the largest force is {known.largest:.3g}); expected forces that balance every free motion"
    )


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


def _passes_a_pole(dynamics: Dynamics, t: float, start: np.ndarray, move: np.ndarray, largest: float) -> bool:
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
