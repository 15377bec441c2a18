"""IDA over the pieces of a run, restarted at breakpoints and events."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from ..dynamics.dynamics import Dynamics
from ..dynamics.initial import InitialValues
from ..model.settings import RunSettings
from .error_control.error_test import CHOSEN, ErrorControl
from .events.chattering import Chattering, HoveringEvents
from .events.discontinuity import Jumps
from .events.native.parameters import SEARCH
from .events.refusals import refuse_beyond_limits
from .events.restart import restarted, straight_on
from .events.whole_steps import WholeSteps
from .ida.choice import Driven, driven_natively
from .ida.native.parameters import LOOP
from .ida.native_engine import Reached
from .stiff_rows import States, projected
from .trajectory import Grid, just_after

Driver = Callable[[Dynamics, RunSettings, ErrorControl], Driven]


def driven(
    dynamics: Dynamics, settings: RunSettings, control: ErrorControl | None = None, memory: str = "bdf",
    driver: Driver = driven_natively,
) -> Driven:  # fmt: skip
    """Return the equations with their engine, which the dynamics keep under the name `memory`."""
    chosen = control or CHOSEN[dynamics.system.of_body.dimensions]
    return dynamics.kept(memory, (settings, chosen), lambda: driver(dynamics, settings, chosen))


class Integrator:
    """IDA over the pieces of a run, from breakpoint to breakpoint and from event to event.

    `memory`: name under which the dynamics keep the engine for the next integrator of that name. `driver`: returns the
    equations, their engine and the cost of its linear solver. `reached`: last return of the engine.
    """

    def __init__(
        self, dynamics: Dynamics, settings: RunSettings, control: ErrorControl | None = None, memory: str = "bdf",
        driver: Driver = driven_natively,
    ) -> None:  # fmt: skip
        self.control = control or CHOSEN[dynamics.system.of_body.dimensions]
        self.dynamics, self.settings = dynamics, settings
        self.reached: Reached | None = None
        found = driven(dynamics, settings, control, memory, driver)
        self.equations, self.engine = found.equations, found.engine
        self.engine.forget()
        self._jumps = Jumps(dynamics, settings)
        self._of_inputs = ""
        self._events = self._breakpoints = 0

    def note(self) -> str:
        """Return the notes on inputs, velocity jumps and the engine."""
        return "; ".join(filter(None, (self._of_inputs, self._jumps.sentence(), self.engine.note())))

    def split(self, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return q and u of a vector of unknowns."""
        (q,), (u,) = self.equations.states(y[None, self.equations.independent])
        return q, u

    def on_constraints(self, reached: Reached) -> tuple[np.ndarray, np.ndarray]:
        """Return q and u that were reached; those after a long step are projected without a change of stiff forces."""
        state, last = self.split(reached.y), self.engine.last_step()
        return self.closed(reached.t, state, last[0]) if last else state

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
        self.engine.ida.see_inputs(features, grid.end - grid.start)
        self._of_inputs = features.note
        chattering = Chattering(self.dynamics, grid.end, self.settings.rtol)
        self._hovering = HoveringEvents(self.dynamics, chattering, self.settings.rtol)
        ready: InitialValues | None = start
        self.engine.resume_after(2.0 * grid.aside)
        stops = [*(grid.with_stops(features.breakpoints) - grid.aside).tolist(), grid.end]
        while stops:
            if just_after(t) >= stops[0]:
                del stops[0]
                continue
            if ready:
                refuse_beyond_limits(self.dynamics, t, ready.q, ready.u)
                self._begin(ready, t)
                chattering.begin(t, ready.q, ready.u)
            for reached in self._segment(t, stops[: LOOP.most_passed if passing else 1], grid):
                del stops[: reached.passed]
                self._breakpoints += reached.passed
                yield reached if not reached.failure else self._explained(reached)
                if reached.t < stops[0] and not (reached.fired or reached.failure):
                    chattering.look(reached.t, *self.split(reached.y), self.steps())
            if reached.failure:
                return
            if reached.t < stops[0]:
                chattering.note_event(reached.t, *self.split(reached.y), reached.fired[0] if reached.fired else -1)
            before = t = reached.t
            if t < grid.end:
                q, u = self.on_constraints(reached)
                if self._hovering.any:
                    self._hovering.note(t, q, u, reached.fired, self.engine.ida.watch.farthest)
                at_breakpoint = t >= stops[0]
                if at_breakpoint:
                    before = t = t + 2.0 * grid.aside
                    yield from self._at_once(reached.t, t, grid, (q, u))
                    q = self.dynamics.system.of_body.moved(q, 2.0 * grid.aside * u)
                ready, t = self._restarted(q, u, before, t, self._ahead(reached, stops[0]), chattering)
                if not at_breakpoint:
                    state = self.dynamics.state
                    yield from self._at_once(before, t, grid, (state.q, state.u))
                self._events += not at_breakpoint
                self._breakpoints += at_breakpoint

    def _begin(self, start: InitialValues, t: float) -> None:
        self.engine.ida.watch.watch_for(self._hovering.band)
        self.engine.begin_at(start, t)

    def _restarted(
        self, q: np.ndarray, u: np.ndarray, before: float, t: float, ahead: float, chattering: Chattering
    ) -> tuple[InitialValues | None, float]:
        """Restart at t from a state reached at `before`, past events within `ahead`.

        Return consistent values to start from, or None if the engine has restarted, and their time. Raises SolverError if
        there are none.
        """
        self.engine.ida.watch.watch_for(self._hovering.band)
        begun = self.engine.begin_restart(q, u, t, ahead)
        if begun is None:  # a force is beyond its limits, unless this raises
            return restarted(self.dynamics, t, q, u), t
        state = self.dynamics.state
        if begun.jumps:
            self._note_jump(before, q, u, ahead > 0.0)
        if begun.meets:
            chattering.begin(begun.t, state.q.copy(), state.u.copy())
        return None, begun.t

    def _note_jump(self, before: float, q: np.ndarray, u: np.ndarray, event: bool) -> None:
        """Note a jump at a restart; the current state is that after it.

        A state that was interpolated to an event within a step may violate the constraints just before it as well. So may
        velocities that a formulation does not test.
        """
        dynamics, state, last = self.dynamics, self.dynamics.state, self.engine.last_step()
        if not event:
            if self._jumps.is_jump(state.u - u):
                u = self._closed_velocities(dynamics.sides(before)[0], q, u)
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

    def steps(self) -> int:
        """Return the number of steps so far."""
        return self.engine.steps()

    def whole_steps(self) -> tuple[WholeSteps, ...]:
        """Return the steps that are to be checked after the run."""
        kept = self.engine.ida.whole_steps.kept()
        return (WholeSteps.of(self.dynamics, self.equations, *kept),) if len(kept[0]) else ()

    def _explained(self, reached: Reached) -> Reached:
        """Replace a failure by one that names the chattering force, if there is one."""
        jumping = self._hovering.failed(reached.t, *self.split(reached.y))
        return reached._replace(failure=jumping or reached.failure)

    def _segment(self, t: float, stops: list[float], grid: Grid) -> Iterator[Reached]:
        """Integrate from t to the first stop or past it, or to the first event."""
        if grid.times is None:
            return self.engine.by_steps(stops[0])
        return self.engine.to_times(grid.within(just_after(t), stops[-1]), stops)

    def _at_once(self, before: float, t: float, grid: Grid, state: States) -> Iterator[Reached]:
        """Yield a state for output times from `before`, excluded, to t, up to rounding such as that of 7 * 0.1 s."""
        times = grid.within(before, just_after(t))
        if len(times):
            y = np.zeros(self.equations.n)
            y[self.equations.independent] = self.equations.coordinates.state(*state)
            yield Reached(times, np.tile(y[self.equations.independent], (len(times), 1)), t, y)

    def statistics(self) -> dict[str, int | float | str]:
        """Return the linear solver, IDA's counters, and the numbers of restarts at breakpoints and events."""
        return {**self.engine.statistics(), "breakpoints": self._breakpoints, "events": self._events}
