"""Poses near which the constraints are not linear in displacements as large as those of errors."""

from __future__ import annotations

import numpy as np

from ..dynamics.dynamics import Dynamics
from ..errors import SolverError
from .parameters import ESTIMATE


def refuse_singular(dynamics: Dynamics, t: np.ndarray, q: np.ndarray, u: np.ndarray) -> None:
    """Raise a SolverError if some of the states are so near to a singular pose that errors are not transported through it."""
    found = nearly_singular(dynamics, t, q, u)
    if found.any():
        raise SolverError(
            f"no linear equations transport errors through the nearly singular pose at t = {t[np.argmax(found)]:.4g} s"
        )


def nearly_singular(dynamics: Dynamics, t: np.ndarray, q: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Return a mask of the states so near to a singular pose that displacements on the constraints are not linear there.

    At a distance d, as a part of the usual one, their nonlinearity is `ESTIMATE.difference` / d^2.
    """
    system = dynamics.system
    J, matrices = system.term("motion", "J"), np.zeros((len(t), system.n_c, system.n_u))
    values = dynamics.state.values_at("motion", J.source, t, q, u)
    np.add.at(matrices.transpose(1, 2, 0), (J.row, J.column), values.T)
    matrices = (matrices * system.per_velocity(system.size, 1.0))[:, system.active]
    if not 0 < matrices.shape[1] < matrices.shape[2]:
        return np.zeros(len(t), dtype=bool)
    sizes = np.linalg.norm(matrices, axis=2, keepdims=True).max(axis=0)  # a row may vanish in the pose itself
    r = np.linalg.qr((matrices / np.where(sizes > 0, sizes, 1.0)).transpose(0, 2, 1), mode="r")
    least = np.abs(np.diagonal(r, axis1=1, axis2=2)).min(axis=1)
    return np.asarray(ESTIMATE.difference > ESTIMATE.large * (least / least.max()) ** 2)
