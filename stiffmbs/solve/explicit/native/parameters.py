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
    """Least ratio of successive steps."""
    largest_factor: float = 10.0
    """Largest ratio of successive steps."""
    after_failure: float = 0.25
    """Factor of the step after an attempt without a result."""
    smallest_error: float = 1e-4
    """Smallest previous error in the PI step control, as in DOPRI5."""
    far_beyond: float = 2.0
    """Multiple of the stability limit above which rounding grows before the error estimate detects it; steps that the
    estimate limits remain closer."""
    stiff_part: float = 0.1
    """Fraction of steps limited by stability from which on a run may be given up, and the summary recommends bdf."""
    enough_steps: int = 10_000
    """Number of steps before a run may be given up."""
    too_many_steps: float = 1e9
    """Expected steps times state variables at which it is."""
    untrusted: float = 1e3
    """Error assigned to a step with an invalid estimate, in tolerances."""
    unseen: float = 1e-2
    """Estimated error relative to the distance of the last stage from the end, below which the estimate is invalid."""
    most_below: float = 100.0
    """Largest ratio of the better embedded error to the estimate: the formula of orders 3 and 5 assumes smooth
    motion."""
    hardly_off: float = 0.3
    """Error of an interpolant without additional stages, in tolerances, up to which it is used."""
    astray: float = 100.0
    """Ratio of the stages' terms of the interpolant to those of the ends above which they are invalid; 0.1 to 10 for
    smooth motions."""
    shortest: float = 1e-12
    """Shortest step, as a fraction of the run."""


CONTROL = tuned("explicit_steps", StepControlParameters())


@dataclass(frozen=True)
class FirstStepParameters:
    """Parameters of the first step (Hairer, Norsett, Wanner I, ch. II.4, "starting step size")."""

    part: float = 0.01
    """Fraction of the state changed by the first explicit Euler step, and size of the highest-order term in
    tolerances."""
    small: float = 1e-5
    """Sizes of states and rates, in tolerances, below which they do not determine a step."""
    short: float = 1e-6
    """Trial step without information, s."""
    no_rate: float = 1e-15
    """Rate, in tolerances, below which the step is unbounded."""
    longer_at_rest: float = 1e-3
    """Least fraction of the trial step then."""
    longest_factor: float = 100.0
    """Largest ratio of the step to the trial step."""
    farthest: float = 1e3
    """Shortest steps within which the motion must leave a zero of an event function."""


FIRST_STEP = tuned("explicit_first_step", FirstStepParameters())


@dataclass(frozen=True)
class LocationParameters:
    """Parameters of the location of events by explicit steps.

    Source: as for `stiffmbs.solve.events.native.parameters.EventSearchParameters`.
    """

    behind: float = 1e-10
    """Distance from an event to the end of a step, relative to the step."""
    rounding: float = 2e-15
    """The same relative to the time since zero."""
    farthest_past: float = 1e-6
    """Fraction of the step up to which the motion is extrapolated until a sign change exceeds rounding."""
    most_retaken: int = 8
    """Largest number of steps to one event."""
    bisections: int = 40
    """Bisections to find a sign change on the interpolant."""


LOCATION = tuned("explicit_events", LocationParameters())


@dataclass(frozen=True)
class UncertainEndParameters:
    """Parameters that move the end of a step away from a bifurcation pose."""

    close: float = 1e-2
    """Relative size d^2 of the pivots of J M^-1 J^T below which an end is checked."""
    harmful: float = 0.01
    """Velocity change by acceleration errors in a step, in tolerances, above which a step should not end there."""
    most_moved: int = 3
    """Number of times that the end of a step is moved back."""
    shorter: float = 0.55
    """Factor of the step: the stages of the next step then avoid the pose, because those of dopri5 and dop853 are at up
    to 0.33 and from 0.6 of a step on."""


ENDS = tuned("explicit_ends", UncertainEndParameters())
