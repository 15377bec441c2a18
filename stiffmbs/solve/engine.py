"""Contract of engines: what `stiffmbs.solve.integrator.Integrator` joins to a run."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np

from .trajectory import Grid, History

if TYPE_CHECKING:
    from ..compile.inputs.features import InputFeatures
    from ..dynamics.initial import InitialValues
    from .events.event_functions import EventSearch
    from .events.whole_steps import WholeSteps
    from .recorded_steps import Piece
    from .stiff_rows import States


class Reached(NamedTuple):
    """Progress of an engine since its last report.

    - `times`, `rows`: output times (or ends of steps), and q and u there.
    - `t`, `state`: current time, s, and a function that returns its q and u up to the next step.
    - `fired`: event functions whose sign changes stopped the engine; empty if none did.
    - `failure`: reason of a failure; empty if there is none.
    - `passed`: number of breakpoints at which the engine restarted.
    """

    times: np.ndarray
    rows: States
    t: float
    state: Callable[[], States]
    fired: tuple[int, ...] = ()
    failure: str = ""
    passed: int = 0


class Begun(NamedTuple):
    """Result of a restart; the current state of the dynamics is that of the restart.

    `t`: time of the restart, s: that of the given state, or slightly later. `jumps`: true if velocities may have jumped
    from those of the given state. `meets`: true if forces may drive the motion back from both sides of their jump.
    """

    t: float
    jumps: bool
    meets: bool


class Engine(Protocol):
    """Steps from one start to the next.

    1. `forget` and `begin_run` come before the steps of a run.
    2. `begin_at` starts at consistent values; `begin_restart` after a state that need not be consistent, past events
       within `ahead`, s. The current state of the dynamics is then that of the start.
    3. `advance` integrates from the last start up to the first of some stops, an event or a failure, and no formula is
       evaluated beyond the stop. It yields a `Reached` now and then, and at the end, with all output times so far, or all
       steps if `times` is None. An engine that restarts at stops itself goes on to the next of them.
    4. An event ends the last step where an event function of `watch` changes its sign. A failure is the reason in the
       last `Reached`, or a SolverError after it.
    5. `refuse` raises a SolverError after a `Reached` from which the run is not to go on.
    """

    watch: EventSearch

    @property
    def long_step(self) -> float:
        """Length above which ends of steps do not keep the balance of stiff forces on the constraints, s."""
        return np.inf

    def forget(self) -> None:
        """Discard what earlier runs have left, so that results do not depend on them; nothing by default."""
        return

    def begin_run(self, features: InputFeatures, grid: Grid) -> None: ...
    def begin_at(self, start: InitialValues, t: float) -> None: ...
    def begin_restart(self, q: np.ndarray, u: np.ndarray, t: float, ahead: float, stop: float) -> Begun: ...
    def advance(self, times: np.ndarray | None, stops: Sequence[float]) -> Iterator[Reached]: ...

    def refuse(self, reached: Reached, grid: Grid) -> None:
        """Raise a SolverError if the run is not to go on; it goes on by default."""
        return

    def steps(self) -> int:
        """Return the number of steps of the run."""

    def statistics(self) -> dict[str, int | float | str]:
        """Return the counters of the run."""

    def last_step(self) -> tuple[float, int] | None:
        """Return the size, s, and order of the last step, if known; order 0 if it is fixed."""

    def history(self) -> History:
        """Return the ends of the steps, and their orders."""

    def whole_steps(self) -> tuple[WholeSteps, ...]:
        """Return the steps that are to be checked after the run."""

    def recorded(self) -> tuple[Piece, ...]:
        """Return the steps that the grid asks to record; none of explicit steps."""
        return ()

    def note(self) -> str:
        """Return a sentence on the integration for the user; empty if there is none."""
        return self.watch.note()
