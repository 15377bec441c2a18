"""Explicit Runge-Kutta steps with error control."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ...compile.machine.native.statuses import AT_END, AT_EVENT, NO_STATE, PAUSED, UNSTABLE
from ...dynamics.algebraic_states import no_value_ahead
from ...dynamics.dynamics import Dynamics
from ...dynamics.initial import InitialValues
from ...errors import SolverError
from ...model.settings import RunSettings
from ...tuning import tuned
from ..events.chattering import Chattering, HoveringEvents
from ..events.discontinuity import Jumps
from ..events.refusals import DIVERGENCE, refuse_beyond_limits, refuse_beyond_sense
from ..events.restart import restarted
from ..reasons import OF_STATUS, Reason
from ..step_logging import is_logged, log_step
from ..suspect import suspect
from ..trajectory import Ending, Grid, History, Outcome, ProgressCallback, Rows, Trajectory
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


class Leaving(NamedTuple):
    """Condition for leaving a run to another solver: the first check, in steps of a segment, and the criterion."""

    first: int
    pays: Callable[[Integration], bool]


class AdaptiveRun:
    """Integration with an embedded scheme, from breakpoint to breakpoint and from event to event.

    Output times do not bound the steps; the states there come from the scheme's interpolant. Steps end at breakpoints
    in time and at events of force laws (a contact closes). Other features of the inputs, which long steps of a motion
    at rest would miss, bound them too. `left`: true if the run was left to another solver or failed.
    """

    def __init__(
        self, scheme: Scheme, dynamics: Dynamics, start: InitialValues, grid: Grid, settings: RunSettings, watch: ProgressCallback
    ) -> None:  # fmt: skip
        self.work = work = Integration(scheme, dynamics, start, grid, settings)
        self.left = False
        self._scheme, self._dynamics, self._start, self._grid = scheme, dynamics, start, grid
        self._settings, self._watch = settings, watch
        self._rows = Rows.of(dynamics.system, grid)
        if grid.times is None:
            self._rows.append(grid.start, start.q, start.u)
        features = dynamics.input_features(grid.start, grid.end)
        self._breakpoints, self._note = grid.with_stops(features.breakpoints), features.note
        self._aside = grid.aside
        work.step_bound.follow(features)
        self._stable_step = StableStep(scheme, dynamics)
        self._jumps = Jumps(dynamics, settings)
        self._chattering, self._events = Chattering(dynamics, grid.end, settings.rtol), 0
        self._hovering = HoveringEvents(dynamics, self._chattering, settings.rtol)
        self._rounding = Rounding(dynamics, settings.rtol, grid.start, grid.end)
        self._begun = 0  # steps before the current segment

    def integrate(self, leaving: Leaving | None = None) -> Trajectory:
        """Integrate to the end, or until the run is left; the contract is in `stiffmbs.solve.trajectory`."""
        work, status = self.work, AT_END
        with Ending() as ending:
            for breakpoint in (*self._breakpoints.tolist(), self._grid.end):
                stop, status = breakpoint - self._aside if breakpoint < self._grid.end else breakpoint, AT_EVENT
                while status == AT_EVENT and not self.left:
                    status = self._segment(stop, leaving)
                if status < 0 or self.left or breakpoint == self._grid.end:
                    break
                self._go_past(breakpoint)
        if ending.outcome is Outcome.STOPPED:
            self._store_rows()
        if status < 0:
            self.left = True
            ending.stop(OF_STATUS[status].of(f"stopped at t = {work.t:.9g} s: {self._reason(status)}"))
        elif work.count("stiff_steps") > CONTROL.stiff_part * work.count("steps"):
            message = f"{ending.message}; {stiff_sentence(work)}"
            ending.message = Reason.STIFF.of(message) if ending.outcome is Outcome.STOPPED else message
        history = History(np.concatenate([*work.step_times, np.empty(0)]), np.empty(0, dtype=int))
        statistics = {**self._statistics(), "seconds": ending.seconds}
        note = "; ".join(filter(None, (self._note, self._jumps.sentence(), self.work.watch.note())))
        return Trajectory(
            *self._rows.stored,
            ending.outcome,
            ending.message,
            statistics,
            history,
            note,
            whole_steps=self.work.whole_steps(),
            departures=self.work.watch.departures(),
        )

    def _reason(self, status: int) -> str:
        state = self.work.t, self.work.q.copy(), self.work.u.copy()
        missing = no_value_ahead(self._dynamics, *state) if status == NO_STATE else ""
        return missing or REASONS[status] + suspect(self._dynamics, *state)

    def _segment(self, stop: float, leaving: Leaving | None) -> int:
        """Integrate from consistent values to `stop`, to an event, or until the run is left; return the last status."""
        work, advance, status = self.work, ADVANCE.call, PAUSED
        most = min(leaving.first, work.capacity) if leaving else work.capacity
        if work.count("steps") - self._begun <= CHECKS.now_and_then or self._events % CHECKS.now_and_then == 0:
            self._chattering.begin(work.t, self._start.q, self._start.u)
        self._begun = work.count("steps")
        stable_step = self._stable_step
        bounds = stable_step.begin(work, self._events)
        look_at, held_at = self._looks(most, leaving) if bounds else (0, 0)
        while status == PAUSED:
            wait, held = most, self._held(most, leaving)
            if bounds:
                wait = min(look_at - work.count("steps"), stable_step.wait(work))
                held = min(held_at - work.count("stiff_steps"), stable_step.held(work))
            status = advance(stop, wait, held, self._grid.times is None, work.at)
            work.collect(self._rows)
            if is_logged():
                log_step(work.t, work.h)
            self._watch(work.t)
            self._grid.look(self._rows)
            if work.t < self._grid.end and work.count("steps") >= DIVERGENCE.followed_steps:
                refuse_beyond_sense(self._dynamics, self._rows, work.t, work.q, work.u)
            if status == UNSTABLE:
                stable_step.ask(work, self._grid.end)
                status = PAUSED
                continue
            if status == PAUSED:
                self._chattering.look(work.t, work.q.copy(), work.u.copy(), work.count("steps"))
                self._leave_to_rounding()
                if bounds:
                    stable_step.look(work, self._grid.end)
                    if work.count("steps") < look_at and work.count("stiff_steps") < held_at and leaving:
                        continue
            most = min(2 * most, work.capacity) if leaving else most
            if bounds:
                look_at, held_at = self._looks(most, leaving)
            if status == PAUSED and leaving and leaving.pays(work):
                self.left = True
                self._store_rows()
                return status
        if status == AT_EVENT and work.t < self._grid.end:
            fired = work.fired()
            self._hovering.note(work.t, work.q.copy(), work.u.copy(), fired, work.watch.farthest)
            work.watch.watch_for(self._hovering.band)
            self._restart()
            self._events += 1
            self._chattering.note_event(work.t, self._start.q, self._start.u, fired[0] if fired else -1)
        return status

    def _leave_to_rounding(self) -> None:
        """Stop if rounding errors limit the steps; another solver may continue."""
        reason = self._rounding.look(self.work)
        if reason:
            self.left = True
            raise SolverError(f"stopped at t = {self.work.t:.9g} s: {reason}")

    def _looks(self, most: int, leaving: Leaving | None) -> tuple[int, int]:
        """Return the step count, and the count of steps limited by stability, at which the next check is due."""
        return self.work.count("steps") + most, self.work.count("stiff_steps") + self._held(most, leaving)

    @staticmethod
    def _held(most: int, leaving: Leaving | None) -> int:
        """Return the number of steps limited by stability that makes an early check due."""
        return max(1, most // CHECKS.now_and_then) if leaving else most

    def _go_past(self, breakpoint: float) -> None:
        """Restart just after a breakpoint; output at it is the state before."""
        self.work.t = min(breakpoint + self._aside, self._grid.end)
        self._store_rows()
        before = self._dynamics.system.of_body.moved(self.work.q, 2.0 * self._aside * self.work.u), self.work.u.copy()
        self.work.q[:] = before[0]
        self._restart()
        self._dynamics.state.q[:], self._dynamics.state.u[:] = self._start.q, self._start.u
        self._jumps.note(breakpoint, *before)

    def _restart(self) -> None:
        """Restart from consistent values at the current time."""
        work = self.work
        self._start = restarted(self._dynamics, work.t, work.q, work.u, self._settings.projection)
        refuse_beyond_limits(self._dynamics, work.t, self._start.q, self._start.u)
        work.begin(self._start)

    def _store_rows(self) -> None:
        work, status = self.work, PAUSED
        while status == PAUSED:
            status = ADVANCE.call(work.t, 1, 1, self._grid.times is None, work.at)
            work.collect(self._rows)

    def _statistics(self) -> dict[str, int | float | str]:
        counted = {name: self.work.count(name) for name in ("steps", "rejected", "accelerations")}
        return {
            "scheme": self._scheme.name,
            **counted,
            "breakpoints": sum(t < self.work.t for t in self._breakpoints.tolist()),
            "events": self._events,
        }
