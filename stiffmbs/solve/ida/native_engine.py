"""Native driver of IDA for `bdf`, without Python in the step loop."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property, partial
from typing import TYPE_CHECKING, Protocol

import numpy as np

from ...compile.equations import Equations
from ...compile.inputs.features import InputFeatures
from ...dynamics.dynamics import Dynamics
from ...dynamics.storage import allocated, blocks, release
from ...model.settings import RunSettings
from ..error_control.error_test import ErrorControl
from ..error_control.native.parameters import NEWTON, POLISHING
from ..error_control.newton import Stiffness
from ..error_control.stability_limit import StabilityLimitDetection
from ..events.restart import just_after
from ..trajectory import History
from .connection import BDF, Formula
from .engine import Engine, Reached
from .ida import AT_THE_END, NativeIda
from .matrices import Matrix
from .native.parameters import LOOP
from .statistics import Status

if TYPE_CHECKING:
    from ...dynamics.initial import InitialValues
    from .starting.after_event import Begun, EventRestarts, Restarts
    from .starting.starts import Starts


class OrderLimit(Protocol):
    """Highest order of a formula, checked every few steps."""

    order: int
    held: bool

    def forget(self) -> None: ...
    def begin(self, t: float, steps: int, fastest: float) -> None: ...
    def due(self, steps: int) -> bool: ...
    def wait(self, steps: int) -> int: ...
    def changed(self, samples: np.ndarray, steps: int) -> bool: ...
    def note(self, steps: int) -> str: ...


class NativeEngine(Engine):
    """IDA through its C interface (`NativeIda`); implements `stiffmbs.solve.ida.engine.Engine`.

    `equations`: equations in the order of the matrix. `dynamics`: its state is the working memory of residual and
    Jacobian. `formula`: BDF by default. `order`: limit of the order of BDF; detected by default.
    """

    def __init__(
        self, equations: Equations, dynamics: Dynamics, matrix: Matrix, settings: RunSettings, control: ErrorControl,
        formula: Formula | None = None, order: OrderLimit | None = None,
    ) -> None:  # fmt: skip
        tolerances, reported = control.tolerances(equations, settings), equations.independent
        self._ida = NativeIda(
            equations, dynamics.state, matrix, *tolerances, max_step=settings.max_step,
            reported=reported, growth=control.growth,
            formula=formula or BDF(matrix, control.predicted_residual),
            renewal=control.renewal,
        )  # fmt: skip
        self._width, self._equations, self.matrix = len(reported), equations, matrix
        self._rtol = settings.rtol
        self._make_starts = partial(self._ida.starts, dynamics, equations, settings, control)
        self._dynamics = dynamics
        self._started = False
        self._order = order or StabilityLimitDetection(equations, settings)
        self.forget()

    def forget(self) -> None:
        """Discard what earlier runs have left, so that results do not depend on them."""
        self._ida.forget()
        self._order.forget()
        self._newton = 0.0
        self._counted = {"steps": 0, "convergence_failures": 0}

    def see_inputs(self, features: InputFeatures, duration: float) -> None:
        """Take the breakpoints and narrow features of the inputs."""
        self._ida.see_inputs(features, duration)

    def leave_out(self, masked: np.ndarray) -> None:
        """Leave unknowns out of the error test."""
        self._ida.leave_out(masked)

    def begin(self, t: float, y: np.ndarray, yp: np.ndarray, newton: float, stiffness: Stiffness) -> None:
        """Start at consistent values, with the precision of Newton's iteration."""
        self._newton, self._stiffness = newton, stiffness
        self._ida.leave_to_newton(newton)
        self._ida.error_norm.filter_always(self._order.held)
        self._follow_stiffness(t)
        self._ida.begin(t, y, yp, highest_order=self._order.order)

    def begin_at(self, start: InitialValues, t: float) -> bool:
        """Start by one compiled call, from the second start on; return False where it does not apply."""
        if not self._started or self._starts is None:  # not worth their preparation for one start
            self._started = True
            return False
        self._ida.error_norm.filter_always(self._order.held)
        if not self._starts.begin(start, t, self._ida.begun, self._order.order):
            return False
        self._take_up(self._starts, t)
        return True

    def begin_restart(self, q: np.ndarray, u: np.ndarray, t: float, ahead: float) -> Begun | None:
        """Restart after events by one compiled call; return None where it does not apply."""
        if self._starts is None or self._event_restarts is None:
            return None
        self._ida.error_norm.filter_always(self._order.held)
        found = self._event_restarts.begin((q, u), t, ahead, self._ida.begun, self._order.order)
        if found:
            self._take_up(self._starts, found.t)
        return found

    def _take_up(self, starts: Starts, t: float) -> None:
        self._ida.begun_at(t)
        self._stiffness, self._newton = starts.found()
        self._follow_stiffness(t)

    def _follow_stiffness(self, t: float) -> None:
        """Set the correction of states within long steps, and the monitor of vibrations, by the stiffness."""
        stiffness = self._stiffness
        self._ida.correct_outputs(
            self._dynamics,
            stiffness.long_step,
            max(stiffness.allowed_residual, NEWTON.precision / self._rtol),
            POLISHING.unbalanced * self._rtol,
        )
        self._order.begin(t, self._ida.history.count, float(np.sqrt(stiffness.of_positions)))

    def _adapt(self, stop: float) -> None:
        """Adapt Newton's tolerance and the highest order between two calls."""
        self._ease_newton()
        ida = self._ida
        due = just_after(ida.t) < stop and self._order.due(ida.history.count)  # IDA does not start where it is to stop
        if due and self._order.changed(ida.samples, ida.history.count):
            self.begin(ida.t, ida.y.copy(), ida.yp.copy(), self._newton, self._stiffness)
        ida.look_after(self._order.wait(ida.history.count))

    def _ease_newton(self) -> None:
        """Relax Newton's tolerance after many failures in a call: rounding may prevent its convergence."""
        counted = self._ida.counted()
        steps = counted["steps"] - self._counted["steps"]
        failures = counted["convergence_failures"] - self._counted["convergence_failures"]
        self._counted = counted
        if failures > NEWTON.many_failures * steps and self._newton < NEWTON.easiest:
            eased = min(NEWTON.easiest, NEWTON.eased * self._newton)
            self.begin(
                self._ida.t, self._ida.y.copy(), self._ida.yp.copy(), eased, self._stiffness
            )  # IDA reads it only at a start

    def to_times(self, times: np.ndarray, stops: Sequence[float]) -> Iterator[Reached]:
        """Integrate by compiled calls, past stops at which compiled restarts apply; report at output times."""
        status, served, passed = Status.GOING, 0, 0
        event_restarts = self._event_restarts if len(stops) > 1 else None
        if event_restarts is None or not (event_restarts.may_pass and self._ida.may_pass):
            event_restarts, stops = None, stops[:1]
        times = times[: times.searchsorted(stops[-1], side="right")]
        while status is Status.GOING:
            times, stops = times[served:], stops[passed:]
            rows = allocated(len(times), self._width)
            served, status, passed = self._advance(event_restarts, times, stops, rows)
            *earlier, last = list(blocks(served)) or [slice(0, 0)]
            for block in earlier:
                yield self._reached(times[block], rows[block], Status.GOING)
                release(rows)
            yield self._reached(times[last], rows[last], status, passed)
            if status is Status.GOING:
                self._adapt(stops[passed])

    def _advance(
        self, event_restarts: EventRestarts | None, times: np.ndarray, stops: Sequence[float], rows: np.ndarray
    ) -> tuple[int, Status, int]:
        """Integrate to the first stop, or beyond by `event_restarts`; return output times served, status, stops passed."""
        if event_restarts is None:
            return *self._ida.advance(times, stops[0], rows), 0
        before = self._ida.history.count
        served, status = self._ida.advance_past(event_restarts, times, np.array(stops), self._order.order, rows)
        passed, steps = event_restarts.passed
        if passed:
            self._stiffness, self._newton = event_restarts.starts.found()
            self._order.begin(event_restarts.t, before + steps, float(np.sqrt(self._stiffness.of_positions)))
        return served, status, passed

    def by_steps(self, stop: float) -> Iterator[Reached]:
        """Integrate by compiled calls, and report each step."""
        status = Status.GOING
        while status is Status.GOING:
            times, rows = np.empty(LOOP.most_steps), np.empty((LOOP.most_steps, self._width))
            served, status = self._ida.steps(stop, times, rows)
            yield self._reached(times[:served], rows[:served], status)
            if status is Status.GOING:
                self._adapt(stop)

    def _reached(self, times: np.ndarray, rows: np.ndarray, status: Status, passed: int = 0) -> Reached:
        failure = f"{self._ida.failure()}{self._worst()}" if status is Status.FAILED else ""
        fired = tuple(self._ida.roots().nonzero()[0].tolist()) if status is Status.ROOT else ()
        return Reached(times, rows, self._ida.t, self._ida.y, fired, failure, passed)

    def _worst(self) -> str:
        """Return a clause on the unknown with the largest error or Newton correction in the last step, if known."""
        unknown, size = self._ida.worst()
        if not 0.0 < size < np.inf:
            return ""
        at, system = self._equations.at, self._equations.system
        for name, labels in (("q", system.of_body.positions), ("u", system.of_body.velocities)):
            for k in np.flatnonzero(at[name] == unknown).tolist():
                return f"; the largest error was in {system.name_of(k, labels)}"
        return ""

    def restarts(self, dynamics: Dynamics, q: np.ndarray, u: np.ndarray) -> Restarts | None:
        """Return compiled restarts of this integrator from the state q and u; None if they do not apply."""
        from .starting.after_event import Restarts

        if self._starts is None or not Restarts.serve(dynamics.system, self._ida):
            return None
        return Restarts(dynamics, self._starts, (q, u))

    @cached_property
    def _starts(self) -> Starts | None:
        return self._make_starts()

    @cached_property
    def _event_restarts(self) -> EventRestarts | None:
        from .starting.after_event import EventRestarts

        least = NEWTON.precision / self._rtol
        return EventRestarts(self._starts, self._dynamics, least) if self._starts else None

    def at(self, t: float) -> np.ndarray:
        """Return the reported unknowns at a time within the last step, corrected as at output times."""
        return self._ida.reported_at(t)

    @property
    def step(self) -> float:
        """Return the length of the last step, s."""
        return float(self._ida.cells["size"])

    def pause_after(self, steps: int) -> None:
        self._ida.pause_after(steps)

    def keep_steps(self, kept: bool, places: np.ndarray = AT_THE_END) -> None:
        """Enable or disable storage of the steps for `kept_steps`, also at some places within each step, from 0 to 1."""
        self._ida.keep_steps(kept, places)

    def kept_steps(self) -> np.ndarray:
        """Return time, order, y and y' of the steps since the last call; rows at places within a step, without y', precede its end."""
        return self._ida.kept_steps()

    def present(self) -> np.ndarray:
        """Return a row of the same form for the current state."""
        return np.concatenate([[self._ida.t, 1.0], self._ida.y, self._ida.yp])

    def note(self) -> str:
        notes = self._order.note(self._ida.history.count), self._ida.unresolved(), self._ida.output_correction.note()
        return "; ".join(filter(None, notes))

    def steps(self) -> int:
        return self._ida.history.count

    def statistics(self) -> dict[str, int | float | str]:
        return {"linear_solver": self.matrix.sentence(), **self._ida.statistics()}

    @property
    def long_step(self) -> float:
        return self._stiffness.long_step

    def last_step(self) -> tuple[float, int] | None:
        return self._ida.history.last

    def end_steps_at_kinks(self) -> None:
        """End steps at the kinks of tables from now on, and restart IDA there."""
        self._ida.watch.end_steps_at_kinks()

    def long_steps(self) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
        log = self._ida.long_steps
        return log.kept() if log else None

    def displaced(self) -> np.ndarray:
        return self._ida.error_sums.displaced()

    def history(self) -> History:
        return History(self._ida.history.t, self._ida.history.order)
