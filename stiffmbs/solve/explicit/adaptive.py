"""Explicit Runge-Kutta steps with error control."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...compile.inputs.features import InputFeatures
from ...compile.machine.native.statuses import AT_END, AT_EVENT, NO_STATE, PAUSED, UNSTABLE
from ...dynamics.algebraic_states import no_value_ahead
from ...dynamics.dynamics import Dynamics
from ...dynamics.initial import InitialValues
from ...errors import SolverError
from ...model.settings import RunSettings
from ...tuning import tuned
from ..engine import Begun, Engine, Reached
from ..events.refusals import refuse_beyond_limits
from ..events.restart import restarted
from ..events.whole_steps import WholeSteps
from ..reasons import OF_STATUS, Reason
from ..suspect import suspect
from ..trajectory import Grid, History, Outcome, Trajectory
from .integration import REASONS, Integration, stiff_sentence
from .native.parameters import CONTROL
from .rounding import Rounding
from .scheme import ADVANCE, Scheme
from .stable_step import StableStep


@dataclass(frozen=True)
class CheckParameters:
    """Parameters of the checks between compiled calls."""

    now_and_then: int = 8
    """Events of which one is always checked, as are those that follow within as many steps; and part of the steps that
    stability must limit for an early decision."""


CHECKS = tuned("explicit_checks", CheckParameters())


class AdaptiveSteps(Engine):
    """Engine of an embedded scheme.

    Output times do not bound the steps; the states there come from the scheme's interpolant. Features of the inputs, which
    long steps of a motion at rest would miss, bound them. `first`: steps of a segment up to the first check whether
    another solver is to follow, if one may. `due`: True where such a check is due. `failed`: True after a failure of steps, which
    another solver may take.
    """

    def __init__(
        self, scheme: Scheme, dynamics: Dynamics, start: InitialValues, grid: Grid, settings: RunSettings, first: int | None = None
    ) -> None:  # fmt: skip
        self.work = Integration.of(scheme, dynamics, start, grid, settings)
        self.watch, self.due, self.failed = self.work.watch, False, False
        self._scheme, self._dynamics, self._settings, self._end = scheme, dynamics, settings, grid.end
        self._first, self._may_leave = min(first or self.work.capacity, self.work.capacity), first is not None
        self._stable_step = StableStep(scheme, dynamics)
        self._rounding = Rounding(dynamics, settings.rtol, grid.start, grid.end)
        self._status, self._events = AT_END, 0
        self._begun = 0  # steps before the current segment

    def begin_run(self, features: InputFeatures, grid: Grid) -> None:
        """See `Engine`."""
        self.work.step_bound.follow(features)

    def begin_at(self, start: InitialValues, t: float) -> None:
        """See `Engine`."""
        self.work.t = t
        self.work.begin(start)

    def begin_restart(self, q: np.ndarray, u: np.ndarray, t: float, ahead: float, stop: float) -> Begun:
        """See `Engine`. Steps end after an event. Only some restarts at events are checked for chattering forces."""
        state, steps, at_event = self._dynamics.state, self.work.count("steps"), self._status == AT_EVENT
        start = restarted(self._dynamics, t, q, u, self._settings.projection)
        refuse_beyond_limits(self._dynamics, t, start.q, start.u)
        self.begin_at(start, t)
        self._events += at_event
        meets = steps - self._begun <= CHECKS.now_and_then or self._events % CHECKS.now_and_then == 0
        self._begun = steps
        state.q[:], state.u[:] = start.q, start.u
        return Begun(t, not at_event, meets)

    def advance(self, times: np.ndarray | None, stops: Sequence[float]) -> Iterator[Reached]:
        """See `Engine`."""
        work, stable_step, most, self._status = self.work, self._stable_step, self._first, PAUSED
        work.report_at(np.empty(0) if times is None else times)
        bounds = stable_step.begin(work, self._events)
        look_at, held_at = self._looks(most)
        while self._status in (PAUSED, UNSTABLE):
            wait, held = look_at - work.count("steps"), held_at - work.count("stiff_steps")
            if bounds:
                wait, held = min(wait, stable_step.wait(work)), min(held, stable_step.held(work))
            self._status = ADVANCE.call(stops[0], wait, held, times is None, work.at)
            reason = self._checked(bounds)
            early = bounds and self._may_leave and work.count("steps") < look_at and work.count("stiff_steps") < held_at
            self.due = self._status == PAUSED and not early
            if self.due:
                most = min(2 * most, work.capacity) if self._may_leave else most
                look_at, held_at = self._looks(most)
            fired = tuple(work.fired()) if self._status == AT_EVENT else ()
            yield Reached(*work.collect(), work.t, lambda: (work.q.copy(), work.u.copy()), fired)
            if reason:
                raise SolverError(reason)

    def _checked(self, bounds: bool) -> str:
        """Check the stability bound and the effect of rounding after a call; return why the run ends, or an empty string."""
        work, reason = self.work, ""
        if self._status == UNSTABLE:
            self._stable_step.ask(work, self._end)
        elif self._status == PAUSED:
            if by_rounding := self._rounding.look(work):
                reason = f"stopped at t = {work.t:.9g} s: {by_rounding}"
            elif bounds:
                self._stable_step.look(work, self._end)
        elif self._status < 0:
            state = work.t, work.q.copy(), work.u.copy()
            missing = no_value_ahead(self._dynamics, *state) if self._status == NO_STATE else ""
            sentence = missing or REASONS[self._status] + suspect(self._dynamics, *state)
            reason = OF_STATUS[self._status].of(f"stopped at t = {work.t:.9g} s: {sentence}")
        self.failed = bool(reason)
        return reason

    def _looks(self, most: int) -> tuple[int, int]:
        """Return the step count, and the count of steps limited by stability, at which the next check is due."""
        held = max(1, most // CHECKS.now_and_then) if self._may_leave else most
        return self.work.count("steps") + most, self.work.count("stiff_steps") + held

    def steps(self) -> int:
        """See `Engine`."""
        return self.work.count("steps")

    def last_step(self) -> tuple[float, int]:
        """See `Engine`."""
        return self.work.span, 0

    def history(self) -> History:
        """See `Engine`."""
        return History(np.concatenate([*self.work.step_times, np.empty(0)]), np.empty(0, dtype=int))

    def whole_steps(self) -> tuple[WholeSteps, ...]:
        """See `Engine`."""
        return self.work.whole_steps()

    def statistics(self) -> dict[str, int | float | str]:
        """See `Engine`."""
        counted = {name: self.work.count(name) for name in ("steps", "rejected", "accelerations")}
        return {"scheme": self._scheme.name, **counted}

    def ended(self, trajectory: Trajectory) -> Trajectory:
        """Return a trajectory with a sentence on steps that stability has limited, if these are many."""
        work = self.work
        if self._status < 0 or work.count("stiff_steps") <= CONTROL.stiff_part * work.count("steps"):
            return trajectory
        message = f"{trajectory.message}; {stiff_sentence(work)}"
        stopped = trajectory.outcome is Outcome.STOPPED
        return replace(trajectory, message=Reason.STIFF.of(message) if stopped else message)
