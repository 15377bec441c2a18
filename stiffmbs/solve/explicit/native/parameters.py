"""Parameters of explicit integrators."""

from __future__ import annotations

from dataclasses import dataclass

from ....tuning import tuned


@dataclass(frozen=True)
class StepControlParameters:
    """Parameters of the step size of explicit integrators.

    Source: DOPRI5 and DOP853 (Hairer, Norsett, Wanner I, ch. II.4 and II.5) where noted, otherwise the benchmarks.
    """

    safety: float = 0.9
    """Safety factor of the step size, as in DOPRI5."""
    least_factor: float = 0.2
    """Least ratio of successive steps, and factor of the step after an attempt without a result."""
    largest_factor: float = 10.0
    """Largest ratio of successive steps."""
    smallest_error: float = 1e-4
    """Smallest previous error in the PI step control, as in DOPRI5."""
    far_beyond: float = 2.0
    """Multiple of the stability limit above which rounding grows before the error estimate detects it; steps that the
    estimate limits remain closer."""
    stiff_part: float = 0.1
    """Fraction of steps limited by stability from which on a run may be aborted, and the summary recommends bdf."""
    enough_steps: int = 20_000
    """Number of steps before a run may be aborted, because of stiffness, or of a tolerance below rounding, and between two
    checks for jumps by rounding."""
    too_many_steps: float = 1e9
    """Expected steps times state variables at which it is."""
    untrusted: float = 1e3
    """Error assigned to a step with an invalid estimate, in tolerances."""
    hardly_off: float = 0.3
    """Error of an interpolant without additional stages, in tolerances, up to which it is used."""
    astray: float = 100.0
    """Ratio of two sizes of the same order, such as the terms of an interpolant, above which one of them is invalid; it is
    0.1 to 10 for smooth motions: the stages' terms of the interpolant to those of the ends, the better embedded error to
    the estimate of orders 3 and 5, the distance of the last stage from the end to the estimate."""
    shortest: float = 1e-12
    """Shortest step, as a fraction of the run."""


CONTROL = tuned("explicit_steps", StepControlParameters())


@dataclass(frozen=True)
class FirstStepParameters:
    """Parameters of the first step (Hairer, Norsett, Wanner I, ch. II.4, "starting step size")."""

    part: float = 0.01
    """Fraction of the state changed by the first explicit Euler step, size of the highest-order term in tolerances, and
    least ratio of the trial step to the step. The polynomial of a step of `radau` predicts
    steps up to that ratio."""
    small: float = 1e-5
    """Sizes of states and rates, in tolerances, below which they do not determine a step."""
    short: float = 1e-6
    """Trial step without information, s."""


FIRST_STEP = tuned("explicit_first_step", FirstStepParameters())


@dataclass(frozen=True)
class LocationParameters:
    """Parameters of the location of events by explicit steps.

    Source: as for `stiffmbs.solve.events.native.parameters.EventSearchParameters`.
    """

    beyond: float = 1e-10
    """Distance from an event to the end of a step, relative to the step."""
    most_retaken: int = 8
    """Largest number of steps to one event."""


LOCATION = tuned("explicit_events", LocationParameters())


@dataclass(frozen=True)
class UncertainEndParameters:
    """Parameters that move the end of a step away from a bifurcation pose."""

    close: float = 1e-2
    """Relative size d^2 of the pivots of J M^-1 J^T below which an end is checked."""
    harmful: float = 0.03
    """Velocity change by errors of accelerations in a step, in tolerances, above which they shorten steps: a step should
    not end there, the LU replaces the elimination, or rounding governs the run."""
    shorter: float = 0.55
    """Factor of the step: the stages of the next step then avoid the pose, because those of dopri5 and dop853 are at up
    to 0.33 and from 0.6 of a step on."""
    turning: float = 1e-5
    """Relative distance d of an end from the pose within which the motion may turn into another branch: constraints are
    closed to the square of a tenth of it."""


ENDS = tuned("explicit_ends", UncertainEndParameters())


@dataclass(frozen=True)
class FastestRateParameters:
    """Parameters of the fastest rate of the motion about a state, by power iteration on differences of accelerations."""

    iterations: int = 5
    """Number of iterations; they give a lower bound close to the largest eigenvalue."""
    move: float = 1e-7
    """Largest change of a coordinate or velocity, m, rad, m/s, rad/s; small compared with the breakpoints of laws."""


FASTEST_RATE = tuned("fastest_rate", FastestRateParameters())


@dataclass(frozen=True)
class LinearlyImplicitParameters:
    """Parameters of linearly implicit steps. Source: scenes of `tests/solve/explicit/test_linearly_implicit.py`."""

    noise: float = 1e-6
    """Negative work of a change of velocities, in the sizes of its parts, that may be rounding."""


LINEARLY_IMPLICIT_STEPS = tuned("linearly_implicit_steps", LinearlyImplicitParameters())
