"""Parameters of Newton's iteration and of error estimates."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from ....tuning import tuned


@dataclass(frozen=True)
class NewtonParameters:
    """Parameters of Newton's iteration of bdf.

    Source: IDA's own values where noted, otherwise the benchmarks (``python -m tests.bench``) and ``docs/error_control.md``.
    """

    loosest: float = 0.03
    """Largest part of the error tolerance that the iteration may leave; IDA's own is 0.33."""
    negligible: float = 1e-6
    """Negligible part of the error tolerance: bdf requires no smaller corrections, as these fail where the constraints are nearly
    dependent, and such a correction ends the iteration of radau without a rate of convergence."""
    soft: float = 1.5e4
    """Squared fastest rate, 1/s^2, times the part of the tolerance that may be left. A position error makes a force,
    and thereby a velocity error that has to stay below the tolerance too."""
    precision: float = 1e-13
    """Least relative change of a coordinate that the iteration can resolve with an ill-conditioned matrix."""
    unknown: float = 20.0
    """Largest error after a correction, relative to it, as in IDA with a new matrix."""
    diverging: float = 0.9
    """Rate above which the iteration is stopped, as in IDA."""
    slowest: float = 0.1
    """Rate above which a matrix is replaced."""
    trusted: int = 20
    """Number of nonlinear solves after which a rate is measured again, and least number of steps with which failures are compared."""
    least: float = 0.1
    """Least fraction of a measured rate that is attributed to the age of the matrix."""
    last: int = 3
    """Largest number of corrections before the last one."""
    long_steps: float = 200.0
    """cj, 1/s, up to which steps are long."""
    many_failures: float = 0.2
    """Fraction of steps with a failed iteration above which its tolerance is relaxed."""
    eased: float = 100.0
    """Factor of that relaxation."""
    easiest: float = 0.33
    """Upper bound of the relaxed tolerance, as in IDA."""


NEWTON = tuned("newton", NewtonParameters())


@dataclass(frozen=True)
class PolishingParameters:
    """Parameters of the polished dense output.

    Source: the stiff benchmarks and ``docs/error_control.md``.
    """

    amplified: float = 30.0
    """Ratio of forces by an error between steps to forces by its rates in a step, above which states are corrected."""
    unbalanced: float = 0.3
    """Allowed imbalance of the forces on a body between steps, relative to the largest force and to rtol."""
    most_corrections: int = 8
    """Largest number of corrections of a state, of radau too."""
    most_moved: float = 30.0
    """Largest move of a state within a step by corrections, in tolerances, of radau too; farther away are other solutions."""
    slowest: float = 0.3
    """Ratio of successive corrections above which factors are replaced, or the iteration fails."""
    rounded_off: float = 1e-2
    """Imbalance, relative to the largest force, that counts as rounding of coordinates if corrections become no smaller."""
    at_events: float = 100.0
    """Step relative to that of the last matrix that corrects a state at an event; for the first matrix, its square. The
    state moves in stiff directions only, not to the other side of the event."""


POLISHING = tuned("polishing", PolishingParameters())


EXCLUDED: Final = 1e60
"""Absolute tolerance that marks an unknown as excluded from error tests: beyond any force, with a square that is finite."""
A_STABLE_ORDER: Final = 2
"""Highest A-stable order of BDF (Dahlquist's second barrier)."""
EQUAL_STEPS: Final = 3
"""Equal steps at order 1 before IDA may raise it: at order k, IDA requires k + 2 steps of equal size and order."""


@dataclass(frozen=True)
class ErrorFilterParameters:
    """Parameters of the filtered norm of error estimates.

    Source: stress tests with light bodies in strong dampers.
    """

    fades_low: float = 0.99
    """Factor of the failure count in each step, at A-stable orders."""
    fades: float = 0.8
    """The same at higher orders."""
    troubled: float = 7.0
    """Failure count above which estimates are filtered."""
    lasts: int = 1000
    """Number of steps for which they are."""
    no_estimate: float = 1e12
    """Filtered norm above which a vector is not an error estimate: IDA also uses the norm for a rounding test."""


FILTER = tuned("error_filter", ErrorFilterParameters())
