"""The longest step that stability allows, known before the error estimate sees what longer ones do.

Near rest steps grow tenfold each.  One far beyond the scheme's stability multiplies rounding by as much as 1e13, to errors just below
the tolerance, which then stay: the estimate shows them too late.  The fastest rate of the motion tells of that limit at the cost of one
step.  It is asked for where two stages at a step's end show that stability has been passed by far.
"""

from __future__ import annotations

from ..dynamics import Dynamics
from .fastest_rate import fastest_rate
from .integration import Integration
from .scheme import Scheme

SOON, LONGER, MOST_APART = 8, 8, 512
"""Steps between the first two looks at a bound, which may belong to a pose that is soon left; times how many from one to the next, up to that."""
WORTH = 128
"""Steps that must be left for one more, which the rate costs, to be hardly felt."""
STEEP = 8
"""Order from which on a step ten times too long multiplies rounding so much; of order 5 by a millionth of that."""
NOT_ASKED, UNBOUNDED = 0.0, float("inf")


class StableStep:
    """The bound that stability puts on the steps of a run up to its first event, as long as it may be at rest.

    Parameters
    ----------
    scheme : Scheme
    dynamics : Dynamics
    """

    def __init__(self, scheme: Scheme, dynamics: Dynamics) -> None:
        self._stability, self._dynamics = scheme.stability, dynamics
        self._serves = scheme.order >= STEEP
        self._next, self._apart = 0, SOON

    def begin(self, work: Integration) -> bool:
        """Whether the bound is asked for from this start on: from the first one, as later ones have an event behind them."""
        if not self._serves:
            return False
        self._serves = work.count("steps") == 0
        work.stable = NOT_ASKED if self._serves else UNBOUNDED
        return self._serves

    def wait(self, work: Integration) -> int:
        """Steps up to the next look, at the most."""
        return work.capacity if work.stable == NOT_ASKED else max(1, self._next - work.count("steps"))

    def look(self, work: Integration, end: float) -> None:
        """Ask anew where that is due: some steps after the last time, where they have grown to the bound, or where there was none."""
        if work.stable == NOT_ASKED or work.count("steps") < self._next:
            return
        if work.stable == UNBOUNDED:
            work.stable = NOT_ASKED
        elif work.stable < work.h:
            self.ask(work, end)
        else:
            self._wait(work)

    def ask(self, work: Integration, end: float) -> None:
        """Ask for the rate at the state reached; not for a few last steps.

        Beside a pose where branches of the motion meet, the rate tells of the pose alone: such steps go on without a bound.
        """
        bound, work.stable = work.stable or UNBOUNDED, UNBOUNDED
        self._next = work.count("steps") + WORTH
        if end - work.t < WORTH * min(work.h, bound) or work.count("uncertain"):
            return
        rate = fastest_rate(self._dynamics, work.t, work.q.copy(), work.u.copy())
        if rate > 0:
            work.stable = self._stability / rate
            self._wait(work)

    def _wait(self, work: Integration) -> None:
        """Longer each time."""
        self._next = work.count("steps") + self._apart
        self._apart = min(LONGER * self._apart, MOST_APART)
