"""Parameters of simulations in real time."""

from __future__ import annotations

from dataclasses import dataclass

from ..tuning import tuned


@dataclass(frozen=True)
class RealTimeParameters:
    """Parameters of the loop of steps in real time."""

    polled: float = 2e-4
    """Time before a step is due in which the clock is polled instead of sleeping, s. Source: delays of sleeping processes."""
    packets: int = 100
    """Largest number of packets that are read before a step, so that a flood of them does not stop the steps. Source: a
    sender with a period of a hundredth of the step."""
    warming: int = 10
    """Number of steps before the first one that is timed, which load compiled code. Source: the steps after which all code
    is loaded."""


REAL_TIME = tuned("real_time", RealTimeParameters())
