"""The longest step that stability allows, known before the error estimate sees what longer ones do.

Near rest steps grow tenfold each.  One far beyond the scheme's stability multiplies rounding by as much as 1e13, to errors just below
the tolerance, which then stay: the estimate shows them too late.  Steps that the estimate holds back go to and fro about the limit:
some ten in a hundred are rejected, and rounding grows in others.  The fastest rate of the motion tells of that limit at the cost of one
step.  It is asked for where two stages at a step's end show that stability has been passed by far, or has held back several steps.
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
HELD_BACK = 16
"""Steps that stability has held back when the bound is asked for, in all since the last time."""
CONTRADICTED = 0.4
"""Part of a step that stability held back, below which a bound contradicts that step: rates are no bounds where forces are far from symmetric."""
STEEP = 8
"""Order from which on a step ten times too long multiplies rounding so much; of order 5 by a millionth of that."""
NOT_ASKED, UNBOUNDED = 0.0, float("inf")


class StableStep:
    """The bound that stability puts on the steps of a run up to its first event.

    Parameters
    ----------
    scheme : Scheme
    dynamics : Dynamics
    """

    def __init__(self, scheme: Scheme, dynamics: Dynamics) -> None:
        self._stability, self._dynamics = scheme.stability, dynamics
        self._serves = scheme.order >= STEEP
        self._next, self._apart, self._held_before = 0, SOON, 0

    def begin(self, work: Integration, events: int) -> bool:
        """Whether the bound is asked for from this start on: up to the first event, as later starts are too many."""
        serves = self._serves and events == 0
        self._forget(work)
        if not serves:
            work.stable = UNBOUNDED
        return serves

    def _forget(self, work: Integration) -> None:
        work.stable, self._held_before = NOT_ASKED, work.count("stiff_steps")

    def wait(self, work: Integration) -> int:
        """Steps up to the next look, at the most."""
        return work.capacity if work.stable == NOT_ASKED else max(1, self._next - work.count("steps"))

    def held(self, work: Integration) -> int:
        """Steps that stability may hold back up to the next look, at the most."""
        return self._left(work) if work.stable == NOT_ASKED else work.capacity

    def _left(self, work: Integration) -> int:
        return HELD_BACK - (work.count("stiff_steps") - self._held_before)

    def look(self, work: Integration, end: float) -> None:
        """Ask where that is due: where steps were held back; some steps after the last time, where they have grown to the bound."""
        if work.stable == NOT_ASKED:
            if self._left(work) <= 0:
                self._ask_as_held(work, end)
        elif work.count("steps") < self._next:
            return
        elif work.stable == UNBOUNDED:
            self._forget(work)
        elif work.stable < work.h:
            self.ask(work, end)
        else:
            self._wait(work)

    def _ask_as_held(self, work: Integration, end: float) -> None:
        """Ask where steps were held back: these are near the limit, which the bound must not contradict."""
        self.ask(work, end)
        if work.stable < CONTRADICTED * work.h:
            work.stable, self._next = UNBOUNDED, work.count("steps") + MOST_APART

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
