"""A contestant over a range of tolerances, and its time at a target error."""

from __future__ import annotations

import statistics
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from stiffmbs.comparison.at_error import LINE, on_line
from stiffmbs.comparison.sweep import seconds_of

from .benchmark import Row
from .contestant import Contestant, Failed, Solve

AT_TARGET = "at error"


@dataclass(frozen=True)
class Point:
    """A contestant at a tolerance, its error, and the times that its solutions took, s."""

    contestant: Contestant
    rtol: float
    solve: Solve
    error: float
    times: list[float]

    def measure(self) -> None:
        """Time a solution: by the processor's time, which other programs on the machine leave alone."""
        self.times.append(seconds_of(self.solve)[0])

    def row(self) -> Row:
        """The median of the times."""
        seconds = statistics.median(self.times)
        return Row(self.contestant.solver, f"rtol {self.rtol:.2g}", self.error, seconds, self.contestant.peer)


def points(contestant: Contestant, tolerances: Iterable[float], reference: np.ndarray, target: float) -> Iterator[Point]:  # fmt: skip
    """From loose to tight, those with errors about the target; two in succession beyond it are the end."""
    beyond = 0
    for rtol in tolerances:
        solve = contestant.at(rtol)
        try:
            error = float(np.max(np.abs(solve() - reference)))
        except Failed:
            continue
        if target / LINE.window <= error <= target * LINE.window:
            yield Point(contestant, float(rtol), solve, error, [])
        beyond += error < target / LINE.window
        if beyond == 2:
            return


def at_target(contestant: Contestant, rows: Sequence[Row], target: float) -> Iterator[Row]:
    """The time at a target error: on the straight line through the logarithms of times and errors about it.

    Errors of a variable-order method scatter by a factor of three from one tolerance to the next; a line through a
    dozen of them tells times within a few parts in a hundred, two neighbours do not.
    """
    own = [row for row in rows if row.solver == contestant.solver]
    if len(own) < LINE.fewest or not min(r.error for r in own) <= target <= max(r.error for r in own):
        return
    seconds = on_line([(row.error, row.seconds) for row in own], target)
    yield Row(contestant.solver, f"{AT_TARGET} {target:g}", target, seconds, contestant.peer)


def at_target_rows(rows: Sequence[Row]) -> list[Row]:
    """Those that hold a time at the target error."""
    return [row for row in rows if row.setting.startswith(AT_TARGET)]
