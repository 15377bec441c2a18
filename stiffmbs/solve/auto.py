"""Automatic choice between the explicit integrator and an implicit one, which a run may repeat as its stiffness changes.

The fastest rate of the motion bounds the explicit steps by stability. It is computed at the start, and when step
rejections indicate that stability, not accuracy, limits the steps. The step size of the implicit integrator, `bdf` or
`radau`, is not known in advance. It is therefore tried, preferably from the start, and kept while it costs less.
The choice is in `stiffmbs.solve.auto_choice`.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ..compile.callbacks import has_fault
from ..dynamics.dynamics import Dynamics
from ..dynamics.initial import InitialValues
from ..errors import SolverError
from ..model.settings import RunSettings
from . import bdf
from .auto_checks import ExplicitCheck, ImplicitCheck
from .auto_choice import Choice, Switch
from .events.restart import restarted
from .explicit import DOP853
from .explicit.adaptive import AdaptiveRun, Leaving
from .explicit.projected import TRAITS
from .reasons import Reason
from .segments import Segment, joined
from .trajectory import Grid, Outcome, ProgressCallback, Trajectory

MOST_MESSAGES = 3
"""Switches of integrator that the note lists."""


def solve(
    dynamics: Dynamics, start: InitialValues, grid: Grid, settings: RunSettings, watch: ProgressCallback
) -> Trajectory:
    """Integrate with `dop853`, and with `bdf` or `radau` while it costs less; the contract is in `stiffmbs.solve.trajectory`."""
    dynamics.forget_pivots()
    return _AutoRun(dynamics, grid, settings, watch).run(start)


def begins_implicit(dynamics: Dynamics, start: InitialValues, grid: Grid, settings: RunSettings) -> bool:
    """Return True if the implicit integrator is tried from the start because of the fastest rate there."""
    return Choice(dynamics, grid, settings).first_trial(start) is not None


class _ExplicitFailure(Exception):
    """Explicit steps failed; the message gives time and reason."""


class _Left(NamedTuple):
    """Time and state at which a segment was left to the other integrator."""

    t: float
    q: np.ndarray
    u: np.ndarray


class _AutoRun:
    """A run shared by two integrators."""

    def __init__(self, dynamics: Dynamics, grid: Grid, settings: RunSettings, watch: ProgressCallback) -> None:
        self._dynamics, self._grid, self._watch = dynamics, grid, watch
        changes = {"scheme": "dop853", "projection": True}
        self._settings = dynamics.kept("settings of auto", settings, lambda: settings.model_copy(update=changes))
        self._choice = Choice(dynamics, grid, self._settings)
        self._implicit = self._choice.implicit
        self._segments: list[Segment] = []
        self._messages: list[str] = []

    def run(self, start: InitialValues) -> Trajectory:
        """Integrate all segments and join them; rerun with the implicit integrator alone if steps fail.

        Explicit steps fail at singular poses, near which no integrator can start but which an integrator can pass.
        Steps of `radau` fail where constraints are nearly dependent; `bdf` passes most of these.
        """
        try:
            self._alternate(start)
        except _ExplicitFailure as failure:
            self._implicit.confirm()
            self._rerun_implicit(start, f"explicit integration {failure}")
        last = self._segments[-1].trajectory
        no_step = Reason.NO_STEP.ended(last.message) and not has_fault(self._dynamics.system)
        if last.solver == "radau" and no_step:
            self._rerun_with_bdf(start, last)
        return self._joined()

    def _alternate(self, start: InitialValues) -> None:
        """Integrate by both integrators in turn, up to the end or a failure."""
        trial, t = self._choice.first_trial(start), self._grid.start
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

    def _explicit_segment(self, start: InitialValues, t: float) -> _Left | None:
        """Integrate explicitly from t; return the state at which implicit steps are to follow, or None at the end of the run."""
        run = AdaptiveRun(DOP853, self._dynamics, start, self._rest(t), self._settings, self._watch)
        check = ExplicitCheck(self._choice, t)
        trajectory = run.integrate(Leaving(self._choice.first_check(), check))
        stopped = trajectory.outcome is Outcome.STOPPED
        if run.left and stopped and not has_fault(self._dynamics.system):
            raise _ExplicitFailure(trajectory.message)
        self._segments.append(Segment(replace(trajectory, solver="projected"), TRAITS["dop853"]))
        if stopped or not run.left:
            return None
        assert check.switch is not None
        self._switch(check.switch)
        return _Left(run.work.t, run.work.q.copy(), run.work.u.copy())

    def _implicit_segment(self, start: InitialValues, t: float) -> _Left | None:
        """Integrate with the implicit integrator from t; return the state at which explicit steps follow, or None at the end of the run."""
        integrator = self._implicit.integrator
        check = ImplicitCheck(self._choice, t)
        trajectory = bdf.integrated(integrator, start, self._rest(t), self._watch, check)
        self._segments.append(Segment(replace(trajectory, solver=self._implicit.name), self._implicit.traits()))
        reached = integrator.reached
        if trajectory.outcome is not Outcome.DONE or reached is None or reached.t >= self._grid.end:
            return None
        self._choice.leave_implicit(check.rate, check.loss)
        self._messages.append(
            f"projected again from t = {reached.t:.4g} s on (the steps of {self._implicit.name} had become too short)"
        )
        return _Left(reached.t, *integrator.on_constraints(reached))

    def _rerun_with_bdf(self, start: InitialValues, stopped: Trajectory) -> None:
        """Integrate the whole run with `bdf`, because no step of `radau` succeeds; keep the run that goes further."""
        kept = self._segments, self._messages
        self._implicit.change("bdf")
        self._rerun_implicit(start, f"no step of radau succeeds at t = {stopped.t[-1]:.4g} s")
        if self._segments[-1].trajectory.t[-1] < stopped.t[-1]:
            self._segments, self._messages = kept

    def _rerun_implicit(self, start: InitialValues, cause: str) -> None:
        """Integrate the whole run with the implicit integrator."""
        trajectory = bdf.integrated(self._implicit.integrator, start, self._grid, self._watch)
        self._segments = [Segment(replace(trajectory, solver=self._implicit.name), self._implicit.traits())]
        self._messages = [f"{self._implicit.name}, because {cause}"]

    def _switch(self, switch: Switch) -> None:
        """Continue with the implicit integrator."""
        self._choice.follow(switch)
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
            messages += [f"and so on, {len(self._messages)} changes of integrator"]
        if not self._segments[0].traits.implicit:
            messages.insert(0, "projected dop853")
        parts = [segment.trajectory for segment in self._segments]
        notes = ["auto chose " + ", then ".join(messages), *dict.fromkeys(part.note for part in parts if part.note)]
        return replace(
            parts[0] if len(parts) == 1 else joined(self._segments),
            note="; ".join(notes),
            solver=", ".join(dict.fromkeys(part.solver for part in parts)),
        )
