"""Conditions on requests: where they become true in a run, and a monitor that ends the run there."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

from ..compile.callbacks import fault_of
from ..dynamics.dynamics import Dynamics, OutputRows
from ..errors import InputError
from ..model.files.stages import Until
from ..results.channels import channels_of
from ..solve.missing_rows import joined_rows
from ..solve.trajectory import ConditionMet

if TYPE_CHECKING:
    from .job import Job

SAME = 1e-9
"""Default part of a bound by which a value has to go back before its condition counts again."""
LOOKS, ROWS = 64, 100
"""A monitor looks after this part of a run, or after this number of rows, whichever comes first; and after this part of the rows, so that
all looks together take a time in proportion to the rows."""


class Series(Protocol):
    """Time histories by name."""

    @property
    def time(self) -> np.ndarray: ...
    def __getitem__(self, name: str, /) -> np.ndarray: ...
    def __contains__(self, name: object, /) -> bool: ...


@dataclass(frozen=True)
class Margin:
    """Margin, negative before a condition becomes true: ``factor (value - bound) + near``, from `armed` on.

    `final`: False if later values may change it, because the bound itself is not met yet.
    """

    channel: str
    factor: float
    bound: float
    near: float
    armed: float
    final: bool

    def __call__(self, solution: Series) -> np.ndarray:
        values = self.factor * (solution[self.channel] - self.bound) + self.near
        return np.where(solution.time >= self.armed, values, np.nan)


@dataclass(frozen=True)
class Crossing:
    """Time at which a condition becomes true, after the row `before` of a solution."""

    name: str
    before: int
    t: float


def channel_of(name: str, request: str, solution: Series) -> np.ndarray:
    """Return the values of a request; raise an InputError that names the condition if there is none."""
    if request not in solution:
        raise InputError(f"'{name}': found request = {request}, expected the name of a request")
    return solution[request]


def margin_of(name: str, condition: Until, whole: Series, fresh: bool) -> Margin:
    """Return the margin of a condition in a run; in a continued run, from where the value has gone back far enough."""
    values = channel_of(name, condition.request, whole)
    bound = next(b for b in (condition.at_least, condition.at_most, condition.equals) if b is not None)
    away = values - bound
    back = max(condition.within, SAME * max(1.0, abs(bound)))
    factor = 1.0 if condition.at_least is not None else -1.0
    far = np.abs(away) > back if condition.equals is not None else factor * away < -back
    rows = np.flatnonzero(far)
    first = 0 if fresh else int(rows[0]) if len(rows) else len(away)
    armed = float(whole.time[first]) if first < len(away) else np.inf
    near, final = 0.0, True
    if condition.equals is not None and first < len(away):
        factor = -1.0 if away[first] > 0 else 1.0
        past = factor * away[first:]
        final = not condition.within or bool(np.nanmax(past) >= 0 or past[0] >= -condition.within)
        near = condition.within if np.nanmax(past) < 0 or past[0] >= -condition.within else 0.0
    return Margin(condition.request, factor, bound, near, armed, final)


def first_crossing(margins: Mapping[str, Margin], solution: Series) -> Crossing | None:
    """Return the first condition that becomes true, with its time by linear interpolation between the rows."""
    found = None
    for name, margin in margins.items():
        values = margin(solution)
        holds = np.flatnonzero((values[:-1] < 0) & (values[1:] >= 0) & (np.diff(solution.time) > 0))
        if not len(holds):
            continue
        k = int(holds[0])
        part = -values[k] / (values[k + 1] - values[k])
        t = float(solution.time[k] + part * (solution.time[k + 1] - solution.time[k]))
        if found is None or t < found.t:
            found = Crossing(name, k, t)
    return found


@dataclass(frozen=True)
class SoFar:
    """Channels of the rows that a run has reached."""

    time: np.ndarray
    channels: Mapping[str, np.ndarray]

    def __getitem__(self, name: str) -> np.ndarray:
        return self.channels[name]

    def __contains__(self, name: object) -> bool:
        return name in self.channels


class Monitor:
    """Conditions on the rows of one integration of a job, which ends it after the first of them.

    Rows are those of the solver, without the corrections of results: where a condition becomes true follows from these.
    The dynamics are the monitor's own, because those of the job have the state of the integrator. `met`: True if it has
    ended the run. `fresh`: see `margin_of`.
    """

    def __init__(self, conditions: Mapping[str, Until], fresh: bool, job: Job) -> None:
        self.met = False
        self._conditions, self._fresh, self._job = conditions, fresh, job
        self._dynamics = Dynamics(job.dynamics.system)
        self._dynamics.place(job.start.q, job.start.u, job.start.lam)
        self._pending = [(np.array([job.grid.start]), job.start.q[None], job.start.u[None])]
        self._rows: OutputRows | None = None
        self._apart = (job.grid.end - job.grid.start) / LOOKS
        self._looked = self._reached = job.grid.start
        self._known, self._new = 0, len(self._pending)
        self._active = True

    def look(self, t: np.ndarray, q: np.ndarray, u: np.ndarray) -> None:
        """Take new rows; raise ConditionMet if a condition has become true that later rows cannot precede."""
        if not (self._active and len(t)):
            return
        if t[0] < self._reached:  # a solver that repeats the run from an earlier time is not ended
            self._active = False
            return
        self._reached = t[-1]
        self._pending.append((t.copy(), q.copy(), u.copy()))
        self._new += len(t)
        if t[-1] - self._looked < self._apart and self._new < max(ROWS, self._known / LOOKS):
            return
        self._looked, self._known, self._new = t[-1], self._known + self._new, 0
        if self._is_met():
            self.met = True
            raise ConditionMet

    def _is_met(self) -> bool:
        """Return True if a condition is true at the start, or the first that has become true is known."""
        pending = [np.concatenate(columns) for columns in zip(*self._pending, strict=True)]
        self._pending.clear()
        system = self._dynamics.system
        new = self._dynamics.report(pending[0], pending[1], pending[2], project=False)
        if len(new.t) < len(pending[0]):  # a row without a solution is filled in later
            self._active = False
            if system.has_functions:
                fault_of(system)  # clears the fault
            return False
        self._rows = joined_rows([self._rows, new]) if self._rows else new
        seen = SoFar(self._rows.t, channels_of(self._job.data, system, self._rows))
        margins = {name: margin_of(name, condition, seen, self._fresh) for name, condition in self._conditions.items()}
        if self._fresh and any(margin(seen)[0] >= 0 for margin in margins.values()):
            return True
        first = first_crossing(margins, seen)
        return first is not None and margins[first.name].final
