"""Timing of solutions in turns, so that disturbances of the machine affect all of them."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

Found = TypeVar("Found")


@dataclass(frozen=True)
class Timing:
    """Way in which solutions are timed.

    Attributes
    ----------
    once : float
        Time above which a solution is timed only once, s.
    """

    once: float = 0.2


TIMING = Timing()


@dataclass
class Timed:
    """Timed solution: a function that solves it again (None for slow ones), and its times so far, s."""

    solve: Callable[[], Any] | None
    seconds: list[float]

    def measure(self) -> None:
        """Time the solution once more, unless it is slow."""
        if self.solve is not None:
            self.seconds.append(seconds_of(self.solve)[0])

    @property
    def median(self) -> float:
        """Return the median of the times, s."""
        return statistics.median(self.seconds)


def seconds_of(solve: Callable[[], Found]) -> tuple[float, Found]:
    """Return the processor time of a solution, which excludes other programs, and the solution."""
    begun = time.process_time()
    found = solve()
    return time.process_time() - begun, found


def take_turns(timed: Sequence[Timed], rounds: Iterable[int]) -> None:
    """Time all solutions in each round, forwards and backwards in turn, and drop the first times, with cold caches.

    The neighbours of a solution differ between both orders, so that none always follows other code with cold caches.
    """
    for k in rounds:
        for one in timed[:: -1 if k % 2 else 1]:
            one.measure()
    for one in timed:
        del one.seconds[: len(one.seconds) > 1]
