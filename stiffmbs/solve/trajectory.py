"""Contract of all solvers: arguments and results of an integrator.

A solver is a function in its own file: `solve(dynamics, start, grid, settings, watch) -> Trajectory`. Other
packages read its traits (`stiffmbs.solve.solver`).

1. It starts from consistent initial values and works on the dynamics' state; it knows no kinds of element.
2. It returns the state at every time of `grid`, or at its own steps if the grid's `times` is None.
3. It calls `watch(t)` and `grid.look(rows)` at least a few times a second.
4. If it fails, is interrupted, or ended by the monitor of the grid, it returns the rows so far with the outcome: its loop is in a
   ``with Ending()``.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np

from ..compile.inputs.features import InputFeatures
from ..compile.inputs.interval_arithmetic import ROUNDING
from ..dynamics.storage import STORAGE, allocated, release
from ..errors import ChatteringError, SolverError
from ..model.settings import RunSettings
from ..notes import Note
from .events.native.parameters import INDISTINCT
from .reasons import Reason

if TYPE_CHECKING:
    from ..compile.system import System
    from ..dynamics.dynamics import Dynamics
    from ..dynamics.initial import InitialValues
    from .events.departures import Departure
    from .events.whole_steps import WholeSteps
    from .recorded_steps import Piece

ProgressCallback = Callable[[float], None]
SAME_TIME = 1e-9
"""Largest difference of equal times, relative to a sampling period or to a fixed step."""


def unwatched(t: float) -> None:
    """Ignore the progress."""


def just_before(t: float) -> float:
    """Return the first instant that counts as t."""
    return t - INDISTINCT * abs(t)


def just_after(t: float) -> float:
    """Return the last instant that counts as t: IDA refuses to start towards one nearer than two roundings."""
    return t + INDISTINCT * abs(t)


class Outcome(Enum):
    """Outcome of a run, as a sentence."""

    DONE = "completed"
    INTERRUPTED = "interrupted by the user; the results so far are kept"
    STOPPED = "the solver stopped early; the results so far are kept"


IN_DOUBT = "completed, but the results are in doubt"
"""Sentence in place of `Outcome.DONE` for a run whose notes say that its results may be wrong."""


@dataclass(frozen=True, eq=False)
class History:
    """Steps of a solver.

    `t`: ends of the steps, s. `order`: order of the formula in each step; empty if fixed or unknown.
    """

    t: np.ndarray
    order: np.ndarray


class ConditionMet(Exception):
    """Raised by a monitor where the rows suffice."""


Look = Callable[[np.ndarray, np.ndarray, np.ndarray], None]
"""Called with the times, positions and velocities of new rows, in order; raises ConditionMet to end the run."""


class Recording(NamedTuple):
    """Bounds of the recorded steps: the largest work of the estimate of errors, and the work of a restart and of a row.

    The work of a row for n unknowns is `row` + `solution` n^1.5. `events`: number of restarts after events that do not count.
    """

    most: float = 0.0
    row: float = 0.0
    solution: float = 0.0
    restart: float = 0.0
    events: int = 0


@dataclass(frozen=True, eq=False)
class Grid:
    """Ends of the run, and output times (ends included) or None for the solver's own steps.

    Solvers restart at `stops`, as at input breakpoints: a step ends just before a breakpoint, where every formula has
    its earlier side, and the next one begins just after it. Output at a breakpoint is the state just before it, output at
    the start of a run that just after it. `recorded`: work of an estimate of the errors up to which implicit
    solvers record their steps for it. `monitor`: sees the rows during the run, and may end it.
    """

    start: float
    end: float
    times: np.ndarray | None
    stops: np.ndarray = field(default_factory=lambda: np.empty(0))
    recorded: Recording = Recording()
    monitor: Look | None = None

    def look(self, rows: Rows) -> None:
        """Show new rows to the monitor."""
        if self.monitor:
            self.monitor(*rows.unseen())

    @property
    def aside(self) -> float:
        """Distance from a breakpoint at which steps end and begin, s."""
        return ROUNDING * max(abs(self.start), abs(self.end))

    def before(self, t: np.ndarray, features: InputFeatures) -> np.ndarray:
        """Return times, s, of which those at breakpoints are just before them; the start of the grid is just after one."""
        breakpoints, aside = features.all_breakpoints, self.aside
        before = breakpoints[breakpoints > self.start + 2.0 * aside] - aside
        return np.maximum(_nearest(t, before, aside), self.start)

    def before_breakpoints(self, features: InputFeatures) -> Grid:
        """Return the grid with its output times and end just before breakpoints at them.

        A solver and the evaluation of its rows thus have one side. `shown` returns the times of the grid itself.
        """
        first = self.end if self.times is None or not len(self.times) else self.times[0]
        if not len(features.all_breakpoints) and first >= self.start:  # the start may be just after a sample
            return self
        times = None if self.times is None else self.before(self.times, features)
        return replace(self, end=float(self.before(np.array([self.end]), features)[0]), times=times)

    def shown(self, t: np.ndarray) -> np.ndarray:
        """Return times of which those next to a time of this grid are that time."""
        own = np.array([self.start, self.end]) if self.times is None else self.times
        return _nearest(t, own, self.aside)

    def with_stops(self, breakpoints: np.ndarray) -> np.ndarray:
        """Return the restart times: input breakpoints, and the stops within the run."""
        if not len(self.stops):
            return breakpoints
        return np.union1d(breakpoints, self.stops[(self.stops > self.start) & (self.stops < self.end)])

    def up_to(self, end: float) -> Grid:
        """Return the grid up to a time."""
        return replace(self, end=end, times=None if self.times is None else self.times[self.times <= end])

    def within(self, after: float, until: float) -> np.ndarray:
        """Return the output times in the interval (after, until]."""
        if self.times is None:
            return np.empty(0)
        first, end = self.times.searchsorted((after, until), side="right")
        return self.times[first:end]


def _nearest(t: np.ndarray, known: np.ndarray, apart: float) -> np.ndarray:
    """Return times of which those as near to a known one as the sides of a breakpoint are to each other are that one."""
    if not len(known):
        return t
    k = np.minimum(known.searchsorted(t - 3.0 * apart), len(known) - 1)
    return np.where(np.abs(t - known[k]) <= 3.0 * apart, known[k], t)


@dataclass(frozen=True, eq=False)
class Trajectory:
    """States over time from one run of a solver.

    Attributes
    ----------
    t, q, u : ndarrays, shapes (n,), (n, n_q), (n, n_u)
    outcome : Outcome
    message : str
        One sentence: the outcome, and for an early stop where and why, as a note of the `stiffmbs.solve.reasons.Reason`.
    statistics : dict
        ``steps``, ``seconds`` and other counters of the solver.
    history : History
        The solver's own steps, if known.
    note : str
        Notes for the user, or an empty string.
    solver : str
        Solvers used, if the user did not choose them.
    whole_steps : tuple of WholeSteps
        Steps to be checked after the run, with the motion within them; only for scenes with Python functions.
    recorded : tuple of tuples of Piece
        Recorded steps of each mechanism that was solved separately; empty if they were not recorded.
    departures : tuple of Departure
        Tables whose points the steps have left.
    """

    t: np.ndarray
    q: np.ndarray
    u: np.ndarray
    outcome: Outcome
    message: str
    statistics: Mapping[str, int | float | str]
    history: History = field(default_factory=lambda: History(np.empty(0), np.empty(0, dtype=int)))
    note: str = ""
    solver: str = ""
    whole_steps: tuple[WholeSteps, ...] = ()
    recorded: tuple[tuple[Piece, ...], ...] = ()
    departures: tuple[Departure, ...] = ()

    def stopped_after(self, rows: int, message: str) -> Trajectory:
        """Return the first rows, at least one, as a run that stopped there."""
        t, q, u = (array[: max(rows, 1)] for array in (self.t, self.q, self.u))
        return replace(self, t=t, q=q, u=u, outcome=Outcome.STOPPED, message=message)

    @property
    def step_times(self) -> np.ndarray:
        """Ends of the solver's own steps, s."""
        return self.history.t


