"""Automatic choice between the explicit integrator and BDF, which a run may repeat as its stiffness changes.

The fastest rate of the motion bounds the explicit steps by stability. It is computed at the start, and when step
rejections indicate that stability, not accuracy, limits the steps. The step size of BDF is not known in advance, as
vibrations may shorten it. BDF is therefore tried, preferably from the start, and kept while it costs less.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from ..compile.callbacks import has_fault
from ..describe.settings import RunSettings
from ..errors import SolverError
from . import bdf, cost
from .dynamics import Dynamics
from .error_control.tolerances import absolute_tolerances
from .events.restart import just_after, just_before, restarted
from .explicit import DOP853
from .explicit.adaptive import AdaptiveRun, Leaving
from .explicit.fastest_rate import fastest_rate
from .explicit.integration import Integration
from .explicit.projected import TRAITS
from .ida.engine import Reached
from .initial import InitialValues
from .integrator import Integrator
from .segments import Segment, joined
from .solver import Traits
from .trajectory import Grid, Outcome, ProgressCallback, Trajectory, unwatched

LOOK = 32
"""Explicit steps between two checks for stiffness."""
HELD_BACK = 0.05
"""Fraction of steps limited by stability from which on the scene counts as stiff."""
LOOK_AT_IMPLICIT = 3.0
"""Cost of the BDF steps between two checks, in BDF starts without their small steps."""
MAY_LOSE = 0.45
"""Fraction of the remaining explicit cost that BDF may lose, in addition to a start, in its first trial; later 0."""
WORTH_A_TRIAL, AT_RTOL, MOST = 7.0, 1e-4, 7.0
"""Remaining explicit cost that justifies a trial, in BDF starts at the tolerance `AT_RTOL`, and its upper bound."""
QUIET, FEWER = 100.0, 1 / 3
"""Velocity change in an explicit step, in tolerances, that excites few vibrations, and a factor on `WORTH_A_TRIAL`."""
AT_REST, FEWEST = 1e-4, 1.5
"""Velocity change that excites no vibrations, in tolerances, and the replacement for `WORTH_A_TRIAL` then."""
DEARER = 1.5
"""Ratio of explicit cost to that of BDF at which BDF is tried again; multiplied by itself after each return."""
AMENDS = 3.0
"""Explicit cost before the next trial, in the cost of a failed trial; it doubles after each further one."""
MOST_MESSAGES = 3
"""Switches of integrator that the note lists."""


def traits(settings: RunSettings) -> Traits:
    """Return the traits of `bdf`. The settings of the explicit scheme, projected `dop853`, are among them."""
    return replace(bdf.traits(settings), name="auto", switches=True)


def solve(
    dynamics: Dynamics, start: InitialValues, grid: Grid, settings: RunSettings, watch: ProgressCallback
) -> Trajectory:
    """Integrate with `dop853`, and with `bdf` while it costs less; the contract is in `stiffmbs.solve.trajectory`."""
    dynamics.forget_pivots()
    return _Shared(dynamics, grid, settings, watch).run(start)


def begins_implicit(dynamics: Dynamics, start: InitialValues, grid: Grid, settings: RunSettings) -> bool:
    """Return True if `bdf` is tried from the start because of the fastest rate there."""
    return _Shared(dynamics, grid, settings, unwatched)._is_stiff_at_once(start)


@dataclass
class _Pace:
    """Time and step counters of the explicit integrator at a check: accepted, attempted, limited by stability."""

    t: float
    steps: int = 0
    tried: int = 0
    held: int = 0


class _Spent(NamedTuple):
    """Totals of the implicit integrator: time of the motion, restarts at breakpoints and events, cost."""

    t: float
    restarts: int
    cost: float

    def since(self, before: _Spent) -> _Spent:
        """Return the totals since an earlier record."""
        return _Spent(self.t - before.t, self.restarts - before.restarts, self.cost - before.cost)


class _Shared:
    """A run shared by two integrators."""

    def __init__(self, dynamics: Dynamics, grid: Grid, settings: RunSettings, watch: ProgressCallback) -> None:
        self._dynamics, self._grid, self._watch = dynamics, grid, watch
        self._settings = settings.model_copy(update={"scheme": "dop853", "projection": True})
        self._explicit_step = cost.of_explicit_step(dynamics)
        self._implicit: Integrator | None = None
        self._costs = cost.ImplicitCost.of(dynamics)
        self._starts = WORTH_A_TRIAL * (AT_RTOL / settings.rtol) ** 0.2  # BDF starts that justify a trial
        self._pace = _Pace(grid.start)
        self._explicit_cost = np.inf  # per second of the motion, where stability limits the steps
        self._implicit_cost = np.inf  # of BDF per second, before it was left
        self._dearer = DEARER
        self._amends = 0.0  # explicit cost before the next trial
        self._segments: list[Segment] = []
        self._messages: list[str] = []
        self._lost = 0.0  # cost of BDF in excess of explicit steps, since it was last lower
        self._may_lose = MAY_LOSE
        self._gave_up = False  # explicit steps failed

    def run(self, start: InitialValues) -> Trajectory:
        """Integrate all segments and join them; rerun with the implicit integrator alone if explicit steps fail.

        They fail at singular poses, near which no integrator can start but which an integrator can pass.
        """
        t: float | None = self._grid.start
        explicit = not self._is_stiff_at_once(start)
        while t is not None:
            try:
                at = start if t == self._grid.start else restarted(self._dynamics, t, *self._state)
            except SolverError as error:
                stopped = replace(self._segments[-1].trajectory, outcome=Outcome.STOPPED, message=str(error))
                self._segments[-1] = replace(self._segments[-1], trajectory=stopped)
                break
            t = self._explicit_segment(at, t) if explicit else self._implicit_segment(at, t)
            explicit = not explicit and not self._gave_up
        return self._together()

    def _is_stiff_at_once(self, start: InitialValues) -> bool:
        """Return True if BDF is to be tried from the start."""
        rate = self._rate_at(self._grid.start, start.q, start.u)
        worth = self._worth_a_trial(self._grid.start, self._starts_from(start, rate))
        if worth:
            self._messages.append(f"bdf, as the fastest rate is {rate:.3g} 1/s")
        return worth

    def _rate_at(self, t: float, q: np.ndarray, u: np.ndarray) -> float:
        """Return the fastest rate at a state, and update the cost of explicit steps by it."""
        rate = fastest_rate(self._dynamics, t, q, u)
        self._explicit_cost = self._explicit_step * rate / DOP853.stability
        return rate

    def _worth_a_trial(self, t: float, starts: float) -> bool:
        """Return True if stability-limited explicit steps up to the end cost more than a number of BDF starts."""
        left, starts = (self._grid.end - t) * self._explicit_cost, min(starts, MOST)
        if self._implicit is None and left > starts * self._costs.start:
            self._implicit = Integrator(self._dynamics, self._settings)
            self._costs = cost.ImplicitCost.of(self._dynamics, self._implicit.factors)
        return left > starts * self._costs.start

    def _starts_from(self, start: InitialValues, rate: float) -> float:
        """Return the BDF starts that explicit steps must cost for a trial, by the vibrations that the start excites."""
        if not rate:
            return self._starts
        system, settings = self._dynamics.system, self._settings
        tolerances = self._dynamics.kept("tolerances", settings, lambda: absolute_tolerances(system, settings))
        change = np.abs(start.acceleration) * (DOP853.stability / rate)
        excited = float((change / (tolerances[system.n_q :] + settings.rtol * np.abs(start.u))).max(initial=0.0))
        return FEWEST if excited < AT_REST else self._starts * (FEWER if excited < QUIET else 1.0)

    def _rest(self, t: float) -> Grid:
        """Return the grid from a time on."""
        times = self._grid.times
        if t == self._grid.start:
            return self._grid
        return replace(self._grid, start=t, times=None if times is None else np.append(t, times[times > t]))

    def _explicit_segment(self, start: InitialValues, t: float) -> float | None:
        """Integrate explicitly from t; return the time at which the integrator was left, or None at the end."""
        self._pace = _Pace(t)
        run = AdaptiveRun(DOP853, self._dynamics, start, self._rest(t), self._settings, self._watch)
        segment = run.integrate(Leaving(LOOK, self._should_try_implicit))
        if run.left and segment.outcome is Outcome.STOPPED and not has_fault(self._dynamics.system):
            self._gave_up, self._segments = True, []
            self._messages = [f"bdf, as explicit steps {segment.message}"]
            return self._grid.start
        self._segments.append(Segment(replace(segment, solver="projected"), TRAITS["dop853"]))
        if not run.left or segment.outcome is Outcome.STOPPED:
            return None
        self._state = run.work.q.copy(), run.work.u.copy()
        return run.work.t

    def _should_try_implicit(self, work: Integration) -> bool:
        """Return True if stability limits the explicit steps and the rest of them would cost far more than a trial."""
        seen = _Pace(
            work.t, work.count("steps"), work.count("steps") + work.count("rejected"), work.count("stiff_steps")
        )
        if seen.steps == self._pace.steps:  # a return at output points only
            return False
        before, self._pace = self._pace, seen
        if self._is_dearer(before, seen):
            return True
        held = (seen.held - before.held) / (seen.steps - before.steps)
        if held < HELD_BACK:
            return False
        if seen.tried * self._explicit_step < self._amends:
            return False
        rest = (self._grid.end - seen.t) / (seen.t - before.t)
        if rest * (seen.tried - before.tried) * self._explicit_step <= MOST * self._costs.start:
            return False  # these include rejected and short steps, which cost more than the rate indicates
        rate = self._rate_at(work.t, work.q, work.u)
        worth = self._worth_a_trial(work.t, self._starts)
        if worth:
            self._messages.append(
                f"bdf from t = {work.t:.4g} s on, as stability held back {100 * held:.0f} % of the steps "
                f"(fastest rate {rate:.3g} 1/s)"
            )
        return worth

    def _is_dearer(self, before: _Pace, seen: _Pace) -> bool:
        """Return True if explicit steps now cost far more than those of BDF did, and the saving exceeds a BDF start."""
        pace = (seen.tried - before.tried) * self._explicit_step / (seen.t - before.t)
        saved = (self._grid.end - seen.t) * (pace - self._dearer * self._implicit_cost)
        if not saved > self._costs.start:
            return False
        self._explicit_cost, self._dearer = pace, DEARER * self._dearer
        self._messages.append(f"bdf from t = {seen.t:.4g} s on, as explicit steps cost more than its own had")
        return True

    def _implicit_segment(self, start: InitialValues, t: float) -> float | None:
        """Integrate with BDF from t; return the time at which the integrator was left, or None at the end."""
        self._implicit = self._implicit or Integrator(self._dynamics, self._settings)
        self._look_after = int(LOOK_AT_IMPLICIT * self._costs.memory / self._costs.step)
        self._implicit.engine.pause_after(self._look_after)
        self._spent, self._lost, self._next_look = self._spent_up_to(t), 0.0, self._implicit.steps() + self._look_after
        pays = None if self._gave_up else self._implicit_pays
        segment = bdf.integrated(self._implicit, start, self._rest(t), self._watch, pays)
        self._segments.append(Segment(replace(segment, solver="bdf"), bdf.traits(self._settings)))
        reached = self._implicit.reached
        if segment.outcome is not Outcome.DONE or reached is None or reached.t >= self._grid.end:
            return None
        self._state = self._implicit.split(reached.y)
        self._may_lose = 0.0
        self._amends = max(AMENDS * (self._costs.start + self._lost), 2.0 * self._amends)
        self._messages.append(
            f"projected again from t = {reached.t:.4g} s on, as bdf took shorter steps than they pay for"
        )
        return reached.t

    def _implicit_pays(self, reached: Reached) -> bool:
        """Return True if the cost of BDF in excess of explicit steps is small compared with their remaining cost."""
        assert self._implicit is not None
        steps = self._implicit.steps()
        if steps < self._next_look or self._is_breakpoint(reached.t):  # an event between two checks
            return True
        self._next_look = steps + self._look_after
        before, self._spent = self._spent, self._spent_up_to(reached.t)
        taken = self._spent.since(before)
        self._implicit_cost = taken.cost / taken.t if taken.t else np.inf
        explicit = taken.t * self._explicit_cost + taken.restarts * cost.STEPS_OF_A_RESTART * self._explicit_step
        self._lost = max(self._lost + taken.cost - explicit, 0.0)
        left = (self._grid.end - reached.t) * self._explicit_cost
        return self._lost <= self._costs.start + self._may_lose * left

    def _is_breakpoint(self, t: float) -> bool:
        """Return True if t is within rounding of an input breakpoint, where no integrator can start."""
        breakpoints = self._dynamics.input_features(self._grid.start, self._grid.end).breakpoints
        return bool(np.any((breakpoints >= just_before(t)) & (breakpoints <= just_after(t))))

    def _spent_up_to(self, t: float) -> _Spent:
        """Return the totals of the implicit integrator so far."""
        assert self._implicit is not None
        counted = self._implicit.statistics()
        restarts = int(counted["breakpoints"]) + int(counted["events"])
        work = self._costs.work(int(counted["residuals"]), int(counted["jacobians"]))
        return _Spent(t, restarts, work)

    def _together(self) -> Trajectory:
        """Join the segments to one trajectory with a note on the switches."""
        messages = self._messages[:MOST_MESSAGES]
        if len(self._messages) > MOST_MESSAGES:
            messages += [f"and so on, {len(self._messages)} changes in all"]
        note = "auto chose " + ", then ".join(
            messages if self._segments[0].traits.implicit else ["projected dop853", *messages]
        )
        parts = [segment.trajectory for segment in self._segments]
        return replace(
            parts[0] if len(parts) == 1 else joined(self._segments),
            note="; ".join([note, *dict.fromkeys(part.note for part in parts if part.note)]),
            solver=", ".join(dict.fromkeys(part.solver for part in parts)),
        )
