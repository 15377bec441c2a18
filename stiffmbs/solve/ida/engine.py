"""Interface between `bdf` and the drivers of IDA: native, or by scikit-sundae's callbacks."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...compile.inputs.features import InputFeatures
from ..error_control.newton import Stiffness
from ..trajectory import History

if TYPE_CHECKING:
    from ...dynamics.initial import InitialValues
    from .starting.after_event import Begun


class Reached(NamedTuple):
    """Progress of an integrator since its last report.

    - `times`, `rows` of shapes (k,), (k, 2 * independent): output times (or ends of steps), and the independent
      coordinates and velocities there (`stiffmbs.compile.equations.Equations.states` computes all of them).
    - `y` of shape (n,): current time and unknowns.
    - `fired`: event functions whose sign changes stopped the integrator; empty if none did.
    - `failure`: reason of a failure; empty if there is none.
    - `passed`: number of breakpoints at which the integrator restarted.
    """

    times: np.ndarray
    rows: np.ndarray
    t: float
    y: np.ndarray
    fired: tuple[int, ...] = ()
    failure: str = ""
    passed: int = 0


class Engine(ABC):
    """A driver of IDA; methods with a body suit drivers without the feature."""

    @abstractmethod
    def forget(self) -> None:
        """Forget counters, history and pivots of an earlier run."""

    @abstractmethod
    def see_inputs(self, features: InputFeatures, duration: float) -> None:
        """Resolve the features of inputs by sufficiently short steps from the next start."""

    @abstractmethod
    def leave_out(self, masked: np.ndarray) -> None:
        """Ignore each event function for a number of steps from the next start."""

    @abstractmethod
    def begin(self, t: float, y: np.ndarray, yp: np.ndarray, newton: float, stiffness: Stiffness) -> None:
        """Start or restart at consistent values.

        `newton` is the part of the tolerance that Newton's iteration may leave.  States within steps that are long for
        the `stiffness` are corrected.
        """

    def begin_at(self, start: InitialValues, t: float) -> bool:
        """Start by one compiled call that finds these values; return False, without a start, if it does not apply."""
        return False

    def begin_restart(self, q: np.ndarray, u: np.ndarray, t: float, ahead: float) -> Begun | None:
        """Restart at consistent values after a state and events within `ahead` (s); None if not applicable."""
        return None

    @abstractmethod
    def to_times(self, times: np.ndarray, stops: Sequence[float]) -> Iterator[Reached]:
        """Integrate to the first stop or a later one, and report at output times; end early at an event or a failure.

        `Reached.passed` counts the stops at which it has restarted.
        """

    @abstractmethod
    def by_steps(self, stop: float) -> Iterator[Reached]:
        """Integrate to `stop` and report each step; ends early at an event or a failure."""

    @abstractmethod
    def pause_after(self, steps: int) -> None:
        """Return from integration after about so many steps at the latest."""

    def note(self) -> str:
        """Return a sentence on the integration for the user; empty if there is none."""
        return ""

    @abstractmethod
    def steps(self) -> int:
        """Return the number of steps since the first start."""

    @abstractmethod
    def statistics(self) -> dict[str, int | float | str]:
        """Return the name of the linear solver, and counters since the first start."""

    @property
    def long_step(self) -> float:
        """Return the step size, s, above which steps are long for the stiffest force; infinite if unknown."""
        return math.inf

    def last_step(self) -> tuple[float, int] | None:
        """Return the size, s, and order of the last step, if known."""
        return None

    def long_steps(self) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
        """Return begins, ends and interior values of steps much longer than their predecessors; None if not stored."""
        return None

    def displaced(self) -> np.ndarray | None:
        """Return estimated errors of positions as displacements along velocities, shape (n_u,); None if unknown."""
        return None

    @abstractmethod
    def history(self) -> History:
        """Return the ends of the steps, and their orders if known."""
