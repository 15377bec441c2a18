"""What steps of the explicit and of the implicit integrator cost, for the choice between them.

Microseconds on one machine, as ``python -m stiffmbs.bench.costs`` measures them; their ratios alone are used.  They are
no clock, so that a scene is solved the same way each time.
"""

from __future__ import annotations

from .dynamics import Dynamics

EXPLICIT_STEP = (0.96, 0.061)
"""Of order 8, with 12 accelerations: for itself, and for a value of the kernels of accelerations."""
BY_LU = 2.8
"""Times as long where accelerations are not found by elimination (measured on stick_slip, with friction to iterate)."""
RESIDUAL, MATRIX = (0.12, 0.0213), (0.0, 0.0138)
"""Of BDF, with what else a step consists of: for itself, and for an unknown."""
RESIDUALS, MATRICES = 1.5, 0.2
"""Of a step of BDF on average."""
START = 250.0
"""Consistent values and the integrators' memory, when a run switches integrator."""
STEPS_OF_A_START = 40
"""Of BDF, from order 1 on to where its own steps are."""


def of_explicit_step(dynamics: Dynamics) -> float:
    """A step of DOP853."""
    itself, value = EXPLICIT_STEP
    by_elimination = itself + value * dynamics.system.n_values("acceleration")
    return by_elimination if dynamics.eliminated.serves else BY_LU * by_elimination


def unknowns(dynamics: Dynamics) -> int:
    """Of the implicit integrator: coordinates, velocities, and multipliers for both."""
    coordinates = dynamics.coordinates
    solved_for = dynamics.system.active & ~coordinates.satisfied
    free = coordinates.independent.sum() + coordinates.independent_u.sum()
    return int(free) + 2 * int(solved_for.sum())


def of_implicit_work(n: int, residuals: float, matrices: float) -> float:
    """So many residuals and iteration matrices with n unknowns."""
    return residuals * (RESIDUAL[0] + RESIDUAL[1] * n) + matrices * (MATRIX[0] + MATRIX[1] * n)


def of_implicit_step(n: int) -> float:
    """A step of BDF, as they are on average."""
    return of_implicit_work(n, RESIDUALS, MATRICES)


def of_implicit_start(n: int) -> float:
    """A start of BDF."""
    return START + STEPS_OF_A_START * of_implicit_step(n)
