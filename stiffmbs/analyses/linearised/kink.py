"""Linearised equations on both sides of a breakpoint of forces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...dynamics.dynamics import Dynamics
from ...errors import SolverError
from ...linear_analysis.state_space import StateMatrix, state_matrix
from ...linear_analysis.tangent_space import Linearised, linearised


@dataclass(frozen=True)
class Instant:
    """Dynamics at a time, s, with accelerations; its state has q, u and lam that satisfy the constraints."""

    dynamics: Dynamics
    t: float
    acceleration: np.ndarray


class ForceJumpError(SolverError):
    """Force or rate that is discontinuous at a state."""


@dataclass(frozen=True)
class Moves:
    """Perturbations by which the equations on both sides of a state are compared."""

    # sizes, relative to the mechanism's size, rad, or these per second; a breakpoint within the wide one is near the state
    wide: float = 1e-6
    narrow: float = 1e-7
    # ratio of the change of a force to the change expected from its derivatives on both sides, above which the force is
    # discontinuous; and of the relative change of a derivative to the size of a perturbation, below which it is smooth
    steep: float = 10.0
    # relative deviation from proportionality between the changes over both perturbations that a smooth law may have
    curved: float = 0.5
    # size that counts as zero, relative to the largest force, or for entries to the largest of their kind
    rounding: float = 1e-6

    def break_between(self, wide: np.ndarray, narrow: np.ndarray) -> np.ndarray:
        """Return the entries whose changes over the two perturbations are not proportional to their sizes."""
        return np.asarray(np.abs(narrow * (self.wide / self.narrow) - wide) > self.curved * np.abs(wide))


MOVES = Moves()


@dataclass(frozen=True)
class Kink:
    """Breakpoint at a state: the velocity or state whose equation has it, such as ``b.vx``, and the equations on both sides."""

    where: str
    sides: tuple[Linearised, Linearised]


def linearised_at(
    found: Instant, scale: np.ndarray, moves: Moves = MOVES
) -> tuple[Linearised, StateMatrix, Kink | None]:
    """Return the linearised equations, those of one side on a breakpoint of a force, with that breakpoint or None.

    Raise a ForceJumpError if a force is discontinuous at the state, so that no linearisation exists.
    """
    linear = linearised(found.dynamics, found.t, found.acceleration)
    state = state_matrix(linear, scale)
    kink, side = _breakpoint(found, state, linear, scale, moves) if len(state.matrix) else (None, None)
    return (linear, state, kink) if side is None else (side, state_matrix(side, scale), kink)


def _breakpoint(
    found: Instant, state: StateMatrix, linear: Linearised, scale: np.ndarray, moves: Moves
) -> tuple[Kink | None, Linearised | None]:
    """Return the breakpoint of a force or rate at a state or None, and the equations of a side if they replace those there."""
    system = found.dynamics.system
    move = _generic_move(state, scale)
    wide, narrow = (
        [_side(found, state, linear, sign * size * move) for sign in (-1.0, 1.0)] for size in (moves.wide, moves.narrow)
    )
    names = system.names_of(range(system.n_u), system.of_body.velocities)
    states = [system.states[k] for k in np.flatnonzero(~system.without_rate)]
    rows = [*_moving(state, scale, names), *states]
    jump = np.abs(narrow[1].forces - narrow[0].forces)
    smooth = moves.steep * 2 * moves.narrow * np.maximum(narrow[0].parts, narrow[1].parts) @ np.abs(move)
    jumps = jump > smooth + moves.rounding * np.max(np.abs(narrow[0].forces), initial=0.0)
    if jumps.any():
        raise ForceJumpError(
            f"a force or rate of {rows[int(np.argmax(np.where(jumps, jump, 0.0)))]} is discontinuous at the state at t = {found.t:g} s, where "
            "no linearisation exists; expected a state away from the discontinuity, or a continuous law, such as step()"
        )
    changes = [after.matrix - before.matrix for before, after in (wide, narrow)]
    middle = _side(found, state, linear, 0 * move).matrix
    to_a_side = [np.maximum(*(abs(side.matrix - middle) for side in pair)) for pair in (wide, narrow)]
    parts = wide[0].parts
    summed = len(scale) * np.finfo(float).eps  # an entry is a sum over all velocities: Higham (2002), eq. 3.5
    curved = moves.steep * moves.wide  # relative change of a derivative over a move that a curved law may have
    # An entry that is zero at the state, of products of two small motions, changes by a part of second order of the others.
    zero = np.maximum(curved * parts, max(summed, curved * moves.wide) * _largest(parts, state))
    # At a breakpoint, changes across the state and to a side are not proportional to the move.
    bends = moves.break_between(*changes) & moves.break_between(*to_a_side) & (np.abs(changes[0]) > zero)
    # On a breakpoint the derivatives of several functions, such as max(x, 0) + min(x, 0), may add up to those of no side.
    off, off_narrow = (np.array([abs(side.matrix - middle) for side in pair]) for pair in (wide, narrow))
    apart = ((off > zero) & (off_narrow > moves.curved * off)).all(axis=0)
    side = narrow[0].linear if apart.any() else None
    if not bends.any():
        return None, side
    share = np.where(bends, np.abs(changes[0]) / np.where(bends, parts + np.abs(changes[0]), 1.0), 0.0)
    where = rows[int(np.argmax(share.max(axis=1)))]
    return Kink(where, (wide[0].linear, wide[1].linear)), side


def _largest(parts: np.ndarray, state: StateMatrix) -> np.ndarray:
    """Return the largest term of each entry's kind: of all free motions by poses, by velocities, by states; of each state's rate.

    Rounding of the largest terms appears in motions without any: the rotation of a hanging body about its spring.
    """
    found = np.repeat(parts.max(axis=1, keepdims=True), parts.shape[1], axis=1)
    free, end = state.degrees_of_freedom, state.n_poses + state.degrees_of_freedom
    for columns in (slice(0, state.n_poses), slice(state.n_poses, end), slice(end, None)):
        found[:free, columns] = np.max(parts[:free, columns], initial=0.0)
    return found


def _moving(state: StateMatrix, scale: np.ndarray, names: list[str]) -> list[str]:
    """Return the name of the largest velocity in each free velocity."""
    free = state.velocities[:, state.n_poses : state.n_poses + state.degrees_of_freedom] / scale[:, None]
    return [names[int(k)] for k in np.argmax(np.abs(free), axis=0)]


@dataclass(frozen=True)
class _Side:
    """Perturbed equations: forces and rates, their derivatives by free variations, and the sizes of their terms."""

    linear: Linearised
    forces: np.ndarray
    matrix: np.ndarray
    parts: np.ndarray


def _generic_move(state: StateMatrix, scale: np.ndarray) -> np.ndarray:
    """Return a combination of all variations, of size 1."""
    rng = np.random.default_rng(1)
    n = len(state.matrix)
    sizes = np.abs(np.vstack([state.poses / scale[:, None], state.velocities / scale[:, None]])).max(axis=0)
    sizes[n - state.n_states :] = 1.0
    return rng.choice((-1.0, 1.0), n) * rng.uniform(0.5, 1.0, n) / np.maximum(sizes, 1.0)


def _side(found: Instant, state: StateMatrix, linear: Linearised, z: np.ndarray) -> _Side:
    """Return the perturbed equations, with the multipliers and accelerations of the state."""
    dynamics, at, system = found.dynamics, found.dynamics.state, found.dynamics.system
    own = linear.algebraic.among_all(z[len(z) - state.n_states :, None])[:, 0]
    with at.unchanged():
        at.q[:] = system.of_body.moved(at.q, linear.own_axes @ (state.poses @ z))
        at.q[system.first_state :] += own * system.state_scales
        at.u[:] += linear.own_axes @ (state.velocities @ z)
        there = linearised(dynamics, found.t, found.acceleration)
        at.evaluate("motion", found.t)
        force, rate = (
            at.vector("motion", "f").copy(),
            at.vector("motion", "rate")[system.first_state :][~system.without_rate],
        )
    free = state.velocities[:, state.n_poses : state.n_poses + state.degrees_of_freedom]
    s = np.eye(len(z))[len(z) - state.n_states :]
    forced = (
        (there.stiffness, there.damping, there.by_states),
        (there.rate_by_pose, there.rate_by_velocity, there.rate_by_states),
    )
    variations = state.poses, state.velocities, s
    acting, rates = (sum(part @ of for part, of in zip(parts, variations, strict=True)) for parts in forced)
    sizes, of_rates = (
        sum(np.abs(part) @ np.abs(of) for part, of in zip(parts, variations, strict=True)) for parts in forced
    )
    sizes = sizes + np.abs((there.mass @ there.spin).toarray()) @ np.abs(
        state.velocities
    )  # cancels parts of the damping
    matrix, parts = np.vstack([free.T @ acting, rates]), np.vstack([np.abs(free.T) @ sizes, of_rates])
    return _Side(there, np.append(free.T @ (linear.own_axes.T @ force), rate), matrix, parts)
