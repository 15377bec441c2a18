"""Checks of the steps of a segment: continue, or change to the other integrator of `stiffmbs.solve.auto`."""

from __future__ import annotations

from collections import deque

import numpy as np

from .auto_choice import Choice, Switch
from .auto_decisions import AUTO, ExplicitSteps, Interval, cost_ahead, loss_of_trial, since, tolerable_loss
from .explicit.integration import Integration
from .explicit.stable_step import NOT_ASKED
from .ida.native.parameters import LOOP
from .ida.native_engine import Reached


class ExplicitCheck:
    """Check of the explicit steps of a segment: they may be left to the implicit integrator.

    `switch`: switch that the last check decided on, or None.
    """

    def __init__(self, choice: Choice, t: float) -> None:
        self._choice, self._before = choice, choice.evaluations
        self._counted = ExplicitSteps(t, 0, 0, 0.0)
        self.switch: Switch | None = None

    def __call__(self, work: Integration) -> bool:
        """Compare the steps since the last check with the implicit integrator; return True if that is to follow."""
        accepted = work.count("steps")
        if accepted == self._counted.accepted:  # a return at output points only
            return False
        spent = self._choice.spent(self._choice.evaluations - self._before, work.count("accelerations"))
        counted = ExplicitSteps(work.t, accepted, work.count("stiff_steps"), spent)
        steps, self._counted = since(self._counted, counted), counted
        if NOT_ASKED < work.stable < work.h:  # the bound holds the steps below what the integrator counts as limited
            steps = steps._replace(limited=steps.accepted)
        self.switch = self._choice.returned(steps, work.t) or self._choice.later_trial(steps, counted, work)
        return self.switch is not None


class ImplicitCheck:
    """Check of the implicit steps of a segment: they are kept while their loss is tolerable, or if the rest of them costs less.

    `rate`: cost of implicit steps per second of the motion in the last interval. `loss`: cost in excess of explicit
    steps, since it was last lower.
    """

    def __init__(self, choice: Choice, t: float) -> None:
        self._choice, self._implicit = choice, choice.implicit
        self._counted, self._begun = self._implicit.steps(t), self._implicit.integrator.steps()
        self.rate, self.loss = np.inf, 0.0
        self._intervals: deque[Interval] = deque(maxlen=3)
        self._wait()

    def __call__(self, reached: Reached) -> bool:
        """Add the loss since the last check; return True if the implicit integrator is kept."""
        t, choice = reached.t, self._choice
        if self._implicit.integrator.steps() < self._next or t <= self._counted.time or choice.is_breakpoint(t):
            return True  # an event between two checks
        counted = self._implicit.steps(t)
        taken, self._counted = since(self._counted, counted), counted
        self.rate = taken.cost / taken.time
        self.loss = loss_of_trial(self.loss, taken.cost, choice.explicit_cost(taken.time, taken.restarts, taken.long))
        gains = self._gains(Interval(t - 0.5 * taken.time, self.rate))
        return self._wait() > 0.0 or gains

    def _gains(self, last: Interval) -> bool:
        """Return True if the rest of the implicit steps costs less by the decay of their cost in the last three intervals.

        Earlier ones, such as that of the small steps after a start, do not show how it goes on.
        """
        self._intervals.append(last)
        first, t = self._intervals[0], self._counted.time
        remaining = self._choice.remaining(t)
        return first is last or cost_ahead(first, last, t, t + remaining) < self._choice.explicit_cost(remaining, 0)

    def _wait(self) -> float:
        """Set the next check, before which average steps do not exceed the tolerable loss; return the remaining loss."""
        integrator, choice = self._implicit.integrator, self._choice
        ahead = choice.explicit_cost(choice.remaining(self._counted.time), 0)
        left = tolerable_loss(AUTO, self._implicit.start, ahead) - self.loss
        taken = integrator.steps() - self._begun
        steps = min(left / self._implicit.cost.step, LOOP.most_steps)
        every = max(int(steps), int(AUTO.check_interval * taken), 1)
        self._next = integrator.steps() + every
        integrator.engine.ida.pause_after(every)
        return left
