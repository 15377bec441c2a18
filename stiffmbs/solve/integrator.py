"""Runs in segments, from breakpoint to breakpoint and from event to event, by any engine."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from typing import Generic, TypeVar

import numpy as np

from ..dynamics.dynamics import Dynamics
from ..dynamics.initial import InitialValues
from ..model.settings import RunSettings
from .engine import Engine, Reached
from .events.chattering import Chattering, HoveringEvents
from .events.discontinuity import Jumps
from .events.native.parameters import SEARCH
from .events.refusals import DIVERGENCE, refuse_beyond_limits, refuse_beyond_sense
from .events.restart import straight_on
from .ida.native.parameters import LOOP
from .stiff_rows import States, projected
from .trajectory import Ending, Grid, ProgressCallback, Rows, Trajectory, just_after

E = TypeVar("E", bound=Engine)
LOGGER = logging.getLogger(__name__)


class Integrator(Generic[E]):
    """An engine over the segments of a run, restarted at breakpoints and events.

    `reached`: last return of the engine.
    """

    def __init__(self, dynamics: Dynamics, settings: RunSettings, engine: E) -> None:
        self.dynamics, self.settings, self.engine = dynamics, settings, engine
        self.reached: Reached | None = None
        engine.forget()
        self._jumps = Jumps(dynamics, settings)
        self._of_inputs = ""
        self._events = self._breakpoints = 0

    def note(self) -> str:
        """Return the notes on inputs, velocity jumps and the engine."""
        return "; ".join(filter(None, (self._of_inputs, self._jumps.sentence(), self.engine.note())))

    def on_constraints(self, reached: Reached) -> States:
        """Return q and u that were reached; those after a long step are projected without a change of stiff forces."""
        last = self.engine.last_step()
        return self.closed(reached.t, reached.state(), last[0]) if last else reached.state()

    def closed(self, t: float, state: States, step: float) -> States:
        """Return q and u at the end of a step, s, projected without a change of stiff forces if it is long for them."""
        return projected(self.dynamics, t, state, step) if step > self.engine.long_step else state

    def run(self, start: InitialValues, grid: Grid, passing: bool = False) -> Iterator[Reached]:
        """Yield the progress at the times of the grid, or after each step; a failure comes last.

        `passing`: True if the engine may restart at several breakpoints before it returns.
        """
        t = grid.start
        self._jumps.clear()
        features = self.dynamics.input_features(grid.start, grid.end)
        self.engine.begin_run(features, grid)
        self._of_inputs = features.note
        chattering = Chattering(self.dynamics, grid.end, self.settings.rtol)
        self._hovering = HoveringEvents(self.dynamics, chattering, self.settings.rtol)
        stops = [*(grid.with_stops(features.breakpoints) - grid.aside).tolist(), grid.end]
        begun = False
        while stops:
            if just_after(t) >= stops[0]:
                del stops[0]
                continue
            if not begun:
                begun = True
                refuse_beyond_limits(self.dynamics, t, start.q, start.u)
                self.engine.watch.watch_for(self._hovering.band)
                self.engine.begin_at(start, t)
                self._started()
                chattering.begin(t, start.q, start.u)
            ahead = stops[: LOOP.most_passed if passing else 1]
            times = None if grid.times is None else grid.within(just_after(t), ahead[-1])
            for reached in self.engine.advance(times, ahead):
                del stops[: reached.passed]
                self._breakpoints += reached.passed
                yield reached if not reached.failure else self._explained(reached)
                if reached.t < stops[0] and not (reached.fired or reached.failure):
                    chattering.look(reached.t, *reached.state(), self.engine.steps())
            if reached.failure:
                return
            if reached.t < stops[0]:
                chattering.note_event(reached.t, reached.state, reached.fired[0] if reached.fired else -1)
            before = t = reached.t
            if t < grid.end:
                q, u = self.on_constraints(reached)
                if self._hovering.any:
                    self._hovering.note(t, q, u, reached.fired, self.engine.watch.farthest)
                at_breakpoint = t >= stops[0]
                if at_breakpoint:
                    before = t = t + 2.0 * grid.aside
                    yield from self._at_once(reached.t, t, grid, (q, u))
                    q = self.dynamics.system.of_body.moved(q, 2.0 * grid.aside * u)
                t = self._restarted(q, u, t, self._ahead(reached, stops[0]), stops[0], chattering)
                if not at_breakpoint:
                    state = self.dynamics.state
                    yield from self._at_once(before, t, grid, (state.q, state.u))
                self._events += not at_breakpoint
                self._breakpoints += at_breakpoint

    def _restarted(
        self, q: np.ndarray, u: np.ndarray, t: float, ahead: float, stop: float, chattering: Chattering
    ) -> float:
        """Restart at t from a state, past events within `ahead`; return the time of the start, before the next stop."""
        self.engine.watch.watch_for(self._hovering.band)
        begun, state = self.engine.begin_restart(q, u, t, ahead, stop), self.dynamics.state
        if self._hovering.taken_back(begun.t):
            self.engine.watch.watch_for(self._hovering.band)
        self._started()
        if begun.jumps:
            self._note_jump(t, q, u, ahead > 0.0)
        if begun.meets:
            chattering.begin(begun.t, state.q.copy(), state.u.copy())
        return begun.t

    def _started(self) -> None:
        """Do nothing more at a start, whose values are those of the current state."""

    def _note_jump(self, before: float, q: np.ndarray, u: np.ndarray, event: bool) -> None:
        """Note a jump at a restart; the current state is that after it.

        A state that was interpolated to an event within a step may violate the constraints just before it as well. So may
        velocities that a formulation does not test.
        """
        dynamics, state, last = self.dynamics, self.dynamics.state, self.engine.last_step()
        if not event:
            if self._jumps.is_jump(state.u - u):
                u = self._closed_velocities(dynamics.times_around(before)[0], q, u)
            self._jumps.note(before, q, u)
        elif last and self._jumps.is_jump(state.u - u):
            back = SEARCH.finest * last[0]
            u = self._closed_velocities(before - back, dynamics.system.of_body.moved(q, -back * u), u)
            self._jumps.note(before, state.q, u)

    def _closed_velocities(self, t: float, q: np.ndarray, u: np.ndarray) -> np.ndarray:
        """Return the velocities nearest to given ones that satisfy the constraints, or the given ones if there are none."""
        state = self.dynamics.state
        with state.unchanged():
            state.q[:], state.u[:] = q, u
            closed = self.dynamics.correct_velocities(t) >= 0
            return state.u.copy() if closed else u

    def _ahead(self, reached: Reached, stop: float) -> float:
        """Return the time after an event within which simultaneous events are passed, s."""
        last = self.engine.last_step() if reached.fired else None
        ahead = straight_on(reached.t, last[0], self.settings.rtol) if last else 0.0
        return ahead if just_after(reached.t + ahead) < stop else 0.0

    def _explained(self, reached: Reached) -> Reached:
        """Replace a failure by one that names the chattering force, if there is one."""
        jumping = self._hovering.failed(reached.t, *reached.state())
        return reached._replace(failure=jumping or reached.failure)

    def _at_once(self, before: float, t: float, grid: Grid, state: States) -> Iterator[Reached]:
        """Yield a state for output times from `before`, excluded, to t, up to rounding such as that of 7 * 0.1 s."""
        times = grid.within(before, just_after(t))
        if len(times):
            q, u = (np.tile(part, (len(times), 1)) for part in state)
            yield Reached(times, (q, u), t, lambda: state)

    def statistics(self) -> dict[str, int | float | str]:
        """Return the counters of the engine, and the numbers of restarts at breakpoints and events."""
        return {**self.engine.statistics(), "breakpoints": self._breakpoints, "events": self._events}


def integrated(
    integrator: Integrator[E],
    start: InitialValues,
    grid: Grid,
    watch: ProgressCallback,
    pays: Callable[[Reached], bool] | None = None,
) -> Trajectory:
    """Integrate with an integrator that may be reused; the contract is in `stiffmbs.solve.trajectory`.

    `pays`: called after each return of the engine. The run ends at `integrator.reached` when it returns False.
    """
    engine, rows, logged = (
        integrator.engine,
        Rows.of(integrator.dynamics.system, grid),
        LOGGER.isEnabledFor(logging.DEBUG),
    )
    rows.append(grid.start, start.q, start.u)
    with Ending() as ending:
        for reached in integrator.run(start, grid, passing=not logged):
            # multipliers are in no error test: those of the output times follow from the accelerations at q and u
            rows.extend(reached.times, *reached.rows)
            if logged and (step := engine.last_step()):
                LOGGER.debug(
                    f"t = {reached.t:.6g} s, step {step[0]:.3g} s{f', order {step[1]}' if step[1] else ''}",
                    extra={"step": step[0], "order": step[1]},
                )
            watch(reached.t)
            grid.look(rows)
            engine.watch.refuse_departures()
            integrator.reached = reached
            engine.refuse(reached, grid)
            if pays and not pays(reached):
                break
            if reached.t < grid.end and engine.steps() >= DIVERGENCE.followed_steps:
                refuse_beyond_sense(integrator.dynamics, rows, reached.t, *reached.state())
    return Trajectory(
        *rows.stored,
        ending.outcome,
        ending.message,
        {**integrator.statistics(), "seconds": ending.seconds},
        engine.history(),
        integrator.note(),
        whole_steps=engine.whole_steps(),
        recorded=tuple(filter(None, [engine.recorded()])),
        departures=engine.watch.departures(),
    )
