"""Linearised equations of motion of all bodies at a state, in variations of poses and velocities in ground axes.

A variation of a pose is a vector x of displacements and small rotations in ground axes, shape (n_u,); its rate is x' =
v. In these axes the equations of a symmetric rotor have constant coefficients at any spin.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csr_array, diags_array

from ..compile.quaternions import rotated
from ..compile.system import System
from ..dynamics.dynamics import Dynamics
from ..errors import SolverError
from .parameters import LINEAR_ANALYSIS


@dataclass(frozen=True)
class Algebraic:
    """Variations of algebraic states and their effects.

    `is_algebraic` of shape (states,). `inverse` of shape (algebraic, algebraic): Z^-1. `on_forces`, `on_rates` of
    shapes (n_u, algebraic), (others, algebraic): derivatives of the forces, and of the rates of the other states.
    """

    is_algebraic: np.ndarray
    inverse: np.ndarray
    on_forces: np.ndarray
    on_rates: np.ndarray

    def passed_on(self, forces: np.ndarray, rates: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the forces, and rates of the other states, due to an input on forces and equations of all states."""
        follow = -self.inverse @ rates[self.is_algebraic]
        return forces + self.on_forces @ follow, rates[~self.is_algebraic] + self.on_rates @ follow

    def among_all(self, others: np.ndarray) -> np.ndarray:
        """Return rows of the other states among those of all states, with zeros for algebraic ones."""
        rows = np.zeros((len(self.is_algebraic), others.shape[1]))
        rows[~self.is_algebraic] = others
        return rows


def algebraic_of(is_algebraic: np.ndarray, by_states: np.ndarray, rate_by_states: np.ndarray) -> Algebraic:
    """Return the elimination of algebraic states, from the derivatives of forces and rates by all states.

    Raises SolverError when they have no unique values.
    """
    own = rate_by_states[np.ix_(is_algebraic, is_algebraic)]
    sizes = np.linalg.norm(own, axis=1)[:, None]
    if own.size and not (np.all(sizes > 0) and np.linalg.cond(own / sizes) < LINEAR_ANALYSIS.singular):
        raise SolverError(
            "the algebraic states have no unique values near this state, expected formulas that change with them"
        )
    return Algebraic(
        is_algebraic,
        np.linalg.inv(own),
        by_states[:, is_algebraic],
        rate_by_states[np.ix_(~is_algebraic, is_algebraic)],
    )


def without_algebraic(linear: Linearised) -> Linearised:
    """Return the linearised equations in the other states only."""
    of = linear.algebraic
    own, others = of.is_algebraic, ~of.is_algebraic
    if not own.any():
        return linear
    x, v, s, lam = (
        -of.inverse @ part[own]
        for part in (
            linear.rate_by_pose,
            linear.rate_by_velocity,
            linear.rate_by_states[:, others],
            linear.rate_by_reactions,
        )
    )
    return replace(
        linear,
        stiffness=linear.stiffness + of.on_forces @ x,
        damping=linear.damping + of.on_forces @ v,
        reactions=linear.reactions - of.on_forces @ lam,
        by_states=linear.by_states[:, others] + of.on_forces @ s,
        position_by_states=linear.position_by_states[:, others],  # algebraic states are in no constraint
        velocity_by_states=linear.velocity_by_states[:, others],
        acceleration_by_states=linear.acceleration_by_states[:, others],
        rate_by_pose=linear.rate_by_pose[others] + of.on_rates @ x,
        rate_by_velocity=linear.rate_by_velocity[others] + of.on_rates @ v,
        rate_by_states=linear.rate_by_states[np.ix_(others, others)] + of.on_rates @ s,
        rate_by_reactions=linear.rate_by_reactions[others] + of.on_rates @ lam,
    )


@dataclass(frozen=True)
class Linearised:
    """Linearised equations in variations x, v and s of poses, velocities and user-defined differential states.

    M v' = K x + D v + F s - B dlam; s' = R_x x + R_v v + R_s s + R_lam dlam; G x + G_s s = 0; H x + J v + H_s s = 0;
    J v' + H_x x + H_v v + A_s s = 0. Algebraic states are eliminated.

    - `mass` of shape (n_u, n_u): M.
    - `stiffness`, `damping` of shape (n_u, n_u): k and D, derivatives of forces, so that a spring has a negative K.
    - `reactions` of shape (n_u, n_c): B: J^T minus the derivative of forces by multipliers.
    - `position` of shape (holonomic, n_u): G, the derivative of the position constraints.
    - `velocity`, `velocity_at_position` of shape (n_c, n_u): J and H, the derivatives of the velocity constraints by v
      and x.
    - `acceleration_at_position`, `acceleration_at_velocity` of shape (n_c, n_u): H_x and H_v, of the acceleration
      constraints.
    - `by_states` of shape (n_u, states): F.
    - `position_by_states`, `velocity_by_states`, `acceleration_by_states` of shapes (holonomic or n_c, states): G_s,
      H_s and A_s.
    - `rate_by_pose`, `rate_by_velocity`, `rate_by_states`, `rate_by_reactions` of shapes (states, n_u, states or n_c):
      R_x, R_v, R_s and R_lam.
    - `own_axes`, `spin` of shape (n_u, n_u): transformation from ground axes to those of u, and w x of every body in
      ground axes: the variation of u' is own_axes (v' - w x v).
    - `algebraic`: elimination of algebraic states, and of sampled ones, which are constant.
    """

    mass: csr_array
    stiffness: np.ndarray
    damping: np.ndarray
    reactions: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    velocity_at_position: np.ndarray
    acceleration_at_position: np.ndarray
    acceleration_at_velocity: np.ndarray
    by_states: np.ndarray
    position_by_states: np.ndarray
    velocity_by_states: np.ndarray
    acceleration_by_states: np.ndarray
    rate_by_pose: np.ndarray
    rate_by_velocity: np.ndarray
    rate_by_states: np.ndarray
    rate_by_reactions: np.ndarray
    own_axes: csr_array
    spin: csr_array
    algebraic: Algebraic


