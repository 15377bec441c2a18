"""Automatic choice between the explicit integrator and an implicit one, which a run may repeat as its stiffness changes.

The fastest rate of the motion bounds the explicit steps by stability. It is computed at the start, and when step
rejections indicate that stability, not accuracy, limits the steps. The step size of the implicit integrator, `bdf` or
`radau`, is not known in advance. It is therefore tried, preferably from the start, and kept while it costs less.
The criteria are in `stiffmbs.solve.auto_decisions`.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ..compile.callbacks import has_fault
from ..dynamics.dynamics import Dynamics
from ..dynamics.initial import InitialValues
from ..errors import SolverError
from ..model.settings import RunSettings
from . import bdf, cost
from .auto_decisions import (
    AUTO,
    AutoParameters,
    ExplicitSteps,
    ImplicitSteps,
    Thresholds,
    implicit_solver,
    loss_of_trial,
    saving_by_return,
    since,
    steps_of_decay,
    tolerable_loss,
)
from .error_control.newton import Stiffness, stiffness_at
from .error_control.tolerances import absolute_tolerances
from .events.restart import just_after, just_before, restarted
from .explicit import DOP853
from .explicit.adaptive import AdaptiveRun, Leaving
from .explicit.integration import Integration
from .explicit.projected import TRAITS
from .explicit.stable_step import NOT_ASKED, fastest_rate
from .ida.engine import Reached
from .integrator import Integrator
from .radau import radau
from .segments import Segment, joined
from .solver import Traits
from .trajectory import Grid, Outcome, ProgressCallback, Trajectory, unwatched

MOST_MESSAGES = 3
"""Switches of integrator that the note lists."""


def traits(settings: RunSettings) -> Traits:
    """Return the traits of `bdf` and `radau`. The settings of the explicit scheme, projected `dop853`, are among them."""
    reads = dict.fromkeys((*bdf.traits(settings).reads, *radau.traits(settings).reads))
    return replace(bdf.traits(settings), name="auto", reads=tuple(reads), switches=True)


def solve(
    dynamics: Dynamics, start: InitialValues, grid: Grid, settings: RunSettings, watch: ProgressCallback
) -> Trajectory:
    """Integrate with `dop853`, and with `bdf` or `radau` while it costs less; the contract is in `stiffmbs.solve.trajectory`."""
    dynamics.forget_pivots()
    return _AutoRun(dynamics, grid, settings, watch).run(start)


def begins_implicit(dynamics: Dynamics, start: InitialValues, grid: Grid, settings: RunSettings) -> bool:
    """Return True if the implicit integrator is tried from the start because of the fastest rate there."""
    return _AutoRun(dynamics, grid, settings, unwatched).first_trial(start) is not None


class _ExplicitFailure(Exception):
    """Explicit steps cannot go on; the message says where and why."""


class _Switch(NamedTuple):
    """Switch to the implicit integrator.

    Attributes
    ----------
    reason : str
    explicit_rate : float
        Cost of explicit steps per second of the motion, with which the implicit one is compared.
    thresholds : Thresholds
        Thresholds from then on.
    """

    reason: str
    explicit_rate: float
    thresholds: Thresholds


class _Left(NamedTuple):
    """Time and state at which a segment was left to the other integrator."""

    t: float
    q: np.ndarray
    u: np.ndarray


class _Implicit:
    """Implicit integrator, created when it or its cost is needed.

    Attributes
    ----------
    name : str
        ``bdf`` or ``radau``; empty before it is chosen.
    cost : ImplicitCost
        Cost of the chosen integrator with its linear solver. Before it exists, a lower bound; before it is chosen, that
        of `bdf`, which is the least.
    """

    def __init__(self, dynamics: Dynamics, settings: RunSettings) -> None:
        self._dynamics, self._settings = dynamics, settings
        self.name, self._created = "", False
        self._estimate(None)

    def choose(self, stiffness: Stiffness) -> None:
        """Choose the integrator by the stiffness of a state, unless one exists."""
        if not self._created:
            self.name = implicit_solver(stiffness.damping_ratio)
            self._estimate(None)

    def create(self) -> None:
        """Create the chosen integrator, unless it exists, and estimate its cost."""
        if not self._created:
            create = radau.radau_integrator if self.name == "radau" else Integrator
            self.integrator, self._created = create(self._dynamics, self._settings), True
            self._estimate(self.integrator.factors)

    def _estimate(self, factors: float | None) -> None:
        of_bdf = cost.ImplicitCost.of(self._dynamics, factors)
        self.cost = radau.of_radau(of_bdf) if self.name == "radau" else of_bdf

    @property
    def growth(self) -> float:
        """Cost of the small steps after a start or a breakpoint."""
        return -math.log10(self._settings.rtol) * self.cost.start_steps * self.cost.step

    @property
    def start(self) -> float:
        """Cost of a switch to these steps, including the small ones."""
        return self.cost.memory + self.growth

    def traits(self) -> Traits:
        """Return the traits of the solver."""
        return (radau if self.name == "radau" else bdf).traits(self._settings)

    def steps(self, t: float) -> ImplicitSteps:
        """Return the steps of all segments, the last of which has reached the time t."""
        if not self.integrator.steps():
            return ImplicitSteps(t, 0, 0, 0.0)
        counted = self.integrator.statistics()
        restarts = int(counted["breakpoints"]) + int(counted["events"])
        long = self.integrator.steps() if self.name == "radau" else 0
        return ImplicitSteps(
            t, restarts, long, self.cost.work(int(counted["residuals"]), int(counted["factorizations"]))
        )


class _ExplicitCheck:
    """Check of the explicit steps of a segment: they may be left to the implicit integrator.

    Attributes
    ----------
    switch : _Switch or None
        Switch that the last check decided on.
    """

    def __init__(self, run: _AutoRun, t: float) -> None:
        self._run, self._before = run, run.evaluations
        self._counted = ExplicitSteps(t, 0, 0, 0.0)
        self.switch: _Switch | None = None

    def __call__(self, work: Integration) -> bool:
        """Compare the steps since the last check with the implicit integrator; return True if that is to follow."""
        accepted = work.count("steps")
        if accepted == self._counted.accepted:  # a return at output points only
            return False
        spent = self._run.explicit_step * (self._run.evaluations - self._before) / DOP853.stages
        counted = ExplicitSteps(work.t, accepted, work.count("stiff_steps"), spent)
        steps, self._counted = since(self._counted, counted), counted
        if NOT_ASKED < work.stable < work.h:  # the bound holds the steps below what the integrator counts as limited
            steps = steps._replace(limited=steps.accepted)
        self.switch = self._run.returned(steps, work.t) or self._run.later_trial(steps, counted, work)
        return self.switch is not None


class _ImplicitCheck:
    """Check of the implicit steps of a segment: they are kept while their loss is tolerable.

    Attributes
    ----------
    rate : float
        Cost of implicit steps per second of the motion in the last interval.
    loss : float
        Cost in excess of explicit steps, since it was last lower.
    """

    def __init__(self, run: _AutoRun, implicit: _Implicit, t: float) -> None:
        self._run, self._implicit = run, implicit
        self._counted, self._begun = implicit.steps(t), implicit.integrator.steps()
        self.rate, self.loss = np.inf, 0.0
        self._wait(t)

    def __call__(self, reached: Reached) -> bool:
        """Add the loss since the last check; return True if the implicit integrator is kept."""
        if self._implicit.integrator.steps() < self._next or self._run.is_breakpoint(reached.t):
            return True  # an event between two checks
        counted = self._implicit.steps(reached.t)
        taken, self._counted = since(self._counted, counted), counted
        self.rate = taken.cost / taken.time if taken.time else np.inf
        self.loss = loss_of_trial(
            self.loss, taken.cost, self._run.explicit_cost(taken.time, taken.restarts, taken.long)
        )
        return self._wait(reached.t) > 0.0

    def _wait(self, t: float) -> float:
        """Set the next check, before which average steps do not exceed the tolerable loss; return what is left of that."""
        following = self._run.explicit_cost(self._run.remaining(t), 0)
        left = tolerable_loss(self._implicit.start, self._run.thresholds.loss, following) - self.loss
        integrator = self._implicit.integrator
        taken = integrator.steps() - self._begun
        every = max(int(left / self._implicit.cost.step), int(self._run.parameters.check_interval * taken), 1)
        self._next = integrator.steps() + every
        integrator.engine.pause_after(every)
        return left


class _AutoRun:
    """A run shared by two integrators.

    Parameters
    ----------
    dynamics : Dynamics
    grid : Grid
    settings : RunSettings
    watch : ProgressCallback
    parameters : AutoParameters

    Attributes
    ----------
    thresholds : Thresholds
        Current ones.
    """

    def __init__(
        self,
        dynamics: Dynamics,
        grid: Grid,
        settings: RunSettings,
        watch: ProgressCallback,
        parameters: AutoParameters = AUTO,
    ) -> None:
        self._dynamics, self._grid, self._watch, self.parameters = dynamics, grid, watch, parameters
        self._settings = settings.model_copy(update={"scheme": "dop853", "projection": True})
        self._implicit = _Implicit(dynamics, self._settings)
        self._breakpoints = dynamics.input_features(grid.start, grid.end).breakpoints
        self.explicit_step = cost.of_explicit_step(dynamics)
        self._explicit_rate = np.inf  # cost per second of the motion
        self._implicit_rate = np.inf  # the same of implicit steps, before they were left
        self.thresholds = Thresholds()
        self._segments: list[Segment] = []
        self._messages: list[str] = []

    def run(self, start: InitialValues) -> Trajectory:
        """Integrate all segments and join them; rerun with the implicit integrator alone if explicit steps fail.

        They fail at singular poses, near which no integrator can start but which an integrator can pass.
        """
        try:
            self._alternate(start)
        except _ExplicitFailure as failure:
            self._rerun_implicit(start, str(failure))
        return self._joined()

    def _alternate(self, start: InitialValues) -> None:
        """Integrate by both integrators in turn, up to the end or a failure."""
        trial, t = self.first_trial(start), self._grid.start
        explicit = trial is None
        if trial:
            self._switch(trial)
        while True:
            left = self._explicit_segment(start, t) if explicit else self._implicit_segment(start, t)
            if left is None:
                return
            try:
                start, t = restarted(self._dynamics, *left), left.t
            except SolverError as error:
                self._stop(str(error))
                return
            explicit = not explicit

    def first_trial(self, start: InitialValues) -> _Switch | None:
        """Return the decision to begin with the implicit integrator, because stability would limit explicit steps; None to begin explicit."""
        t = self._grid.start
        fastest = fastest_rate(self._dynamics, t, start.q, start.u)
        rate = self._stable_rate(fastest)
        pieces = 1 + self._breakpoints_after(t)
        explicit_cost = self.remaining(t) * rate + (pieces - 1) * cost.COSTS.restart_steps * self.explicit_step
        if not explicit_cost > pieces * self._implicit.growth:
            return None
        stiffness = self._stiffness(t, start.q, start.u)
        self._implicit.choose(stiffness)
        if not explicit_cost > pieces * self._implicit.growth:
            return None
        decay = steps_of_decay(self.parameters, self._excitation(start, fastest), fastest, stiffness.of_velocities)
        self._implicit.create()
        if not explicit_cost > pieces * self._implicit.growth + decay * self._implicit.cost.step:
            return None
        return _Switch(f"{self._implicit.name}, as the fastest rate is {fastest:.3g} 1/s", rate, self.thresholds)

    def later_trial(self, steps: ExplicitSteps, segment: ExplicitSteps, work: Integration) -> _Switch | None:
        """Return the decision to try the implicit integrator, because stability limits explicit steps; None to go on with these.

        Parameters
        ----------
        steps : ExplicitSteps
            Steps since the last check.
        segment : ExplicitSteps
            Steps of the whole segment.
        work : Integration
        """
        if not steps.limited or segment.cost < self.thresholds.penalty:
            return None
        self._implicit.choose(self._stiffness(work.t, work.q, work.u))
        share = steps.limited / steps.accepted
        saving = share * steps.cost * self.remaining(work.t) / steps.time
        if not saving > self._justifying(work.t):
            return None
        fastest = fastest_rate(self._dynamics, work.t, work.q, work.u)
        rate = self._stable_rate(fastest)
        self._implicit.create()
        if not min(saving, self.remaining(work.t) * rate) > self._justifying(work.t):
            return None
        reason = (
            f"{self._implicit.name} from t = {work.t:.4g} s on, as stability held back {100 * share:.0f} % of the "
            f"steps (fastest rate {fastest:.3g} 1/s)"
        )
        return _Switch(reason, rate, self.thresholds.of_trial(share))

    def returned(self, steps: ExplicitSteps, t: float) -> _Switch | None:
        """Return the decision to resume the implicit integrator, because explicit steps cost more than its own did; None to go on with these."""
        rate = steps.cost / steps.time
        saving = saving_by_return(rate, self._implicit_rate, self.thresholds.return_ratio, self._grid.end - t)
        if not saving > self._implicit.start:
            return None
        reason = f"{self._implicit.name} from t = {t:.4g} s on, as explicit steps cost more than its own had"
        return _Switch(reason, rate, self.thresholds.after_return())

    def _stable_rate(self, fastest: float) -> float:
        """Return the cost of explicit steps per second if stability limits them, for a fastest rate in 1/s."""
        return self.explicit_step * fastest / DOP853.stability

    def _excitation(self, start: InitialValues, fastest: float) -> float:
        """Return the largest change of a velocity in a step limited by stability, in tolerances."""
        if not fastest:
            return np.inf
        system, settings = self._dynamics.system, self._settings
        tolerances = self._dynamics.kept("tolerances", settings, lambda: absolute_tolerances(system, settings))
        change = np.abs(start.acceleration) * (DOP853.stability / fastest)
        return float((change / (tolerances[system.n_q :] + settings.rtol * np.abs(start.u))).max(initial=0.0))

    def _stiffness(self, t: float, q: np.ndarray, u: np.ndarray) -> Stiffness:
        """Return the stiffness of a state."""
        self._dynamics.state.q[:], self._dynamics.state.u[:] = q, u
        return stiffness_at(self._dynamics, t)

    def _breakpoints_after(self, t: float) -> int:
        """Return the number of input breakpoints after a time."""
        return int(np.sum(self._breakpoints > t))

    def _justifying(self, t: float) -> float:
        """Return the saving that justifies a switch to implicit steps, with small steps after each breakpoint."""
        small = self._implicit.start + self._breakpoints_after(t) * self._implicit.growth
        return self.parameters.trial_margin * small

    @property
    def evaluations(self) -> int:
        """Return the number of evaluations of the equations so far, including those of event functions."""
        return self._dynamics.state.evaluations

    def remaining(self, t: float) -> float:
        """Return the time of the motion after t, s."""
        return self._grid.end - t

    def explicit_cost(self, duration: float, restarts: int, fewest: int = 0) -> float:
        """Return the cost of explicit steps over a time of the motion, s, with restarts: `fewest` steps, or as stability requires."""
        of_steps = max(duration * self._explicit_rate, fewest * self.explicit_step)
        return of_steps + restarts * cost.COSTS.restart_steps * self.explicit_step

    def is_breakpoint(self, t: float) -> bool:
        """Return True if t is within rounding of an input breakpoint, where no integrator can start."""
        return bool(np.any((self._breakpoints >= just_before(t)) & (self._breakpoints <= just_after(t))))

    def _explicit_segment(self, start: InitialValues, t: float) -> _Left | None:
        """Integrate explicitly from t; return the state at which implicit steps are to follow, or None at the end of the run.

        Raises
        ------
        _ExplicitFailure
            If explicit steps cannot go on.
        """
        run = AdaptiveRun(DOP853, self._dynamics, start, self._rest(t), self._settings, self._watch)
        check = _ExplicitCheck(self, t)
        trajectory = run.integrate(Leaving(self._first_check(), check))
        stopped = trajectory.outcome is Outcome.STOPPED
        if run.left and stopped and not has_fault(self._dynamics.system):
            raise _ExplicitFailure(trajectory.message)
        self._segments.append(Segment(replace(trajectory, solver="projected"), TRAITS["dop853"]))
        if stopped or not run.left:
            return None
        assert check.switch is not None
        self._switch(check.switch)
        return _Left(run.work.t, run.work.q.copy(), run.work.u.copy())

    def _first_check(self) -> int:
        """Return the explicit steps of a segment that cost as much as a switch."""
        return max(int(self._implicit.start / self.explicit_step), 1)

    def _implicit_segment(self, start: InitialValues, t: float) -> _Left | None:
        """Integrate with the implicit integrator from t; return the state at which explicit steps follow, or None at the end of the run."""
        integrator = self._implicit.integrator
        check = _ImplicitCheck(self, self._implicit, t)
        trajectory = bdf.integrated(integrator, start, self._rest(t), self._watch, check)
        self._segments.append(Segment(replace(trajectory, solver=self._implicit.name), self._implicit.traits()))
        reached = integrator.reached
        if trajectory.outcome is not Outcome.DONE or reached is None or reached.t >= self._grid.end:
            return None
        self._implicit_rate = check.rate
        self.thresholds = self.thresholds.after_failed_trial(self._implicit.start + check.loss)
        self._messages.append(
            f"projected again from t = {reached.t:.4g} s on, as {self._implicit.name} took shorter steps than they pay for"
        )
        return _Left(reached.t, *integrator.split(reached.y))

    def _rerun_implicit(self, start: InitialValues, message: str) -> None:
        """Integrate the whole run with the implicit integrator, because explicit steps have failed."""
        self._implicit.create()
        trajectory = bdf.integrated(self._implicit.integrator, start, self._grid, self._watch)
        self._segments = [Segment(replace(trajectory, solver=self._implicit.name), self._implicit.traits())]
        self._messages = [f"{self._implicit.name}, as explicit steps {message}"]

    def _switch(self, switch: _Switch) -> None:
        """Continue with the implicit integrator."""
        self._explicit_rate, self.thresholds = switch.explicit_rate, switch.thresholds
        self._messages.append(switch.reason)

    def _stop(self, message: str) -> None:
        """End the run with the last segment."""
        last = self._segments[-1]
        stopped = replace(last.trajectory, outcome=Outcome.STOPPED, message=message)
        self._segments[-1] = replace(last, trajectory=stopped)

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
            messages += [f"and so on, {len(self._messages)} changes in all"]
        if not self._segments[0].traits.implicit:
            messages.insert(0, "projected dop853")
        parts = [segment.trajectory for segment in self._segments]
        notes = ["auto chose " + ", then ".join(messages), *dict.fromkeys(part.note for part in parts if part.note)]
        return replace(
            parts[0] if len(parts) == 1 else joined(self._segments),
            note="; ".join(notes),
            solver=", ".join(dict.fromkeys(part.solver for part in parts)),
        )
