"""Parameters of the stages of variational equations."""

from __future__ import annotations

from dataclasses import dataclass

from ...tuning import tuned


@dataclass(frozen=True)
class StagesParameters:
    """Parameters of the iteration for the stages of variational equations.

    Source: processor times of estimates of the errors of examples (andrews, car, chain, governor, half_car).
    """

    fast: float = 0.4
    """Mean ratio of two successive corrections up to which factors of earlier steps serve: one may move the residual to other
    directions."""
    most_corrections: int = 80
    """Number of corrections after which the matrix of all stages is factored."""


ITERATION = tuned("variational_stages", StagesParameters())
