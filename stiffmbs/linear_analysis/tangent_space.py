"""The linearised equations of motion of all bodies at a state, in variations of poses and velocities in ground axes.

A variation of a pose is a vector x of displacements and small rotations in ground axes, shape (n_u,); its rate is
x' = v.  In these axes the equations of a symmetric rotor have constant coefficients, whatever its spin.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..compile.quaternions import rotated
from ..compile.system import System
from ..solve.mechanics import Mechanics


@dataclass(frozen=True)
class Linearised:
    """M v' = K x + D v - B dlam, with G x = 0, H x + J v = 0 and J v' + H_x x + H_v v = 0.

    Attributes
    ----------
    mass, stiffness, damping : ndarrays, shape (n_u, n_u)
        M, K and D; K and D are derivatives of forces, so that a spring has a negative K.
    reactions : ndarray, shape (n_u, n_c)
        B: J^T less the derivative of forces that depend on multipliers.
    position : ndarray, shape (holonomic, n_u)
        G, the derivative of the constraints of positions.
    velocity, velocity_at_position : ndarrays, shape (n_c, n_u)
        J and H, the derivatives of the constraints of velocities by v and by x.
    acceleration_at_position, acceleration_at_velocity : ndarrays, shape (n_c, n_u)
        H_x and H_v, of the constraints of accelerations.
    own_axes, spin : ndarrays, shape (n_u, n_u)
        From ground axes to those that u has, and w x of every body in ground axes: the variation of u' is
        own_axes (v' - w x v).
    """

    mass: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray
    reactions: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    velocity_at_position: np.ndarray
    acceleration_at_position: np.ndarray
    acceleration_at_velocity: np.ndarray
    own_axes: np.ndarray
    spin: np.ndarray


def linearised(mechanics: Mechanics, t: float, acceleration: np.ndarray) -> Linearised:
    """The linearised equations at the state of a system.

    Parameters
    ----------
    mechanics : Mechanics
        At a state that satisfies the constraints, with the multipliers of that state.
    t : float
        s.
    acceleration : ndarray, shape (n_u,)
        u' of that state.

    Returns
    -------
    Linearised
        Of the equations that are not redundant.
    """
    system, state = mechanics.system, mechanics.state
    state.a[:] = acceleration
    state.evaluate("all_levels_tangent", t)

    def term(name: str) -> np.ndarray:
        return state.matrix("all_levels_tangent", name)

    rates = term("Z")
    q, u = system.of_body.straight(len(system.bodies))
    rates[q, u] += 1.0
    axes, spin = _axes(system, state.q), _spin(system, state.q, state.u)
    back = axes.T
    rows = system.active
    to_coordinates = rates @ back
    mass = axes @ (system.mass[:, None] * back)
    return Linearised(
        mass=mass,
        stiffness=axes @ (term("f_q") - term("G_lam")) @ to_coordinates,
        damping=axes @ term("f_u") @ back + mass @ spin,
        reactions=axes @ (term("J").T - term("f_lam"))[:, rows],
        position=(term("C_q") @ to_coordinates)[rows & system.holonomic],
        velocity=(term("J") @ back)[rows],
        velocity_at_position=(term("V_q") @ to_coordinates)[rows],
        acceleration_at_position=(term("A_q") @ to_coordinates)[rows],
        acceleration_at_velocity=-(term("gamma_u") @ back + term("J") @ back @ spin)[rows],
        own_axes=back,
        spin=spin,
    )


def _axes(system: System, q: np.ndarray) -> np.ndarray:
    """From the axes that u has to those of the ground, shape (n_u, n_u): rotations of the bodies' principal axes."""
    found = np.eye(system.n_u)
    for own, orientation in _orientations(system, q):
        found[own, own] = rotated(orientation, np.eye(3)).T
    return found


def _spin(system: System, q: np.ndarray, u: np.ndarray) -> np.ndarray:
    """w x for the angular velocity of every body in ground axes: with v = A du, A du' = v' - w x v."""
    found = np.zeros((system.n_u, system.n_u))
    for own, orientation in _orientations(system, q):
        x, y, z = rotated(orientation, u[own])
        found[own, own] = [[0, -z, y], [z, 0, -x], [-y, x, 0]]
    return found


def _orientations(system: System, q: np.ndarray) -> Iterator[tuple[slice, np.ndarray]]:
    """The places of the angular velocity, and the quaternion, of every body in space."""
    of_body = system.of_body
    for body in range(len(system.bodies) if of_body.dimensions == 3 else 0):
        orientation = q[of_body.n_q * body + of_body.linear : of_body.n_q * (body + 1)]
        first = of_body.n_u * body + of_body.linear
        yield slice(first, first + 3), orientation / np.linalg.norm(orientation)
