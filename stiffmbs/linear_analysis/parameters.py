"""Parameters of linear analysis."""

from __future__ import annotations

from dataclasses import dataclass

from ..tuning import tuned


@dataclass(frozen=True)
class LinearAnalysisParameters:
    """Parameters of state matrices, modes, and the stability of equilibria.

    Source: tests/linear_analysis.
    """

    close: float = 1e-6
    """Relative difference up to which quantities of linearised equations are equal."""
    no_motion: float = 1e-12
    """Displacement, in sizes of the mechanism, or rotation of a normalised eigenvector that counts as zero."""
    dependent: float = 1e-9
    """Pivot, relative to the largest, below which an equation is dependent at a pose."""
    singular: float = 1e15
    """Condition number of a matrix with normalised rows from which on it is singular."""
    imbalance: float = 100.0
    """Factor on the w^2 that the residual of the forces could cause."""
    least_shift: float = 1e-14
    """Smallest shift of Arnoldi's iteration, relative to the largest w^2 of a single body."""
    most_free: int = 6
    """Number of motions at the last shift."""
    most_restarts: int = 5
    """Largest number of restarts at a shift."""
    accuracy: float = 1e-3
    """Relative accuracy of the iteration."""
    own: float = 0.05
    """Smallest magnitude of a negative w^2 that is accepted at a shift, relative to it."""


LINEAR_ANALYSIS = tuned("linear_analysis", LinearAnalysisParameters())
