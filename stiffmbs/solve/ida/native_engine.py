"""Driver of IDA or Radau methods, without Python in the step loop."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ...compile.equations import Equations
from ...dynamics.algebraic_states import no_value_ahead
from ...dynamics.dynamics import Dynamics
from ...dynamics.storage import allocated, blocks, release
from ...errors import SolverError
from ...model.settings import RunSettings
from ..engine import Begun, Engine, Reached
from ..error_control.error_test import ErrorControl
from ..error_control.native.parameters import NEWTON
from ..error_control.precision import governed_by_rounding, too_fine
from ..error_control.relaxation import RELAXATION, refuse_drift
from ..error_control.stability_limit import StabilityLimitDetection
from ..events.chattering import CHATTERING
from ..events.refusals import refuse_beyond_limits
from ..events.restart import restarted
from ..events.whole_steps import WholeSteps
from ..explicit.native.parameters import CONTROL
from ..linear_solvers.linear_solver import LinearSolver
from ..radau.collocation import radau
from ..reasons import Reason
from ..recorded_steps import Piece, StepRecorder
from ..stiff_rows import States
from ..trajectory import Grid, History, Recording, just_after
from .connection import BDF, Formula
from .ida import AT_THE_END, NativeIda
from .native.parameters import LOOP
from .statistics import Status

if TYPE_CHECKING:
    from ...compile.inputs.features import InputFeatures
    from ...dynamics.initial import InitialValues
    from .starts import Starts


class NativeEngine(Engine):
    """IDA through its C interface, `ida`, with the decisions between its calls.

    `equations`: equations in the order of the matrix. `dynamics`: its state is the working memory of residual and
    Jacobian. `formula`: BDF by default.
    """

    def __init__(
        self, equations: Equations, dynamics: Dynamics, matrix: LinearSolver, settings: RunSettings, control: ErrorControl,
        formula: Formula | None = None,
    ) -> None:  # fmt: skip
        tolerances, reported = control.tolerances(equations, settings), equations.independent
        self.ida = NativeIda(
            equations, dynamics.state, matrix, *tolerances, max_step=settings.max_step,
            reported=reported,
            formula=formula or BDF(control.predicted_residual),
            renewal=None if formula else control.renewal,
        )  # fmt: skip
        self._width, self.equations, self.matrix = len(reported), equations, matrix
        self._by_radau = formula is not None
        self.recorder: StepRecorder | None = None
        self._settings = settings
        self._dynamics, self._control = dynamics, control
        self.watch = self.ida.watch
        self.watch.follow_reactions(dynamics)
        self._order = StabilityLimitDetection(
            equations, settings, is_active=formula is None and settings.max_order is None
        )
        self.forget()

    def forget(self) -> None:
        """Discard what earlier runs have left, so that results do not depend on them."""
        self.ida.forget()
        if self.recorder:
            self.ida.keep_steps(False)
            self.recorder = None
        self._order.forget()
        self._newton = 0.0
        self._counted = {"steps": 0, "convergence_failures": 0}

    def begin_run(self, features: InputFeatures, grid: Grid) -> None:
        """See `Engine`."""
        self.ida.see_inputs(features, grid.end - grid.start)
        self._gap = 2.0 * grid.aside
        if grid.recorded.most:
            self._record_steps(grid.recorded)

    def _record_steps(self, bounds: Recording) -> None:
        """Record the steps of the run for an estimate of its errors, up to some work."""
        places = AT_THE_END
        if self._by_radau:
            from ..radau.memory import CHOSEN_FROM

            places = radau(max(CHOSEN_FROM) + 2).nodes[:-1]  # points at which the curve through fewer has defects
        self.ida.keep_steps(True, places)
        system = self.equations.system
        of_a_row = bounds.row + bounds.solution * (system.n_q + system.n_u + system.n_c) ** 1.5
        self.recorder = StepRecorder(bounds, 1 + len(places), of_a_row)

    def recorded(self) -> tuple[Piece, ...]:
        """Return the recorded steps, none if there were too many, and stop recording."""
        recorder, self.recorder = self.recorder, None
        if recorder is None:
            return ()
        self.ida.keep_steps(False)
        return recorder.pieces(self.equations)

    def _record(self, fired: tuple[int, ...]) -> None:
        """Move the steps since the last return of IDA to the record."""
        if self.recorder:
            self.recorder.extend(self.ida.kept_steps(), fired)
            if self.recorder.full:
                self.ida.keep_steps(False)
                self.recorder = None

    def begin_at(self, start: InitialValues, t: float) -> None:
        """See `Engine`."""
        self._starts.begin(start, t, self._order.order)
        self._take_up(t)

    def begin_restart(self, q: np.ndarray, u: np.ndarray, t: float, ahead: float, stop: float) -> Begun:
        """See `Engine`."""
        found = self._starts.restart((q, u), t, ahead, stop, self._order.order)
        if found is None:  # a force is beyond its limits, unless this raises
            start = restarted(self._dynamics, t, q, u)
            refuse_beyond_limits(self._dynamics, t, start.q, start.u)
            self.begin_at(start, t)
            return Begun(t, False, True)
        self._take_up(found.t)
        return found

    def _resume(self, newton: float) -> None:
        """Start again at the current unknowns, with a part of the tolerance that Newton's iteration may leave."""
        self._starts.resume(newton, self._order.order)
        self._take_up(self.ida.t)

    def _take_up(self, t: float) -> None:
        self.ida.begun_at(t)
        self.ida.error_norm.filter_always(self._order.held)
        self._newton = self._starts.newton
        self.ida.correct_outputs(self._dynamics, self._starts.may_stiffen)
        self._order.begin(t, self.ida.history.count)
        if self.recorder:
            self.recorder.begin(self.present())

    def _adapt(self, stop: float) -> None:
        """Adapt Newton's tolerance and the highest order between two calls."""
        self._ease_newton()
        ida = self.ida
        due = just_after(ida.t) < stop and self._order.due(ida.history.count)  # IDA does not start where it is to stop
        if due and self._order.changed(ida.samples, ida.history.count):
            self._resume(self._newton)
        ida.look_after(self._order.wait(ida.history.count))

    def _ease_newton(self) -> None:
        """Relax Newton's tolerance after many failures: rounding may prevent its convergence.

        Calls of a few steps, as those of a simulation, are counted together up to the number of steps of a call in a run.
        """
        counted = self.ida.counters.total()
        steps = counted["steps"] - self._counted["steps"]
        if steps < self.ida.usual_steps:
            return
        failures = counted["convergence_failures"] - self._counted["convergence_failures"]
        if steps >= NEWTON.trusted:
            self._counted = counted
        if failures > NEWTON.many_failures * max(steps, NEWTON.trusted) and self._newton < NEWTON.easiest:
            self._counted = counted
            eased = min(NEWTON.easiest, NEWTON.eased * self._newton)
            self._resume(eased)  # IDA reads it only at a start

    def advance(self, times: np.ndarray | None, stops: Sequence[float]) -> Iterator[Reached]:
        """See `Engine`."""
        return self._by_steps(stops[0]) if times is None else self._to_times(times, stops)

    def _to_times(self, times: np.ndarray, stops: Sequence[float]) -> Iterator[Reached]:
        """Report at output times, and go past stops at which compiled restarts apply."""
        status, served, passed = Status.GOING, 0, 0
        if not (len(stops) > 1 and self.ida.may_pass and self._starts.may_pass):
            stops = stops[:1]
        times = times[: times.searchsorted(stops[-1], side="right")]
        while status is Status.GOING:
            times, stops = times[served:], stops[passed:]
            rows = allocated(len(times), self._width)
            served, status, passed = self._advance(times, stops, rows)
            *earlier, last = list(blocks(served)) or [slice(0, 0)]
            for block in earlier:
                yield self._reached(times[block], rows[block], Status.GOING)
                release(rows)
            yield self._reached(times[last], rows[last], status, passed)
            if status is Status.GOING:
                self._adapt(stops[passed])

    def _advance(self, times: np.ndarray, stops: Sequence[float], rows: np.ndarray) -> tuple[int, Status, int]:
        """Integrate to the first stop, or to the last of several; return output times served, status, stops passed."""
        if len(stops) == 1:
            return *self.ida.advance(times, stops[0], rows), 0
        before, starts = self.ida.history.count, self._starts
        starts.resume_after(self._gap)
        served, status = self.ida.advance_past(starts, times, np.array(stops), self._order.order, rows)
        passed, steps = starts.passed
        if passed:
            self._newton = starts.newton
            self._order.begin(starts.t, before + steps)
        return served, status, passed

    def _by_steps(self, stop: float) -> Iterator[Reached]:
        """Report each step."""
        status = Status.GOING
        while status is Status.GOING:
            times, rows = np.empty(LOOP.most_steps), np.empty((LOOP.most_steps, self._width))
            served, status = self.ida.steps(stop, times, rows)
            yield self._reached(times[:served], rows[:served], status)
            if status is Status.GOING:
                self._adapt(stop)

    def _reached(self, times: np.ndarray, rows: np.ndarray, status: Status, passed: int = 0) -> Reached:
        failure = f"{self.ida.failure()}{self._worst()}" if status is Status.FAILED else ""
        fired = tuple(self.ida.roots().nonzero()[0].tolist()) if status is Status.ROOT else ()
        self._record(fired)
        states = self.equations.states(rows)
        return Reached(times, states, self.ida.t, lambda: self.split(self.ida.y), fired, failure, passed)

    def _worst(self) -> str:
        """Return a clause on the unknown with the largest error or Newton correction in the last step, if known."""
        unknown, size = self.ida.worst()
        if not 0.0 < size < np.inf:
            return ""
        at, system = self.equations.at, self.equations.system
        for name, labels in (("q", system.of_body.positions), ("u", system.of_body.velocities)):
            for k in np.flatnonzero(at[name] == unknown).tolist():
                return f"; the largest error was in {system.name_of(k, labels)}"
        return ""

    def advance_from(self, q: np.ndarray, u: np.ndarray, t: float, end: float) -> bool:
        """Integrate a state, which is overwritten, to a later time by one compiled call without history.

        Returns False, with the state unchanged, if that needs a run.
        """
        return self._starts.advance((q, u), t, end, self._order.order)

    @cached_property
    def _starts(self) -> Starts:
        from .starts import Starts

        return Starts(self._dynamics, self.equations, self.ida, self._settings, self._control)

    def split(self, y: np.ndarray) -> States:
        """Return q and u of all unknowns."""
        (q,), (u,) = self.equations.states(y[None, self.ida.reported])
        return q, u

    def whole_steps(self) -> tuple[WholeSteps, ...]:
        """See `Engine`."""
        return self.ida.whole_steps.kept(self._dynamics, self.equations.states)

    def refuse(self, reached: Reached, grid: Grid) -> None:
        """See `Engine`: steps that rounding governs, failures, and drift from the constraints end a run."""
        if failure := self._failure(reached, grid):
            raise SolverError(Reason.NO_STEP.of(f"stopped at t = {reached.t:.9g} s: {failure}"))
        if reached.t < grid.end and self.steps() >= RELAXATION.check_interval:
            refuse_drift(self._dynamics, reached.t, *reached.state(), self._settings)

    def _failure(self, reached: Reached, grid: Grid) -> str:
        """Return the reason why the run ends at this state, or an empty string."""
        steps, dynamics = self.steps(), self._dynamics
        endless = (grid.end - reached.t) * steps > CHATTERING.steps_ahead * (reached.t - grid.start)
        by_rounding = steps > CONTROL.enough_steps and (endless or governed_by_rounding(self.statistics()))
        if not (by_rounding or reached.failure):
            return ""
        q, u = reached.state()
        missing = no_value_ahead(dynamics, reached.t, q, u) if reached.failure else ""
        reason = missing or too_fine(dynamics, self._settings, reached.t, q)
        if reason or not reached.failure:
            return reason
        from ..suspect import suspect

        return reached.failure + suspect(dynamics, reached.t, q, u)

    def present(self) -> np.ndarray:
        """Return a row of the same form for the current state."""
        return np.concatenate([[self.ida.t, 1.0], self.ida.y, self.ida.yp])

    def note(self) -> str:
        """See `Engine`."""
        notes = self._order.note(self.ida.history.count), self.watch.note(), self.ida.output_correction.note()
        return "; ".join(filter(None, notes))

    def steps(self) -> int:
        """Return the number of steps since the first start."""
        return self.ida.history.count

    def statistics(self) -> dict[str, int | float | str]:
        """Return the name of the linear solver, and counters since the first start."""
        return {"linear_solver": self.matrix.sentence(), **self.ida.counters.counted()}

    @property
    def long_step(self) -> float:
        return float(self.ida.output_correction.cells["long"])

    def last_step(self) -> tuple[float, int] | None:
        """Return the size, s, and order of the last step, if known."""
        return self.ida.history.last

    def history(self) -> History:
        """Return the ends of the steps, and their orders."""
        t, order, _ = self.ida.history.stored()
        return History(t, order)
