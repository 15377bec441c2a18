"""The spectrum of a scene linearised at a state: its free vibrations within the constraints."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .mechanics import Mechanics

NEGLIGIBLE = 1e-5
"""Part of the largest eigenvalue below which another counts as a rigid motion (a double zero is found to the square
root of the rounding)."""


@dataclass(frozen=True)
class Spectrum:
    """Eigenvalues of the motion within the constraints.

    Attributes
    ----------
    eigenvalues : ndarray of complex, shape (2 * freedoms,)
        1/s; those of rigid motions are zero.
    """

    eigenvalues: np.ndarray

    @property
    def fastest(self) -> float:
        """The largest magnitude, 1/s."""
        return float(np.max(np.abs(self.eigenvalues), initial=0.0))

    @property
    def slowest(self) -> float:
        """The smallest magnitude that is not that of a rigid motion, 1/s; 0 where there is none."""
        sizes = np.abs(self.eigenvalues)
        moving = sizes[sizes > NEGLIGIBLE * self.fastest]
        return float(moving.min()) if len(moving) else 0.0

    @property
    def damping(self) -> float:
        """Damping ratio of the fastest vibration: 1 and more for one that does not ring."""
        if self.fastest == 0.0:
            return 0.0
        fastest = self.eigenvalues[np.argmax(np.abs(self.eigenvalues))]
        return float(-fastest.real / abs(fastest))


def spectrum(mechanics: Mechanics, t: float) -> Spectrum:
    """Linearise a scene at its current state and multipliers.

    With N a basis of the null space of J: N^T M N s'' - N^T f_u N s' + N^T (d(J^T lam)/dq - f_q) N s = 0, terms of
    the basis' own change left out.  Shabana, Dynamics of Multibody Systems (2013), section 3.8.
    """
    state, system = mechanics.state, mechanics.system
    state.evaluate("tangent", t)
    J = state.matrix("tangent", "J")[system.active]
    directions = np.eye(system.n_u)
    if len(J):
        _, singular, rows = np.linalg.svd(J)
        rank = int(np.sum(singular > 1e-10 * singular[0])) if len(singular) else 0
        directions = rows[rank:].T
    freedoms = directions.shape[1]
    if freedoms == 0:
        return Spectrum(np.empty(0, dtype=complex))
    mass = directions.T * system.mass @ directions
    stiffness = directions.T @ (state.matrix("tangent", "G_lam") - state.matrix("tangent", "f_q")) @ directions
    damping = -directions.T @ state.matrix("tangent", "f_u") @ directions
    zero, one = np.zeros((freedoms, freedoms)), np.eye(freedoms)
    first_order = np.block([[zero, one], [-np.linalg.solve(mass, stiffness), -np.linalg.solve(mass, damping)]])
    return Spectrum(np.linalg.eigvals(first_order))
