"""Solutions with the mass matrix of joint coordinates."""

from __future__ import annotations

from typing import Final

import numpy as np

from ...errors import SolverError

NO_MASS: Final = 1e-7
"""Smallest pivot of the Cholesky factor of a mass matrix scaled to a unit diagonal, below which a motion has no mass: the root of rounding."""


def solved(M: np.ndarray, right: np.ndarray, names: tuple[str, ...]) -> np.ndarray:
    """Return M^-1 times a vector or matrix; raise a SolverError if a motion has no mass."""
    scale = 1.0 / np.sqrt(np.maximum(M.diagonal(), np.finfo(float).tiny))
    scaled = scale[:, None] * M * scale
    try:
        least = np.linalg.cholesky(scaled).diagonal().min(initial=1.0)
    except np.linalg.LinAlgError:
        least = 0.0
    if least <= NO_MASS:
        k = int(np.argmax(np.abs(np.linalg.eigh(scaled)[1][:, 0])))
        raise SolverError(f"forward_dynamics: the motion along {names[k]} has no mass, expected mass or inertia in it")
    across = scale if right.ndim == 1 else scale[:, None]
    found: np.ndarray = across * np.linalg.solve(scaled, across * right)
    return found
