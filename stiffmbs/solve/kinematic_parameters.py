"""Parameters of the solver kinematic."""

from __future__ import annotations

from dataclasses import dataclass

from ..tuning import tuned


@dataclass(frozen=True)
class KinematicParameters:
    """Parameters of the solver kinematic.

    Source: ``tests/solve/test_kinematic.py`` and ``tests/solve/test_spatial_kinematic.py``.
    """

    surprise: float = 0.05
    """Largest distance from predicted to corrected positions, as a fraction of the step's displacement."""
    change: float = 0.5
    """Largest distance from predicted to corrected velocities, as a fraction of their norm."""
    rotation: float = 2.0
    """Largest rotation of a body in one step, rad; a pose does not determine whole turns."""
    shortest: float = 1e-10
    """Shortest step, as a fraction of the duration. A shorter one that fails means that the mechanism locks."""
    most_moves: int = 12
    """Largest number of Newton moves of a step; the step is shortened beyond it."""
    place_tolerance: float = 1e-11
    """Relative tolerance of integrated positions, and absolute one, m and rad."""
    state_tolerance: float = 1e-10
    """Relative tolerance of user-defined states, and absolute tolerance in their scales."""
    evaluations: int = 5_000
    """Evaluations of the rates of states between two checks of the progress."""
    too_many: float = 3e6
    """Estimated remaining evaluations that stop the integration."""


KINEMATIC = tuned("kinematic", KinematicParameters())
