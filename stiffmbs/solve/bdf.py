"""BDF of variable order and step: SUNDIALS IDA, as Adams' GSTIFF."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from ..compile.equations import ABSENT
from ..describe.settings import RunSettings
from ..errors import SolverError
from .algebraic_states import no_value_ahead, rates_of_algebraic
from .dynamics import Dynamics
from .error_control.error_test import CHOSEN, ErrorControl
from .error_control.newton import newton_tolerance, stiffness_at
from .error_control.precision import SLOW, governed_by_rounding, too_fine
from .error_control.relaxation import relax
from .events.chattering import Chattering
from .events.divergence import FOLLOWED_STEPS, refuse_beyond_sense
from .events.limits import refuse_beyond_limits
from .events.long_steps import LongSteps
from .events.masked import MaskedEvents
from .events.restart import just_after, restarted_past, straight_on
from .events.velocity_jumps import WORTH_TELLING, VelocityJumps
from .formulations import READ_BY_FORMULATIONS
from .ida.choice import dense_cost, driven_by_callbacks, driven_natively
from .ida.engine import Reached
from .ida.libraries import available
from .initial import InitialValues, rates_of
from .solver import Traits
from .step_logging import is_logged, log_step
from .suspect import suspect
from .trajectory import Ending, Grid, ProgressCallback, Rows, Trajectory

MOST_PASSED = 64
"""Breakpoints at which the integrator may start anew before it is heard of."""
READ = ("formulation", "rtol", "atol", "max_step", "max_order")
"""Settings that it follows."""


def traits(settings: RunSettings) -> Traits:
    """Those of the formulation in the settings, which may read settings of its own."""
    of_formulation = READ_BY_FORMULATIONS.get(settings.formulation, ())
    return Traits("bdf", (*READ, *of_formulation), implicit=True)


def solve(
    dynamics: Dynamics, start: InitialValues, grid: Grid, settings: RunSettings, watch: ProgressCallback,
    control: ErrorControl | None = None,
) -> Trajectory:  # fmt: skip
    """Integrate with IDA; the contract is in `stiffmbs.solve.trajectory`.

    At breakpoints in time, and where a force changes its law (a contact closes), the integrator stops and starts anew.
    """
    dynamics.forget_pivots()
    return integrated(Integrator(dynamics, settings, control), start, grid, watch)


def integrated(
    integrator: Integrator,
    start: InitialValues,
    grid: Grid,
    watch: ProgressCallback,
    pays: Callable[[Reached], bool] | None = None,
) -> Trajectory:
    """Integrate with an integrator that may be used again.

    Parameters
    ----------
    pays : callable, optional
        Asked now and then whether to go on; where it does not, the run is left where `integrator.reached` says.
    """
    system = integrator.dynamics.system
    rows = Rows(system.n_q, system.n_u, len(grid.times) if grid.times is not None else 1024)
    rows.append(grid.start, start.q, start.u)
    with Ending() as ending:
        for reached in integrator.run(start, grid, passing=pays is None and not is_logged()):
            rows.extend(reached.times, *integrator.equations.states(reached.rows))
            if is_logged() and (step := integrator.engine.last_step()):
                log_step(reached.t, *step)
            watch(reached.t)
            integrator.reached = reached
            if failure := _failure(integrator, reached):
                raise SolverError(f"stopped at t = {reached.t:.9g} s: {failure}")
            if pays and not pays(reached):
                break
            if reached.t < grid.end and integrator.steps() >= FOLLOWED_STEPS:
                state = integrator.split(reached.y)
                refuse_beyond_sense(integrator.dynamics, rows, reached.t, *state)
    statistics = {**integrator.statistics(), "seconds": ending.seconds}
    history = integrator.engine.history()
    return Trajectory(
        *rows.stored,
        ending.outcome,
        ending.message,
        statistics,
        history,
        integrator.note(),
        long_steps=integrator.long_steps(),
    )


def _failure(integrator: Integrator, reached: Reached) -> str:
    """Why a run ends where it has come; empty where it goes on."""
    by_rounding = integrator.steps() > SLOW and governed_by_rounding(integrator.statistics())
    if not (by_rounding or reached.failure):
        return ""
    q, u = integrator.split(reached.y)
    reason = too_fine(integrator.dynamics, integrator.settings, reached.t, q) if by_rounding else ""
    if reason or not reached.failure:
        return reason
    missing = no_value_ahead(integrator.dynamics, reached.t, q, u)
    return missing or reached.failure + suspect(integrator.dynamics, reached.t, q, u)


class Integrator:
    """IDA over the pieces of a run: from breakpoint to breakpoint, from event to event.

    Parameters
    ----------
    dynamics : Dynamics
    settings : RunSettings
    control : ErrorControl, optional
    memory : str
        The name by which the dynamics keep the engine for the next integrator of that name.

    Attributes
    ----------
    reached : Reached or None
        Where it was last heard of.
    factors : float
        Estimated time for the factors of an iteration matrix and the solutions with them, us.
    """

    def __init__(
        self, dynamics: Dynamics, settings: RunSettings, control: ErrorControl | None = None, memory: str = "bdf"
    ) -> None:
        control = control or CHOSEN[dynamics.system.of_body.dimensions]
        self.dynamics, self.settings, self.control = dynamics, settings, control
        self.reached: Reached | None = None
        self._notes: list[str] = []
        native, reason = available()
        if native:
            self.equations, self.engine, cost = dynamics.kept(
                memory, (settings, control), lambda: driven_natively(dynamics, settings, control)
            )
            self.engine.forget()
        else:
            self.equations, self.engine = driven_by_callbacks(dynamics, settings)
            cost = dense_cost(self.equations.n)
            self._notes.append(
                f"IDA runs through scikit-sundae's callbacks, which is slower, and coarser where forces are very stiff: {reason}"
            )
            if dynamics.system.n_values("event_function"):
                self._notes.append(
                    "contacts and other events that begin and end within one step are not seen this way; set max_step"
                )
        self.factors = 1e-3 * cost
        self._jumps = VelocityJumps(dynamics)
        self._of_inputs = ""
        self._events = self._breakpoints = 0

    def note(self) -> str:
        """What the user should know: how IDA runs, jumps of velocities, an order held down."""
        return "; ".join(filter(None, (*self._notes, self._of_inputs, self._jumps.sentence(), self.engine.note())))

    def split(self, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """q and u from a vector of unknowns."""
        (q,), (u,) = self.equations.states(y[None, self.equations.independent])
        return q, u

    def run(self, start: InitialValues, grid: Grid, passing: bool = False) -> Iterator[Reached]:
        """Where the integrator comes at the times of the grid, or after its steps; a failure comes last.

        Parameters
        ----------
        passing : bool
            Whether it may start anew at breakpoints on the way to where it is heard of next.
        """
        t = grid.start
        self._jumps.clear()
        features = self.dynamics.input_features(grid.start, grid.end)
        self.engine.see_inputs(features)
        self._of_inputs = features.note
        chattering = Chattering(self.dynamics, grid.end, self.settings.rtol)
        self._masked = MaskedEvents(self.dynamics, chattering)
        ready: InitialValues | None = start
        stops = [*grid.with_stops(features.breakpoints).tolist(), grid.end]
        while stops:
            if just_after(t) >= stops[0]:
                del stops[0]
                continue
            if ready:
                refuse_beyond_limits(self.dynamics, t, ready.q, ready.u)
                self._begin(ready, t)
                chattering.begin(t, ready.q, ready.u)
            for reached in self._segment(t, stops[: MOST_PASSED if passing else 1], grid):
                del stops[: reached.passed]
                self._breakpoints += reached.passed
                yield reached if not reached.failure else self._explained(reached)
                if reached.t < stops[0] and not (reached.fired or reached.failure):
                    chattering.look(reached.t, *self.split(reached.y), self.steps())
            if reached.failure:
                return
            if reached.fired:
                chattering.note_event(reached.t, *self.split(reached.y), reached.fired[0])
            before = t = reached.t
            if t < grid.end:
                q, u = self.split(reached.y)
                if self._masked.any:
                    self._masked.note(t, q, u, self.steps(), reached.fired)
                if t >= stops[0]:  # min(2*t, 1) still rises at its breakpoint: what follows is told behind it
                    t = just_after(t)
                ready, t = self._anew(q, u, before, t, self._ahead(reached, stops[0]), chattering)
                yield from self._at_once(before, t, grid)
                self._events += before < stops[0]
                self._breakpoints += before >= stops[0]

    def _anew(
        self, q: np.ndarray, u: np.ndarray, before: float, t: float, ahead: float, chattering: Chattering
    ) -> tuple[InitialValues | None, float]:
        """Go on at t from a state that was reached `before`, and past events on the way `ahead`: consistent values to start from, or None
        where the engine has started, and their time."""
        self.engine.leave_out(self._masked.steps)
        begun = self.engine.begin_anew(q, u, t, ahead)
        if begun is None:
            return self._consistent(q, u, before, t, ahead)
        state = self.dynamics.state
        if begun.jump > WORTH_TELLING:
            self._jumps.note(before, state.u - u)
        if begun.meets:
            chattering.begin(begun.t, state.q.copy(), state.u.copy())
        return None, begun.t

    def _consistent(
        self, q: np.ndarray, u: np.ndarray, before: float, t: float, ahead: float
    ) -> tuple[InitialValues, float]:
        """Consistent values near a state at t that was reached `before`, past events on the way `ahead`, and their time."""
        start, t = restarted_past(self.dynamics, t, q, u, ahead)
        self._jumps.note(before, start.u - u)
        return start, t

    def _ahead(self, reached: Reached, stop: float) -> float:
        """How far beyond an event others that come with it are passed."""
        last = self.engine.last_step() if reached.fired else None
        ahead = straight_on(last[0], self.settings.rtol) if last else 0.0
        return ahead if just_after(reached.t + ahead) < stop else 0.0

    def steps(self) -> int:
        """Taken so far."""
        return self.engine.steps()

    def long_steps(self) -> tuple[LongSteps, ...]:
        """Steps far longer than those before them, as far as they are kept."""
        kept = self.engine.long_steps()
        return (LongSteps.of(self.dynamics, self.equations, *kept),) if kept and len(kept[0]) else ()

    def _explained(self, reached: Reached) -> Reached:
        """A failure in the words of the force that causes it, where it jumps back and forth."""
        jumping = self._masked.failed(reached.t, *self.split(reached.y))
        return reached._replace(failure=jumping or reached.failure)

    def _segment(self, t: float, stops: list[float], grid: Grid) -> Iterator[Reached]:
        """Integrate from t to the first stop or past it, or to the first event."""
        if grid.times is None:
            return self.engine.by_steps(stops[0])
        return self.engine.to_times(grid.within(just_after(t), stops[-1]), stops)

    def _at_once(self, before: float, t: float, grid: Grid) -> Iterator[Reached]:
        """Output times that rounding alone keeps from t, as 0.1 s * 7 from a breakpoint at 0.7 s: theirs is the state at t, at hand.

        Those up to `before` have been given.
        """
        times = grid.within(before, just_after(t))
        if len(times):
            y = np.zeros(self.equations.n)
            y[self.equations.independent] = self.equations.coordinates.state(
                self.dynamics.state.q, self.dynamics.state.u
            )
            yield Reached(times, np.tile(y[self.equations.independent], (len(times), 1)), t, y)

    def _begin(self, start: InitialValues, t: float) -> None:
        self.engine.leave_out(self._masked.steps)
        if not self.engine.begin_at(start, t):
            self._begin_step_by_step(start, t)

    def _begin_step_by_step(self, start: InitialValues, t: float) -> None:
        """A start that does not need the compiled one: for algebraic states, infinite stiffness, and scikit-sundae's callbacks."""
        equations, at = self.equations, self.equations.at
        state, coordinates = self.dynamics.state, equations.coordinates
        rates = rates_of(self.dynamics, t, start)
        state.a[:], state.mu[:] = start.acceleration, 0.0
        equations.start_from(start.q)
        y, yp = np.zeros(equations.n), np.zeros(equations.n)
        y[equations.independent] = coordinates.state(start.q, start.u)
        if len(self.dynamics.system.algebraic_coordinates):
            rates[self.dynamics.system.algebraic_coordinates] = rates_of_algebraic(
                self.dynamics, t, start.q, start.u, start.acceleration
            )
        yp[equations.independent] = coordinates.state(rates, start.acceleration)
        solved = at["lam"] != ABSENT
        multipliers = yp if equations.formulation.integrated else y
        multipliers[at["lam"][solved]] = start.lam[solved]
        relax(self.dynamics, self.settings, t)
        stiffness = stiffness_at(self.dynamics, t)
        newton = self.control.newton or newton_tolerance(stiffness, self.settings)
        self.engine.begin(t, y, yp, newton, stiffness)

    def statistics(self) -> dict[str, int | float | str]:
        """The linear solver, IDA's counters, and how often it started anew."""
        return {**self.engine.statistics(), "breakpoints": self._breakpoints, "events": self._events}
