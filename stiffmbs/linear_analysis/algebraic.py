"""Elimination of algebraic states from linearised equations: 0 = Z_x x + Z_v v + Z_s s + Z_l dlam + Z dz."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ..errors import SolverError

if TYPE_CHECKING:
    from .tangent_space import Linearised

SINGULAR = 1e15
"""Condition number of a matrix with normalised rows from which on it is singular."""


@dataclass(frozen=True)
class Algebraic:
    """Variations of algebraic states and their effects.

    Attributes
    ----------
    is_algebraic : ndarray of bool, shape (states,)
    inverse : ndarray, shape (algebraic, algebraic)
        Z^-1.
    on_forces, on_rates : ndarrays, shapes (n_u, algebraic), (others, algebraic)
        Derivatives of the forces, and of the rates of the other states.
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

    Raises
    ------
    SolverError
        When they have no unique values.
    """
    own = rate_by_states[np.ix_(is_algebraic, is_algebraic)]
    sizes = np.linalg.norm(own, axis=1)[:, None]
    if own.size and not (np.all(sizes > 0) and np.linalg.cond(own / sizes) < SINGULAR):
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
