"""Parameters of the Radau methods."""

from __future__ import annotations

from dataclasses import dataclass

from ...tuning import tuned


@dataclass(frozen=True)
class RadauParameters:
    """Parameters of step size, number of stages and Newton's iteration; after the code RADAU of Hairer and Wanner.

    - `tolerance`: factor c of the tolerance c rtol^((s + 1)/(2 s)) of the error estimate, whose order is s instead of 2
      s - 1.
    - `least_factor`, `largest_factor`: bounds of the ratio of successive steps; the first is the factor of a first step
      after a failed error test too.
    - `keep_matrix`: convergence rate of Newton's iteration below which the matrices are kept for the next step, if they
      cost as much as an iteration; in proportion to their cost otherwise.
    - `keep_high`: ratio of successive steps below which the step and the factors stay unchanged.
    - `stages_after`: steps after which the number of stages is chosen again.
    - `gain`: ratio of costs per time below which another number of stages is chosen.
    - `solution_cost`: cost of the solutions of an iteration, in those of the matrices of a step.
    - `slowest`: convergence rate of Newton's iteration that the next step may have.
    - `converging`: ratio of successive Chebyshev coefficients of a step's polynomial above which the error estimate has
      no order, and its tolerance is the requested one.
    - `after_failure`: factor of the step after a failed iteration.
    - `remainder`: largest part of the error tolerance that Newton's iteration may leave; in motions that are not stiff,
      the method's own error is far smaller.
    """

    tolerance: float = 0.01
    least_factor: float = 0.125
    largest_factor: float = 5.0
    keep_matrix: float = 5e-3
    keep_high: float = 1.5
    stages_after: int = 4
    gain: float = 0.8
    solution_cost: float = 0.1
    slowest: float = 0.3
    converging: float = 0.25
    after_failure: float = 0.5
    remainder: float = 0.003


RADAU = tuned("radau", RadauParameters())
"""Parameters of every run."""
