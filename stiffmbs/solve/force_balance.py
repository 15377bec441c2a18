"""What is left of the forces on bodies at rest, or in a steady motion, and how that changes with their pose."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import block_array, csc_array, diags_array
from scipy.sparse.linalg import splu

from ..errors import SolverError
from .dynamics import Dynamics
from .failures import FAILURES
from .steady_motion import SteadyMotion

BALANCED, ROUNDING = 1e-10, 8
"""Imbalance of forces that counts as none, relative to the largest force; roundings of the coordinates that may be left in them."""
FOLLOWED = 1e-9
"""Part of the accelerations that constraints may ask for beside those of the motion, and count as none."""


@dataclass(frozen=True)
class Balance:
    """What is known at a pose.

    Attributes
    ----------
    left : ndarray, shape (n_u,)
        What multipliers leave of the forces and of the bodies' inertia.
    lam : ndarray
    largest : float
        The largest force.
    rounding : ndarray, shape (n_u,)
        What rounding of the coordinates makes of forces.
    stiffness : sparse array, shape (n_u, n_u)
        How what is left falls with moves of the pose.
    jacobian : sparse array
        J of the equations that are not redundant.
    """

    left: np.ndarray
    lam: np.ndarray
    largest: float
    rounding: np.ndarray
    stiffness: csc_array
    jacobian: csc_array

    @property
    def imbalance(self) -> float:
        """Relative to the largest force."""
        return float(np.max(np.abs(self.left), initial=0.0) / (self.largest or 1.0))

    @property
    def balanced(self) -> bool:
        """Whether no more is left than rounding and a little of the largest force."""
        return bool(np.all(np.abs(self.left) <= np.maximum(BALANCED * self.largest, self.rounding)))


def balance_at(dynamics: Dynamics, t: float, motion: SteadyMotion) -> Balance:
    """Multipliers that balance the forces of the present pose best (in the metric of the masses), and what they leave.

    Raises
    ------
    SolverError
        Where the pose has no accelerations.
    """
    state, system = dynamics.state, dynamics.system
    motion.put(dynamics, t)
    state.count_anew(t)
    status, acceleration = dynamics.accelerate(t)
    if status < 0:
        raise SolverError(f"no equilibrium was found: {FAILURES[status]}")
    lam = state.lam[: system.n_c].copy()
    steady = motion.acceleration(dynamics)
    state.evaluate("motion", t)
    entries = state.values["motion"][system.term("motion", "f").source]
    largest = max(
        np.max(np.abs(part), initial=0.0) for part in (state.vector("motion", "f"), entries, system.mass * steady)
    )
    stiffness, jacobian = _derivatives(dynamics, t, motion, lam)
    farthest = np.max(np.abs(state.q[system.of_body.straight(len(system.bodies))[0]]), initial=system.size)
    rounding = ROUNDING * np.finfo(float).eps * (abs(stiffness) @ system.per_velocity(float(farthest), 1.0))
    left = system.mass * _beside_the_constraints(acceleration - steady, system.mass, jacobian)
    return Balance(left, lam, float(largest), rounding, stiffness, jacobian)


def _beside_the_constraints(acceleration: np.ndarray, mass: np.ndarray, jacobian: csc_array) -> np.ndarray:
    """Accelerations without those that constraints ask for, as a drive does that accelerates at the start."""
    asked = jacobian @ acceleration
    if np.all(np.abs(asked) <= FOLLOWED * (abs(jacobian) @ np.abs(acceleration))):
        return acceleration
    matrix = block_array([[diags_array(mass), jacobian.T], [jacobian, None]], format="csc")
    found: np.ndarray = splu(matrix).solve(np.concatenate([mass * acceleration, 0.0 * asked]))
    return found[: len(mass)]


def _derivatives(dynamics: Dynamics, t: float, motion: SteadyMotion, lam: np.ndarray) -> tuple[csc_array, csc_array]:
    """-f_q + d(J^T lam)/dq, with what velocities and inertia add, and J of the equations that are not redundant."""
    system, state = dynamics.system, dynamics.state
    state.lam[: system.n_c] = lam
    state.evaluate("tangent", t)
    q, u = system.of_body.straight(len(system.bodies))
    rates = sparse_term(dynamics, "Z") + csc_array((np.ones(len(q)), (q, u)), shape=(system.n_q, system.n_u))
    stiffness = (sparse_term(dynamics, "G_lam") - sparse_term(dynamics, "f_q")) @ rates
    if not motion.is_rest:
        velocity, acceleration = motion.derivatives(dynamics, t, rates)
        stiffness = stiffness - sparse_term(dynamics, "f_u") @ velocity + diags_array(system.mass) @ acceleration
    return csc_array(stiffness), sparse_term(dynamics, "J")[np.flatnonzero(system.active)]


def sparse_term(dynamics: Dynamics, name: str) -> csc_array:
    """A matrix term of the set ``tangent`` from its last evaluation."""
    system = dynamics.system
    term = system.term("tangent", name)
    shapes = {"Z": (system.n_q, system.n_u), "J": (system.n_c, system.n_u), "f_u": (system.n_u, system.n_u)}
    shape = shapes.get(name, (system.n_u, system.n_q))
    return csc_array((dynamics.state.values["tangent"][term.source], (term.row, term.column)), shape=shape)
