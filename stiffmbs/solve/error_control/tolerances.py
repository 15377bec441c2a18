"""Absolute tolerances of all error-controlled integrators."""

from __future__ import annotations

import numpy as np

from ...compile.equations import Equations
from ...compile.system import System
from ...dynamics.dynamics import Dynamics
from ...model.settings import RunSettings

WHICH_TURN = 1e-3
"""Absolute tolerance of the revolution counters, rad: far below the half turn that they must resolve."""


def absolute_tolerances(system: System, settings: RunSettings) -> np.ndarray:
    """Return the absolute tolerance of each coordinate, then of each velocity.

    It is `atol` if given; otherwise rtol, times the size of the mechanism for lengths if that is below 1 m.  A state
    has the tolerance of an angle times the state's scale. The result of shape (n_q + n_u,): m and rad (parts of a
    quaternion), m/s and rad/s.
    """
    sizes = min(1.0, system.size), 1.0
    tolerances = settings.rtol * np.concatenate([system.per_coordinate(*sizes), system.per_velocity(*sizes)])
    if settings.atol is not None:
        tolerances[:] = settings.atol
    tolerances[system.n_pose : system.first_state] = WHICH_TURN
    tolerances[system.first_state : system.n_q] *= system.state_scales
    return tolerances


def tolerances_of(dynamics: Dynamics, settings: RunSettings) -> np.ndarray:
    """Return the absolute tolerances of a system (`absolute_tolerances`)."""
    return absolute_tolerances(dynamics.system, settings)


def independent_tolerances(equations: Equations, settings: RunSettings) -> np.ndarray:
    """Return the absolute tolerances of the independent coordinates, then of the independent velocities."""
    n_q = equations.system.n_q
    tolerances = absolute_tolerances(equations.system, settings)
    return equations.coordinates.state(tolerances[:n_q], tolerances[n_q:])
