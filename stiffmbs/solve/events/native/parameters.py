"""Parameters of the search for events."""

from __future__ import annotations

from dataclasses import dataclass
from math import log2
from sys import float_info

from ....tuning import tuned

EPSILON = float_info.epsilon
"""Relative rounding of a number."""
INDISTINCT = 4 * EPSILON
"""Relative difference up to which two times are the same, for IDA and for breakpoints, whose rounding is as large."""
BISECTIONS = round(-log2(INDISTINCT))
"""Bisections of a step after which its parts are indistinct."""


@dataclass(frozen=True)
class EventSearchParameters:
    """Parameters of the search for events within a step.

    Source: the stress tests of contacts, tables and periodic laws (``python -m tests.stress``).
    """

    margin: float = 0.1
    """Margin of a function's bounds between the ends of a step, relative to their range."""
    unknown: float = 8.0
    """Factor of the deviation from the cubic elsewhere, relative to that at the compared place. It is the factor of the
    rounding of rates too, relative to their change with the time of difference."""
    steep: float = 8.0
    """Ratio of an end rate to the change between the ends above which a function has an extremum."""
    turned: float = 1.0
    """Rotation of a body, or change of a sine's argument, in a step above which the step is searched, rad; no simple
    fraction of a period. Explicit steps with twice that are repeated."""
    clear: float = 4.0
    """Distance of a function from its breakpoints, relative to its change in the step and by its initial rate, above
    which it is far from them."""
    hardly_turned: float = 0.3
    """Largest rotation of a body in such a step, rad: values at the ends do not show whole revolutions."""
    fits: float = 0.02
    """Allowed deviation from the cubic, relative to the range of values there."""
    precision: float = 1e-9
    """Precision of values and rates, relative to the largest number in the state: smaller differences are rounding. Both sides
    of a state are evaluated after a displacement of this size."""
    shallow: float = 1e-5
    """Depth below zero, relative to that rounding, that is no event: rounding changes the sign of a closed contact."""
    well: float = 0.03
    """Relative deviation from the cubic below which the next part is doubled (it has order four)."""
    finest: float = 1e-4
    """Finest resolution of times: shortest part of a step that is searched, and distance to a predicted event up to which a
    step goes, relative to that from its start."""
    few_parts: int = 100
    """Number of parts after which these are no longer halved, if arguments of sines cannot be followed."""
    difference: float = 1e-6
    """Fraction of a step, or of a part, over which rates are computed. The motion is extrapolated up to it past an event,
    until a sign change exceeds rounding. After a start of IDA it is extrapolated over this part of the time to the next
    stop, to find the sign of a function that is zero."""
    least_difference: float = 1e-9
    """Least time over which rates are computed: at the end of a step relative to the duration, at a start relative to the
    time to the next stop. Shorter differences are rounding. The new law holds this far after an event, relative to the
    step. At an explicit start the motion must leave a zero within it, relative to the duration."""
    refined: float = 0.02
    """Fraction of a part over which a parabola is fitted at an extremum."""
    refinements: int = 5
    """Number of such fits, each over a tenth of the last."""
    longer: float = 4.0
    """Factor between successive extrapolations: longer ones leave a zero, shorter ones approach a sign change."""
    held: int = 3
    """Number of successive equal signs that such a function must have: a single one may be rounding."""


SEARCH = tuned("event_search", EventSearchParameters())


@dataclass(frozen=True)
class NextStepParameters:
    """Parameters that bound the next step of IDA near the breakpoints of laws.

    Source: as for `EventSearchParameters`.
    """

    short_of: float = 1e-8
    """Distance from the end of a step to a predicted event, relative to the longest step; that relative to the distance of
    the event is `EventSearchParameters.finest`."""
    of_an_interval: float = 0.35
    """Fraction of an interval of a law that may be passed on each side of a place within a step: two or three steps
    resolve an interval. Larger fractions save steps, and miss more narrow features."""
    soon: float = 1e-2
    """Passage relative to the time to the next stop above which IDA's first steps are short enough."""
    passage_steps: float = 16.0
    """Least number of steps of BDF in a passage with periodic laws, the errors of which add up."""
    first_part: float = 0.125
    """First step of order 1, as a fraction of such a step."""
    lifted: float = 1e-6
    """Initial fraction of a run in which every step of a passage is limited."""
    inside: float = 0.4
    """Place within a passage at which forces are compared with those at the start, and longest step of a one-step method;
    not 0.5, the centre of symmetry."""


NEXT_STEP = tuned("next_step", NextStepParameters())
