"""Energies along a motion."""

from __future__ import annotations

import numpy as np

from ..compile.system import System


def kinetic_energy(system: System, u: np.ndarray) -> np.ndarray:
    """1/2 u^T M u at each row of velocities, J.

    Parameters
    ----------
    u : ndarray, shape (n, n_u)
    """
    return 0.5 * (u * u) @ system.mass


def potential_energy(system: System, values: np.ndarray) -> np.ndarray:
    """The sum of the potentials of all forces that have one, J.

    Parameters
    ----------
    values : ndarray, shape (n, values)
        Values of the output terms, one row per instant.
    """
    return values[:, system.term("output", "potential").source].sum(axis=1)
