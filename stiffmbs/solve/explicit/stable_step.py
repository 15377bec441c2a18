"""The longest step that stability allows, known before the error estimate sees what longer ones do.

Near rest a step far beyond the scheme's stability multiplies rounding by as much as 1e13, to errors just below the tolerance, which
then stay: the estimate shows them too late.  The fastest rate of the motion tells of that limit at the cost of one step.
"""

from __future__ import annotations

from ..dynamics import Dynamics
from .fastest_rate import fastest_rate
from .integration import Integration
from .scheme import Scheme

FIRST = 2
"""Steps after a start until the rate is asked for, before they have grown."""
SOON, LONGER, MOST_APART = 8, 8, 512
"""Steps between the first two looks at a bound, which may belong to a pose that is soon left; times how many from one to the next, up to that."""
WORTH = 64
"""Steps that must be left for one more, which the rate costs, to be hardly felt."""
UNBOUNDED = float("inf")


class StableStep:
    """The bound that stability puts on the steps of a run.

    Parameters
    ----------
    scheme : Scheme
    dynamics : Dynamics
    """

    def __init__(self, scheme: Scheme, dynamics: Dynamics) -> None:
        self._stability, self._dynamics = scheme.stability, dynamics
        self._next, self._apart = FIRST, SOON

    def wait(self, work: Integration) -> int:
        """Steps up to the next look."""
        return max(1, self._next - work.count("steps"))

    def begin_behind_event(self, work: Integration) -> None:
        """Forget the bound, as a force has changed its law; ask again later, as further events may follow soon."""
        work.stable = UNBOUNDED
        self._next, self._apart = work.count("steps") + WORTH, SOON

    def begin_behind_breakpoint(self, work: Integration) -> None:
        """Ask again soon, as a long step may follow the small ones of a start."""
        self._next, self._apart = work.count("steps") + FIRST, SOON

    def look(self, work: Integration, end: float) -> None:
        """Ask for the rate at the state reached where that is due and worth it: steps have grown to the bound, or have none yet.

        Beside a pose where branches of the motion meet, the rate tells of the pose alone, and is not asked for.
        """
        if work.count("steps") < self._next or work.count("uncertain"):
            return
        self._next = work.count("steps") + self._apart
        if work.h < work.stable < UNBOUNDED or end - work.t < WORTH * min(work.h, work.stable):
            return
        self._apart = min(LONGER * self._apart, MOST_APART)
        rate = fastest_rate(self._dynamics, work.t, work.q.copy(), work.u.copy())
        work.stable = self._stability / rate if rate > 0 else UNBOUNDED
