"""Parameters of the linear solvers of IDA."""

from __future__ import annotations

from dataclasses import dataclass

from ....tuning import tuned


@dataclass(frozen=True)
class PivotParameters:
    """Parameters of the accuracy of factors by blocks.

    Source: ``tests/solve/linear_solvers``, with scenes whose stiffnesses differ by twelve decades.
    """

    largest_residual: float = 1e-9
    """Allowed residual of a trial solution by blocks, relative to the terms of a row."""
    refinable: float = 1e-5
    """Largest residual that a refinement can correct."""
    changed: float = 8.0
    """Factor by which a pivot must differ from that of the last trial to cause another trial."""
    most_between_trials: int = 50
    """Largest number of factorisations between two trials of the fixed order. After refusals it is the number of refusals,
    if that is smaller."""


PIVOTS = tuned("pivots", PivotParameters())
