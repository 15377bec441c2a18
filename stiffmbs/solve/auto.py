"""Automatic choice between the explicit integrator and an implicit one, which a run may repeat as its stiffness changes.

The fastest rate of the motion bounds the explicit steps by stability. It is computed at the start, and when step
rejections indicate that stability, not accuracy, limits the steps. The step size of the implicit integrator, `bdf` or
`radau`, is not known in advance. It is therefore tried, preferably from the start, and kept while it costs less.
Costs are in the unit of `stiffmbs.solve.cost`; no clock is read.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ..compile.callbacks import has_fault
from ..dynamics.dynamics import Dynamics
from ..dynamics.initial import InitialValues
from ..errors import SolverError
from ..model.settings import RunSettings
from ..tuning import tuned
from .cost import COSTS, Counted, ImplicitCost, of_explicit_step, of_kernels
from .engine import Reached
from .error_control.tolerances import tolerances_of
from .events.restart import restarted
from .explicit.adaptive import AdaptiveSteps
from .explicit.dop853 import DOP853
from .explicit.integration import Integration
from .explicit.stable_step import NOT_ASKED, Rates, rates_at
from .ida.choice import driven
from .ida.native.parameters import LOOP
from .ida.native_engine import NativeEngine
from .integrator import E, Integrator, integrated
from .radau import radau
from .reasons import Reason
from .trajectory import Grid, Outcome, ProgressCallback, Trajectory, in_common, unwatched

EXPLICIT = "projected"
"""Name of the explicit integrator."""
MOST_MESSAGES = 3
"""Switches of integrator that the note lists."""


@dataclass(frozen=True)
class AutoParameters:
    """Parameters of the choice between explicit and implicit steps.

    Source: run times of ``python -m tests.bench.solvers.choice`` and of the scenes in ``tests/solve/test_auto.py``.

    - `steps_per_radian`: implicit steps per radian of a vibration that the start excites, until it has decayed to the
      tolerances.
    - `trial_margin`: saving of a later trial of implicit steps, relative to the cost of their start and of their small
      steps, above which it is justified; and run length above which radau replaces bdf for overdamped motions.
    - `check_interval`: least number of steps up to the next check of implicit steps, relative to those of the segment
      so far.
    - `trial_loss`: loss up to which implicit steps are kept, relative to the cost of explicit steps to the end of the run.
      That of their start is always tolerated.
    """

    steps_per_radian: float = 0.35
    trial_margin: float = 3.0
    check_interval: float = 0.25
    trial_loss: float = 0.05


AUTO = tuned("auto", AutoParameters())


def solve(
    dynamics: Dynamics, start: InitialValues, grid: Grid, settings: RunSettings, watch: ProgressCallback
) -> Trajectory:
    """Integrate with `dop853`, and with `bdf` or `radau` while it costs less; the contract is in `stiffmbs.solve.trajectory`."""
    dynamics.forget_pivots()
    return _AutoRun(dynamics, grid, settings, watch).run(start)


def begins_implicit(dynamics: Dynamics, start: InitialValues, grid: Grid, settings: RunSettings) -> bool:
    """Return True if the implicit integrator is tried from the start because of the fastest rate there."""
    return _AutoRun(dynamics, grid, settings, unwatched).first_trial(start)


def implicit_solver(damping_ratio: float, run_length: float) -> str:
    """Return the name of the implicit integrator, ``bdf`` or ``radau``.

    BDF is taken for overdamped motions if small steps after starts are a large part of the run.
    `damping_ratio`: that of the stiffest motion. `run_length`: number of explicit steps at the cost of steps of bdf,
    relative to the cost of the small steps of radau.
    """
    return "radau" if damping_ratio < 1.0 or run_length > AUTO.trial_margin else "bdf"


def steps_of_decay(excitation: float, damping_ratio: float, radians: float) -> float:
    """Return the implicit steps of a vibration up to its decay to the tolerances, or in all its `radians` to the end of the run.

    `excitation`: change of a velocity by it, in tolerances.
    """
    if excitation <= 1.0:
        return 0.0
    decaying = math.log(excitation) / damping_ratio if damping_ratio > 0.0 else math.inf
    return AUTO.steps_per_radian * min(decaying, radians)


class Interval(NamedTuple):
    """Implicit steps between two checks: the time at their middle, s, and their cost per second of the motion."""

    middle: float
    rate: float


def cost_ahead(first: Interval, last: Interval, begin: float, end: float) -> float:
    """Return the cost of implicit steps if their rate falls on as that of a decaying vibration does.

    `first`, `last`: intervals since the start. `begin`, `end`: of the steps, s. Steps follow a root of the amplitude, which
    is an exponential too.
    """
    if not 0.0 < last.rate < first.rate:
        return last.rate * (end - begin)
    constant = (last.middle - first.middle) / math.log(first.rate / last.rate)
    at_begin = last.rate * math.exp((last.middle - begin) / constant)
    return -at_begin * constant * math.expm1((begin - end) / constant)


class Implicit:
    """Implicit integrator, created when it is needed.

    - `name`: ``bdf`` or ``radau``; empty before it is chosen.
    - `cost`: cost of the chosen integrator with its linear solver. Before that is chosen too, a lower bound; before
      the integrator is chosen, that of `bdf`, which is the least.
    - `growth`: cost of the small steps after a start or a breakpoint.
    - `start`: cost of a switch to these steps, including the small ones.
    """

    def __init__(self, dynamics: Dynamics, settings: RunSettings) -> None:
        self._dynamics, self._settings = dynamics, settings
        self.change("", False)

    def change(self, name: str, final: bool = True) -> None:
        """Change to an integrator, without steps at first; it stays to the end of the run if it is `final`."""
        self.name, self._final = name, final
        self.cost, self.growth, self.start = self._estimated(name or "bdf", final)
        for made in ("integrator", "engine"):
            vars(self).pop(made, None)

    def choose(self, rates: Rates, explicit_steps: float, pieces: int) -> None:
        """Choose the integrator by the rates of the motion about a state, unless its linear solver is chosen.

        `explicit_steps`: explicit steps in place of implicit ones. `pieces`: number of starts and restarts.
        """
        if not self._final:
            (of_bdf, *_), (_, growth, _) = self._estimated("bdf", False), self._estimated("radau", False)
            run_length = explicit_steps * of_bdf.step / (pieces * growth)
            self.change(implicit_solver(rates.damping_ratio, run_length), False)

    def confirm(self) -> None:
        """Confirm the chosen integrator, `bdf` if none is chosen, and estimate its cost with its linear solver."""
        if not self._final:
            self.change(self.name or "bdf")

    def _estimated(self, name: str, final: bool) -> tuple[ImplicitCost, float, float]:
        """Return the costs of an integrator, estimated once for a system."""
        return self._dynamics.once(_costs, self._settings, name, final, name=f"costs of {name}, {final}")

    @cached_property
    def integrator(self) -> Integrator[NativeEngine]:
        """The integrator, without steps at first."""
        return Integrator(self._dynamics, self._settings, self.engine)

    @cached_property
    def engine(self) -> NativeEngine:
        """Its engine."""
        return driven(self._dynamics, self._settings, **_driver(self.name)).engine

    def steps(self, t: float) -> Counted:
        """Return the steps of all segments, the last of which has reached the time t."""
        if not self.integrator.engine.steps():
            return Counted(t, 0.0)
        counted = self.integrator.statistics()
        cost = self.cost.work(int(counted["residuals"]), int(counted["factorizations"]))
        long = self.engine.steps() if self.name == "radau" else 0
        return Counted(t, cost, restarts=int(counted["breakpoints"]) + int(counted["events"]), long=long)


def _costs(dynamics: Dynamics, settings: RunSettings, name: str, final: bool) -> tuple[ImplicitCost, float, float]:
    """Estimate the costs of an integrator, with its linear solver if it is final, or lower bounds."""
    factors = 1e-3 * driven(dynamics, settings, **_driver(name)).cost if final else None
    found = (radau.of_radau if name == "radau" else ImplicitCost.of)(dynamics, factors)
    growth = -math.log10(settings.rtol) * found.start_steps * found.step
    return found, growth, found.memory + growth


def _with_dop853(dynamics: Dynamics, settings: RunSettings) -> RunSettings:
    return settings.model_copy(update={"scheme": "dop853", "projection": True})


def _driver(name: str) -> dict[str, Any]:
    """Return how an integrator is driven (`stiffmbs.solve.ida.choice.driven`)."""
    return radau.driver() if name == "radau" else {}


class ImplicitCheck:
    """Check of the implicit steps of a segment: they are kept while their loss is tolerable, or if the rest of them costs less.

    `rate`: cost of implicit steps per second of the motion, the lesser of that in this segment and in its last interval. A segment
    may begin with small steps, and end with a loss. `loss`: cost in excess of explicit steps, since it was last lower.
    """

    def __init__(self, run: _AutoRun, t: float) -> None:
        self._run, self._implicit = run, run.implicit
        self._counted, self._begun = self._implicit.steps(t), self._implicit.engine.steps()
        self._first = self._counted
        self.rate, self.loss = np.inf, 0.0
        self._intervals: deque[Interval] = deque(maxlen=3)
        self._wait()

    def __call__(self, reached: Reached) -> bool:
        """Add the loss since the last check; return True if the implicit integrator is kept."""
        t, run = reached.t, self._run
        if self._implicit.engine.steps() < self._next or t <= self._counted.time or run.is_breakpoint(t):
            return True  # an event between two checks
        counted = self._implicit.steps(t)
        taken, self._counted = counted.since(self._counted), counted
        self.rate = min(counted.since(self._first).rate, taken.rate)
        self.loss = max(self.loss + taken.cost - run.explicit_cost(taken.time, taken.restarts, taken.long), 0.0)
        gains = self._gains(Interval(t - 0.5 * taken.time, taken.rate))
        return self._wait() > 0.0 or gains

    def _gains(self, last: Interval) -> bool:
        """Return True if the rest of the implicit steps costs less by the decay of their cost in the last three intervals.

        Earlier ones, such as that of the small steps after a start, do not show how it goes on.
        """
        self._intervals.append(last)
        first, t = self._intervals[0], self._counted.time
        remaining = self._run.remaining(t)
        return first is last or cost_ahead(first, last, t, t + remaining) < self._run.explicit_cost(remaining, 0)

    def _wait(self) -> float:
        """Set the next check, before which average steps do not exceed the tolerable loss; return the remaining loss."""
        engine, run = self._implicit.engine, self._run
        ahead = run.explicit_cost(run.remaining(self._counted.time), 0)
        left = max(self._implicit.start, AUTO.trial_loss * ahead) - self.loss
        taken = engine.steps() - self._begun
        steps = min(left / self._implicit.cost.step, LOOP.most_steps)
        every = max(int(steps), int(AUTO.check_interval * taken), 1)
        self._next = engine.steps() + every
        engine.ida.pause_after(every)
        return left


class _ExplicitFailure(Exception):
    """Explicit steps failed; the message gives time and reason."""


class _Left(NamedTuple):
    """Time and state at which a segment was left to the other integrator."""

    t: float
    q: np.ndarray
    u: np.ndarray


class _AutoRun:
    """A run shared by two integrators.

    `implicit`: the implicit integrator. `explicit_step`: cost of an explicit step. Two thresholds rise with each switch,
    to bound the number of switches: the ratio of explicit to implicit cost at which implicit steps are resumed, and the
    explicit cost of a segment before the next trial of implicit steps.
    """

    def __init__(self, dynamics: Dynamics, grid: Grid, settings: RunSettings, watch: ProgressCallback) -> None:
        self._dynamics, self._grid, self._watch = dynamics, grid, watch
        self._settings = dynamics.once(_with_dop853, settings)
        self.implicit = Implicit(dynamics, self._settings)
        self._breakpoints = dynamics.input_features(grid.start, grid.end).breakpoints
        self.explicit_step, self._evaluation = dynamics.once(of_explicit_step), dynamics.once(of_kernels)
        self._explicit_rate = np.inf  # cost per second of the motion
        self._implicit_rate = np.inf  # the same of implicit steps, before they were left
        self._return_ratio, self._penalty = 1.0, 0.0
        self._segments: list[Trajectory] = []
        self._messages: list[str] = []

    def run(self, start: InitialValues) -> Trajectory:
        """Integrate all segments and join them; rerun with the implicit integrator alone if steps fail.

        Explicit steps fail at singular poses, near which no integrator can start but which an integrator can pass.
        Steps of `radau` fail where constraints are nearly dependent; `bdf` passes most of these.
        """
        try:
            self._alternate(start)
        except _ExplicitFailure as failure:
            self.implicit.confirm()
            self._rerun_implicit(start, f"explicit integration {failure}")
        last = self._segments[-1]
        no_step = Reason.NO_STEP.ended(last.message) and not has_fault(self._dynamics.system)
        if last.solver == "radau" and no_step:
            self._rerun_with_bdf(start, last)
        return self._joined()

    def _alternate(self, start: InitialValues) -> None:
        """Integrate by both integrators in turn, up to the end or a failure."""
        explicit, t = not self.first_trial(start), self._grid.start
        while True:
            left = self._explicit_segment(start, t) if explicit else self._implicit_segment(start, t)
            if left is None:
                return
            try:
                start, t = restarted(self._dynamics, *left), left.t
            except SolverError as error:
                self._segments[-1] = replace(self._segments[-1], outcome=Outcome.STOPPED, message=str(error))
                return
            explicit = not explicit

    def _explicit_segment(self, start: InitialValues, t: float) -> _Left | None:
        """Integrate explicitly from t; return the state at which implicit steps are to follow, or None at the end of the run."""
        grid, settings, dynamics = self._rest(t), self._settings, self._dynamics
        engine = AdaptiveSteps(
            DOP853, dynamics, start, grid, settings, first=max(int(self.implicit.start / self.explicit_step), 1)
        )
        work, before, counted = engine.work, dynamics.state.evaluations, Counted(t, 0.0)

        def stays(reached: Reached) -> bool:
            """Compare the steps since the last check with the implicit integrator; return False if that is to follow."""
            nonlocal counted
            accepted, last = work.count("steps"), counted
            if not engine.due or accepted == last.accepted:  # a return at output points only
                return True
            accelerations = work.count("accelerations")
            others = dynamics.state.evaluations - before - accelerations  # such as those of event functions
            spent = self.explicit_step * accelerations / DOP853.stages + self._evaluation * others
            counted = Counted(work.t, spent, accepted, work.count("stiff_steps"))
            steps = counted.since(last)
            if NOT_ASKED < work.stable < work.h:  # the bound keeps the steps shorter than those counted as limited
                steps = steps._replace(limited=steps.accepted)
            return not (self._resumes_implicit(steps, work.t) or self._tries_implicit(steps, counted, work))

        integrator = Integrator(dynamics, settings, engine)
        trajectory = engine.ended(integrated(integrator, start, grid, self._watch, stays))
        if engine.failed and trajectory.outcome is Outcome.STOPPED and not has_fault(dynamics.system):
            raise _ExplicitFailure(trajectory.message)
        return self._left(integrator, replace(trajectory, solver=EXPLICIT))

    def _implicit_segment(self, start: InitialValues, t: float) -> _Left | None:
        """Integrate with the implicit integrator from t; return the state at which explicit steps follow, or None at the end of the run."""
        integrator = self.implicit.integrator
        check = ImplicitCheck(self, t)
        trajectory = integrated(integrator, start, self._rest(t), self._watch, check)
        left = self._left(integrator, replace(trajectory, solver=self.implicit.name))
        if left:
            self._implicit_rate = check.rate
            self._penalty = max(self.implicit.start + check.loss, 2.0 * self._penalty)
            self._messages.append(
                f"projected again from t = {left.t:.4g} s on (the steps of {self.implicit.name} had become too short)"
            )
        return left

    def _left(self, integrator: Integrator[E], segment: Trajectory) -> _Left | None:
        """Append a segment; return the state at which it was left, or None at the end of the run."""
        self._segments.append(segment)
        reached = integrator.reached
        if segment.outcome is not Outcome.DONE or reached is None or reached.t >= self._grid.end:
            return None
        return _Left(reached.t, *integrator.on_constraints(reached))

    def _rerun_with_bdf(self, start: InitialValues, stopped: Trajectory) -> None:
        """Integrate the whole run with `bdf`, because no step of `radau` succeeds; keep the run that goes further."""
        kept = self._segments, self._messages
        self.implicit.change("bdf")
        self._rerun_implicit(start, f"no step of radau succeeds at t = {stopped.t[-1]:.4g} s")
        if self._segments[-1].t[-1] < stopped.t[-1]:
            self._segments, self._messages = kept

    def _rerun_implicit(self, start: InitialValues, cause: str) -> None:
        """Integrate the whole run with the implicit integrator."""
        trajectory = integrated(self.implicit.integrator, start, self._grid, self._watch)
        self._segments = [replace(trajectory, solver=self.implicit.name)]
        self._messages = [f"{self.implicit.name}, because {cause}"]

    def first_trial(self, start: InitialValues) -> bool:
        """Return True to begin with the implicit integrator, because stability would limit explicit steps."""
        t, implicit = self._grid.start, self.implicit
        rates = rates_at(self._dynamics, t, start.q, start.u)
        rate, pieces = self._stable_rate(rates), 1 + self._breakpoints_after(t)
        explicit_cost = self.remaining(t) * rate + (pieces - 1) * COSTS.restart_steps * self.explicit_step
        implicit.choose(rates, self.remaining(t) * rate / self.explicit_step, pieces)
        decay = self._decay(rates, t, start.u)

        def pays() -> bool:
            """Compare explicit steps with small implicit ones and a decay, or with a trial that fails, if that costs more."""
            of_decay = decay * implicit.cost.work(implicit.cost.step_residuals, 0)  # it keeps its matrices
            least = max(pieces * implicit.growth + of_decay, implicit.start)
            return least < explicit_cost - implicit.growth  # the growth is what a failed trial loses

        return self._confirmed(pays) and self._switched(f" (fastest rate {rates.fastest:.3g} 1/s)", rate)

    def _tries_implicit(self, steps: Counted, segment: Counted, work: Integration) -> bool:
        """Return True to try the implicit integrator, because stability limits explicit steps.

        `steps`: those since the last check. `segment`: those of the whole segment.
        """
        if not steps.limited or segment.cost < self._penalty:
            return False
        t, share = work.t, steps.limited / steps.accepted
        saving = share * steps.rate * self.remaining(t)
        if not saving > self._justifying(t):
            return False
        rates = rates_at(self._dynamics, t, work.q.copy(), work.u.copy())
        rate = self._stable_rate(rates)
        self.implicit.choose(rates, saving / self.explicit_step, 1 + self._breakpoints_after(t))
        why = f"stability limited {100 * share:.0f} % of the explicit steps, fastest rate {rates.fastest:.3g} 1/s"
        pays = self._confirmed(lambda: min(saving, self.remaining(t) * rate) > self._justifying(t))
        return pays and self._switched(f" from t = {t:.4g} s on ({why})", rate)

    def _resumes_implicit(self, steps: Counted, t: float) -> bool:
        """Return True to resume the implicit integrator, because explicit steps cost more."""
        if not self.remaining(t) * (steps.rate - self._return_ratio * self._implicit_rate) > self.implicit.start:
            return False
        self._return_ratio *= 2.0
        return self._switched(f" again from t = {t:.4g} s on (explicit steps cost more)", steps.rate)

    def _confirmed(self, pays: Callable[[], bool]) -> bool:
        """Return True if implicit steps pay, first by lower bounds of their cost, then by that with their linear solver."""
        if not pays():
            return False
        self.implicit.confirm()
        return pays()

    def _switched(self, reason: str, explicit_rate: float) -> bool:
        """Note a switch to the implicit integrator, and the cost of explicit steps per second with which it is compared."""
        self._explicit_rate = explicit_rate
        self._messages.append(f"{self.implicit.name}{reason}")
        return True

    def _stable_rate(self, rates: Rates) -> float:
        """Return the cost of explicit steps per second if stability limits them."""
        return self.explicit_step * rates.fastest / DOP853.stability

    def _decay(self, rates: Rates, t: float, u: np.ndarray) -> float:
        """Return the implicit steps of the vibration that accelerations excite, up to its decay."""
        if not rates.fastest:
            return np.inf
        system, settings = self._dynamics.system, self._settings
        absolute = self._dynamics.once(tolerances_of, settings)
        excitation = float((rates.velocity / (absolute[system.n_q :] + settings.rtol * np.abs(u))).max(initial=0.0))
        return steps_of_decay(excitation, rates.decay_ratio, rates.excited * self.remaining(t))

    def _breakpoints_after(self, t: float) -> int:
        """Return the number of input breakpoints after a time."""
        return len(self._breakpoints) - int(self._breakpoints.searchsorted(t, side="right"))

    def _justifying(self, t: float) -> float:
        """Return the saving that justifies a switch to implicit steps, with small steps after each breakpoint."""
        return AUTO.trial_margin * (self.implicit.start + self._breakpoints_after(t) * self.implicit.growth)

    def remaining(self, t: float) -> float:
        """Return the time of the motion after t, s."""
        return self._grid.end - t

    def explicit_cost(self, duration: float, restarts: int, fewest: int = 0) -> float:
        """Return the cost of explicit steps over a time of the motion, s, with restarts: `fewest` steps, or as stability requires."""
        of_steps = max(duration * self._explicit_rate, fewest * self.explicit_step)
        return of_steps + restarts * COSTS.restart_steps * self.explicit_step

    def is_breakpoint(self, t: float) -> bool:
        """Return True if t is an input breakpoint, or just before or after one; no integrator can start there."""
        return bool(np.any(np.abs(self._breakpoints - t) <= 2.0 * self._grid.aside))

    def _rest(self, t: float) -> Grid:
        """Return the grid from a time on."""
        times = self._grid.times
        if t == self._grid.start:
            return self._grid
        return replace(self._grid, start=t, times=None if times is None else np.append(t, times[times > t]))

    def _joined(self) -> Trajectory:
        """Join the segments to one trajectory with a note on the switches."""
        messages = self._messages[:MOST_MESSAGES]
        if len(self._messages) > MOST_MESSAGES:
            messages += [f"and so on, {len(self._messages)} changes of integrator"]
        parts = self._segments
        if parts[0].solver == EXPLICIT:
            messages.insert(0, "projected dop853")
        note = "; ".join(["auto chose " + ", then ".join(messages), *dict.fromkeys(p.note for p in parts if p.note)])
        if len(parts) == 1:
            return replace(parts[0], note=note)
        implicit = [part for part in parts if part.solver != EXPLICIT]  # its counters begin at its first start
        counted = [*(part for part in parts if part.solver == EXPLICIT), *implicit[-1:]]
        t, q, u = (
            np.concatenate([getattr(part, name)[int(k > 0) :] for k, part in enumerate(parts)]) for name in "tqu"
        )
        return replace(parts[-1], t=t, q=q, u=u, recorded=(), **{**in_common(parts, counted), "note": note})
