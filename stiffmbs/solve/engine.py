"""What `bdf` asks of a driver of IDA, be it native or through scikit-sundae's callbacks."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ..compile.equations import Equations
from ..compile.state import State
from .trajectory import History


@dataclass(frozen=True)
class Reached:
    """Where an integrator has come since it was last heard of.

    Attributes
    ----------
    times, rows : ndarrays, shapes (k,), (k, n_q + n_u)
        Instants asked for on the way (or ends of steps), and q and u there.
    t : float
    y : ndarray, shape (n,)
        Where it is now, with all unknowns.
    at_event : bool
        Whether a switch stopped it.
    failure : str
        Why it cannot go on; empty where it can.
    """

    times: np.ndarray
    rows: np.ndarray
    t: float
    y: np.ndarray
    at_event: bool = False
    failure: str = ""


class Engine(Protocol):
    """A driver of IDA.

    Parameters
    ----------
    equations : Equations
        In the order that suits the driver's matrices.
    state : State
        The working memory of residual and Jacobian.
    rtol : float
    atol : ndarray, shape (n,)
        Of each unknown; huge for those that are left out of the error test.
    max_step : float
        s; 0 for none.
    """

    def __init__(self, equations: Equations, state: State, rtol: float, atol: np.ndarray, max_step: float) -> None: ...

    def begin(self, t: float, y: np.ndarray, yp: np.ndarray, newton: float) -> None:
        """Start, or start anew, at consistent values; Newton's iteration may leave a part of the tolerance."""

    def to_times(self, times: np.ndarray, stop: float) -> Iterator[Reached]:
        """Integrate to `stop` and report at times up to there; ends early at an event or a failure."""

    def by_steps(self, stop: float) -> Iterator[Reached]:
        """Integrate to `stop` and report each step; ends early at an event or a failure."""

    def statistics(self) -> dict[str, int | float]:
        """Counters since the first start."""

    def history(self) -> History:
        """Ends of the steps, and their orders where they are known."""