class Ending:
    """Context manager that records how a run ends: by a `SolverError`, an interruption, its monitor, or normally.

    A run that its monitor ends counts as interrupted, up to `stiffmbs.analyses.job.Job.integrate`.

    `message`: one sentence. `seconds`: time spent in the block.
    """

    def __init__(self) -> None:
        self.outcome, self.message, self.seconds = Outcome.DONE, Outcome.DONE.value, 0.0

    def __enter__(self) -> Ending:
        self._begun = time.perf_counter()
        return self

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> bool:
        self.seconds = time.perf_counter() - self._begun
        if isinstance(error, SolverError):
            reason = Reason.CHATTERING if isinstance(error, ChatteringError) else Reason.OTHER
            message = error.args[0]
            self.stop(message if isinstance(message, Note) else reason.of(str(error)))
        elif isinstance(error, KeyboardInterrupt | ConditionMet):
            self.outcome, self.message = Outcome.INTERRUPTED, Outcome.INTERRUPTED.value
        return isinstance(error, SolverError | KeyboardInterrupt | ConditionMet)

    def stop(self, message: str) -> None:
        """Record an early stop and its reason."""
        self.outcome, self.message = Outcome.STOPPED, message


class Solver(Protocol):
    """Solver function; the contract is in the module's docstring."""

    def __call__(
        self, dynamics: Dynamics, start: InitialValues, grid: Grid, settings: RunSettings, watch: ProgressCallback, /
    ) -> Trajectory: ...


