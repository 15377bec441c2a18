"""The absolute tolerances of all error-controlled integrators."""

from __future__ import annotations

import numpy as np

from ..compile.system import PLANAR, System
from ..describe.settings import RunSettings


def absolute_tolerances(system: System, settings: RunSettings) -> np.ndarray:
    """The absolute tolerance of each coordinate, and of its velocity.

    As given, or rtol for angles and for mechanisms of 1 m and more, and shrinking with smaller ones.

    Returns
    -------
    ndarray, shape (n_q,)
        m and rad (m/s and rad/s).
    """
    if settings.atol is not None:
        return np.full(system.n_q, settings.atol)
    length = min(1.0, system.size)
    return settings.rtol * np.tile([length, length, 1.0], system.n_q // PLANAR)
