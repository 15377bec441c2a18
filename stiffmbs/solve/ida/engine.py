"""What `bdf` asks of a driver of IDA, be it native or through scikit-sundae's callbacks."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np

from ...compile.inputs.features import InputFeatures
from ..error_control.newton import Stiffness
from ..trajectory import History

if TYPE_CHECKING:
    from ..initial import InitialValues
    from .starting.anew import Begun


class Reached(NamedTuple):
    """Where an integrator has come since it was last heard of.

    Attributes
    ----------
    times, rows : ndarrays, shapes (k,), (k, 2 * independent)
        Instants asked for on the way (or ends of steps), and the independent coordinates and velocities there
        (`stiffmbs.compile.equations.Equations.states` makes all of them).
    t : float
    y : ndarray, shape (n,)
        Where it is now, with all unknowns.
    fired : tuple of int
        The event functions that stopped it by changing their sign; empty where none did.
    failure : str
        Why it cannot go on; empty where it can.
    passed : int
        Breakpoints at which it started anew on the way.
    """

    times: np.ndarray
    rows: np.ndarray
    t: float
    y: np.ndarray
    fired: tuple[int, ...] = ()
    failure: str = ""
    passed: int = 0


class Engine(Protocol):
    """A driver of IDA."""

    def forget(self) -> None:
        """Forget counters, history and pivots of an earlier run."""

    def see_inputs(self, features: InputFeatures, duration: float) -> None:
        """Take no step that might miss what the inputs do, from the next start on."""

    def leave_out(self, masked: np.ndarray) -> None:
        """Do not look at each event function for so many steps from the next start on."""

    def begin(self, t: float, y: np.ndarray, yp: np.ndarray, newton: float, stiffness: Stiffness) -> None:
        """Start, or start anew, at consistent values.

        Newton's iteration may leave a part of the tolerance; states within its long steps are
        brought back to the equations.
        """

    def begin_at(self, start: InitialValues, t: float) -> bool:
        """The same by one call that finds all of that; False, with nothing started, where it does not serve."""

    def begin_anew(self, q: np.ndarray, u: np.ndarray, t: float, ahead: float) -> Begun | None:
        """Start anew at consistent values behind a state in the middle of a run, and where a straight way `ahead` (s) meets other events,
        behind these; None, with nothing started, where that does not serve."""

    def to_times(self, times: np.ndarray, stops: Sequence[float]) -> Iterator[Reached]:
        """Integrate to the first stop or to a later one, and report at times up to there; ends early at an event or a failure.

        Stops that it passes are told by `passed`: it has started anew there.
        """

    def by_steps(self, stop: float) -> Iterator[Reached]:
        """Integrate to `stop` and report each step; ends early at an event or a failure."""

    def pause_after(self, steps: int) -> None:
        """Report at the latest after about so many steps."""

    def note(self) -> str:
        """What the user should know of the way it went; empty for nothing."""

    def steps(self) -> int:
        """Taken since the first start."""

    def statistics(self) -> dict[str, int | float | str]:
        """The linear solver, and counters since the first start."""

    def last_step(self) -> tuple[float, int] | None:
        """Size, s, and order of the last step, where they are known."""

    def long_steps(self) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
        """Begins and ends of steps far longer than those before them, and what is reported at nodes within them; None where it keeps none."""

    def displaced(self) -> np.ndarray | None:
        """Estimated errors of all positions, as displacements along velocities, shape (n_u,); None where they are not known."""

    def history(self) -> History:
        """Ends of the steps, and their orders where they are known."""
