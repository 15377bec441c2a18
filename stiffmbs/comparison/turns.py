"""Solutions that are timed by turns, so that what slows the machine for a while slows all of them."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

ONCE = 0.2
"""Solutions that take longer, s, are timed a single time."""
Found = TypeVar("Found")


@dataclass
class Timed:
    """A solution that is timed: what solves it again (None for slow ones), and the times so far, s."""

    solve: Callable[[], Any] | None
    seconds: list[float]

    def measure(self) -> None:
        """Time it once more, unless it is slow."""
        if self.solve is not None:
            self.seconds.append(seconds_of(self.solve)[0])

    @property
    def median(self) -> float:
        """Of the times, s."""
        return statistics.median(self.seconds)


def seconds_of(solve: Callable[[], Found]) -> tuple[float, Found]:
    """Processor time of a solution, which other programs on the machine leave alone, and the solution."""
    begun = time.process_time()
    found = solve()
    return time.process_time() - begun, found


def take_turns(timed: Sequence[Timed], rounds: Iterable[int]) -> None:
    """Time all of them in each round, forwards and backwards by turns; the first times, which met cold caches, are dropped.

    Backwards each comes after another neighbour, so that none always follows one of other code and finds caches cold.
    """
    for k in rounds:
        for one in timed[:: -1 if k % 2 else 1]:
            one.measure()
    for one in timed:
        del one.seconds[: len(one.seconds) > 1]
