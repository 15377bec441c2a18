"""The longest step that stability allows, known before the error estimate sees what longer ones do.

Near rest steps grow tenfold each.  One far beyond the scheme's stability multiplies rounding by as much as 1e13, to errors just below
the tolerance, which then stay: the estimate shows them too late.  The fastest rate of the motion tells of that limit at the cost of one
step.  It is asked for where two stages at a step's end show that stability has been passed.
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
NOT_ASKED, UNBOUNDED = 0.0, float("inf")


class StableStep:
    """The bound that stability puts on the steps of a run.

    Parameters
    ----------
    scheme : Scheme
    dynamics : Dynamics
    """

    def __init__(self, scheme: Scheme, dynamics: Dynamics) -> None:
        self._stability, self._dynamics = scheme.stability, dynamics
        self._next, self._apart = 0, SOON

    def wait(self, work: Integration) -> int:
        """Steps up to the next look, at the most."""
        return work.capacity if work.stable == NOT_ASKED else max(1, self._next - work.count("steps"))

    def begin(self, work: Integration) -> None:
        """Forget the bound, as a force may have changed its law."""
        work.stable, self._apart = NOT_ASKED, SOON

    def look(self, work: Integration, end: float) -> None:
        """Ask anew where that is due: some steps after the last time, where they have grown to the bound, or where there was none."""
        if work.stable == NOT_ASKED or work.count("steps") < self._next:
            return
        if work.stable == UNBOUNDED:
            work.stable = NOT_ASKED
        elif work.stable < work.h:
            self.ask(work, end)
        else:
            self._next = work.count("steps") + self._apart

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
            self._next = work.count("steps") + self._apart
            self._apart = min(LONGER * self._apart, MOST_APART)