def linearised(dynamics: Dynamics, t: float, acceleration: np.ndarray) -> Linearised:
    """Return the linearised equations at the state of a system.

    `dynamics`: at a state that satisfies the constraints, with its multipliers. `t`: s. `acceleration` of shape
    (n_u,): u' of that state. Returns of the equations that are not redundant.
    """
    system, state = dynamics.system, dynamics.state
    state.a[:] = acceleration
    state.evaluate("all_levels_tangent", t)

    def term(name: str) -> np.ndarray:
        return state.matrix("all_levels_tangent", name)

    rates = term("Z")
    q, u = system.straight
    rates[q, u] += 1.0
    axes, spin = _axes(system, state.q), _spin(system, state.q, state.u)
    back = axes.T
    rows = system.active
    to_coordinates = rates @ back
    mass = axes @ (diags_array(system.mass) + csr_array(term("inertia"))) @ back
    own = slice(system.first_state, None)
    by_states, rate_by_states = axes @ (term("f_q") - term("G_lam"))[:, own], term("rate_q")[own, own]
    rate_by_states[system.sampled, system.sampled] = 1.0  # sampled states are constant: 0 = dx
    linear = Linearised(
        mass=mass,
        stiffness=axes @ (term("f_q") - term("G_lam") - term("inertia_q")) @ to_coordinates,
        damping=axes @ term("f_u") @ back + mass @ spin,
        reactions=axes @ (term("J").T - term("f_lam"))[:, rows],
        position=(term("C_q") @ to_coordinates)[rows & system.holonomic],
        velocity=(term("J") @ back)[rows],
        velocity_at_position=(term("V_q") @ to_coordinates)[rows],
        acceleration_at_position=(term("A_q") @ to_coordinates)[rows],
        acceleration_at_velocity=-(term("gamma_u") @ back + term("J") @ back @ spin)[rows],
        by_states=by_states,
        position_by_states=term("C_x")[rows & system.holonomic][:, own],
        velocity_by_states=term("V_q")[rows][:, own],
        acceleration_by_states=term("A_q")[rows][:, own],
        rate_by_pose=term("rate_q")[own] @ to_coordinates,
        rate_by_velocity=term("rate_u")[own] @ back,
        rate_by_states=rate_by_states,
        rate_by_reactions=term("rate_lam")[own, rows],
        own_axes=back,
        spin=spin,
        algebraic=algebraic_of(system.without_rate, by_states, rate_by_states),
    )
    return without_algebraic(linear)


def _axes(system: System, q: np.ndarray) -> csr_array:
    """Return the transformation from the axes of u to ground axes, shape (n_u, n_u)."""
    blocks = {own.start: rotated(orientation, np.eye(3)).T for own, orientation in _orientations(system, q)}
    return _block_diagonal(system, blocks, 1.0)


def _spin(system: System, q: np.ndarray, u: np.ndarray) -> csr_array:
    """Return w x for the angular velocity of every body in ground axes: with v = A du, A du' = v' - w x v."""
    blocks = {}
    for own, orientation in _orientations(system, q):
        x, y, z = rotated(orientation, u[own])
        blocks[own.start] = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return _block_diagonal(system, blocks, 0.0)


def _block_diagonal(system: System, blocks: dict[int, np.ndarray], elsewhere: float) -> csr_array:
    """Return a block diagonal matrix of blocks by their first row, with a constant on the rest of the diagonal."""
    at = np.array(list(blocks), dtype=int).reshape(-1, 1, 1)
    row, column = np.broadcast_arrays(at + np.arange(3)[:, None], at + np.arange(3))
    straight = np.setdiff1d(np.arange(system.n_u), row)
    values = np.concatenate([np.array([*blocks.values()]).ravel(), np.full(len(straight), elsewhere)])
    places = np.concatenate([row.ravel(), straight]), np.concatenate([column.ravel(), straight])
    return csr_array((values, places), shape=(system.n_u, system.n_u))


def _orientations(system: System, q: np.ndarray) -> Iterator[tuple[slice, np.ndarray]]:
    """Yield the slice of the angular velocity, and the quaternion, of every body in space."""
    of_body = system.of_body
    for body in range(len(system.bodies) if of_body.dimensions == 3 else 0):
        orientation = q[of_body.n_q * body + of_body.linear : of_body.n_q * (body + 1)]
        first = of_body.n_u * body + of_body.linear
        yield slice(first, first + 3), orientation / np.linalg.norm(orientation)
