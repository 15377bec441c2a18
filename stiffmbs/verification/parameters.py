"""Parameters of error bars, of reruns and of the search for missed events."""

from __future__ import annotations

from dataclasses import dataclass

from ..tuning import tuned


@dataclass(frozen=True)
class VerificationParameters:
    """Parameters of error bars, of reruns and of the search for missed events.

    Source: tests/verification and docs/verify.md.
    """

    blown_up: float = 0.05
    """Excess of a channel over its output values, relative to its scale, from which on a peak is reported and the pose is checked."""
    parts_of_implicit_steps: int = 2
    """Parts of an interval between two times, for implicit steps (order up to 5)."""
    parts: int = 4
    """The same for explicit steps (order 8)."""
    most_values: float = 3e7
    """Largest number of values of a run, limited by memory."""
    most_products: float = 3e9
    """Largest number of multiplications in the decompositions of poses."""
    amplified: float = 1e6
    """Acceptable error, in tolerances."""
    visible: float = 1e-2
    """Its limit, as a fraction of the channel's scale."""
    loose: float = 100.0
    """Its lower bound, in tolerances."""
    of_state: float = 1e-3
    """Least size of the rate of a state, in largest values of the state over the duration."""
    converges: float = 2.0
    """Smallest reduction of the error at a tolerance tighter by a factor of ten."""
    named: int = 3
    """Largest number of channels that a sentence names."""
    diverged: float = 0.05
    """Smallest difference of positions or velocities, relative to the motion's size, or in rad, of diverged motions."""
    together: float = 1e-3
    """Fraction of `diverged` at which the difference begins to grow."""
    sensitive: float = 2.0
    """Smallest factor of time by which a tighter tolerance delays the divergence of a motion that is not sensitive."""
    tightest_rtol: float = 1e-13
    """Relative tolerance below which steps fail by rounding, and rounding of a channel, relative to its scale."""
    clearly_tighter: float = 2.0
    """Smallest ratio of tolerances that makes a comparison useful."""
    more_steps: int = 4
    """Ratio of the number of steps of a rerun with a shorter longest step."""
    least_steps: int = 1000
    """Its minimum number of steps."""
    looks_ahead: float = 0.3
    """Fraction of the allowed effort after which a run that would exceed it is stopped."""
    samples: int = 20_000
    """Largest number of samples."""
    of_effort_left: float = 0.25
    """Fraction of the remaining effort for the sampling."""
    elsewhere: float = 1e-2
    """Difference of kinetic energies, relative to the largest, between runs that are not equivalent."""
    fewest_steps: int = 4
    """Least number of steps between the samples next to a missed event."""
    most_effort: float = 10.0
    """Evaluations of all reruns, in those of the first run."""
    effort_allowed: float = 2.5e7
    """Their minimum, times the number of unknowns."""
    other_of_fixed: float = 1e-10
    """Relative tolerance of the other solver if the first has fixed steps."""


VERIFICATION = tuned("verification", VerificationParameters())
