"""Energies along a motion."""

from __future__ import annotations

import numpy as np

from ..compile.system import System
from ..solve.storage import allocated, blocks, release


def kinetic_energy(system: System, u: np.ndarray) -> np.ndarray:
    """1/2 u^T M u at each row of velocities, J.

    Parameters
    ----------
    u : ndarray, shape (n, n_u)
    """
    energy = allocated(len(u))
    for block in blocks(len(u)):
        energy[block] = 0.5 * u[block] ** 2 @ system.mass
        release(u)
    return energy


def potential_energy(system: System, values: np.ndarray) -> np.ndarray:
    """The sum of the potentials of all forces that have one, J.

    Parameters
    ----------
    values : ndarray, shape (n, values)
        Values of the output terms, one row per instant.
    """
    energy, source = allocated(len(values)), system.term("output", "potential").source
    for block in blocks(len(values)):
        energy[block] = values[block][:, source].sum(axis=1)
        release(values)
    return energy