def summed(parts: Sequence[Mapping[str, int | float | str]]) -> dict[str, int | float | str]:
    """Combine the statistics of several runs: add counters, take the largest order, and join words."""
    together: dict[str, int | float | str] = {}
    for name in dict.fromkeys(name for part in parts for name in part):
        values = [part[name] for part in parts if name in part]
        numbers = [value for value in values if not isinstance(value, str)]
        words = "; ".join(dict.fromkeys(map(str, values)))
        together[name] = (max(numbers) if name == "order" else sum(numbers)) if numbers else words
    return together


def in_common(parts: Sequence[Trajectory], counted: Sequence[Trajectory] | None = None) -> dict[str, Any]:
    """Return the fields that join the parts of a trajectory, in time or in space: all but times, states and outcome.

    `counted`: parts of which steps are counted, all by default.
    """
    counted = parts if counted is None else counted
    t, order = (
        np.concatenate([nothing, *(getattr(part.history, name) for part in counted)])
        for name, nothing in (("t", np.empty(0)), ("order", np.empty(0, dtype=int)))
    )
    sequence = np.argsort(t, kind="stable")
    seconds = summed([{"seconds": part.statistics["seconds"]} for part in parts])
    return {
        "statistics": {**summed([part.statistics for part in counted]), **seconds},
        "history": History(t[sequence], order[sequence] if len(order) == len(t) else order[:0]),
        "note": "; ".join(dict.fromkeys(part.note for part in parts if part.note)),
        "solver": ", ".join(dict.fromkeys(part.solver for part in parts if part.solver)),
        "whole_steps": tuple(steps for part in counted for steps in part.whole_steps),
        "departures": tuple(each for part in parts for each in part.departures),
    }


class Rows:
    """Storage for states, which doubles when it is full: a run between samples may have a few rows only."""

    def __init__(self, n_q: int, n_u: int, expected: int) -> None:
        self._t, self._q, self._u = allocated(expected), allocated(expected, n_q), allocated(expected, n_u)
        self._count = self._released = 0
        self._seen = 1

    @classmethod
    def of(cls, system: System, grid: Grid) -> Rows:
        """Return the storage for the output times of a grid, or for steps."""
        return cls(system.n_q, system.n_u, 1 if grid.times is None else len(grid.times))

    def append(self, t: float, q: np.ndarray, u: np.ndarray) -> None:
        """Store one state."""
        self._enlarge(1)
        self._t[self._count], self._q[self._count], self._u[self._count] = t, q, u
        self._count += 1

    def extend(self, t: np.ndarray, q: np.ndarray, u: np.ndarray) -> None:
        """Store states, one per row."""
        self._enlarge(len(t))
        added = slice(self._count, self._count + len(t))
        self._t[added], self._q[added], self._u[added] = t, q, u
        self._count += len(t)
        if self._count - self._released > STORAGE.block:
            release(self._t, self._q, self._u)
            self._released = self._count

    def _enlarge(self, count: int) -> None:
        while self._count + count > len(self._t):
            self._t, self._q, self._u = (_doubled(array) for array in (self._t, self._q, self._u))

    def unseen(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the states stored since the last call, without the first of all, at which the integration starts."""
        t, q, u = (array[self._seen :] for array in self.stored)
        self._seen = max(self._seen, self._count)
        return t, q, u

    @property
    def stored(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Times, positions and velocities stored so far."""
        return self._t[: self._count], self._q[: self._count], self._u[: self._count]


def _doubled(array: np.ndarray) -> np.ndarray:
    larger = allocated(2 * len(array), *array.shape[1:])
    larger[: len(array)] = array
    return larger
