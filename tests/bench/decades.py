"""Run time over many decades of error: each contestant at settings from loose to tight."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from stiffmbs.comparison.at_error import LINE, value_at_error
from stiffmbs.comparison.sweep import TIMING, Timed, seconds_of, take_turns

from .benchmark import Row
from .contestant import Contestant, Failed
from .sweep import AT_TARGET, at_target_rows

TOLERANCES = tuple(float(f"{10.0**exponent:.2g}") for exponent in np.linspace(-1, -13, 37))
TARGETS = tuple(10.0**-k for k in range(2, 10))
"""Errors at which times are compared."""
SET_UP = "set-up"
ROUNDS = 5
LONGEST = 2.0
"""A contestant whose solution took longer, s, is not asked for a tighter one."""
ENOUGH = 2
"""So many settings in succession beyond the tightest error end a contestant's sweep."""


@dataclass
class Point(Timed):
    """A contestant at a setting: its error, seconds of set-up, and of its solutions."""

    contestant: Contestant
    setting: float
    error: float
    set_up: float

    def measure(self) -> None:
        """Time it once more, unless it is slow, or does not come to its end this time."""
        try:
            super().measure()
        except Failed:
            self.solve = None

    def row(self) -> Row:
        """As measured."""
        c = self.contestant
        return Row(c.solver, f"{c.setting} {self.setting:.3g}", self.error, self.median, c.peer)


def over_decades(
    contestants: Sequence[Contestant], reference: np.ndarray, targets: Sequence[float] = TARGETS, rounds: int = ROUNDS
) -> list[Row]:
    """Measure contestants at all their settings whose errors are about the targets, taking turns.

    Returns
    -------
    list of Row
        One for each contestant and setting; one for each contestant with the setting ``set-up``, the shortest time in
        which it was made ready for a solution, which is no part of the other rows' times; and one with the setting
        ``at error ...`` for each target it reaches.
    """
    points = [p for c in contestants for p in _points(c, reference, targets)]
    take_turns(points, range(rounds))
    rows = [point.row() for point in points]
    return [
        *rows,
        *(row for c in contestants for row in _set_up(c, points)),
        *(row for c in contestants for row in at_errors(c.solver, c.peer, rows, targets)),
    ]


def _set_up(contestant: Contestant, points: Sequence[Point]) -> Iterator[Row]:
    times = [point.set_up for point in points if point.contestant is contestant]
    if times:
        yield Row(contestant.solver, SET_UP, 0.0, min(times), contestant.peer)


def at_errors(solver: str, peer: bool, rows: Sequence[Row], targets: Sequence[float]) -> Iterator[Row]:
    """Interpolate times at errors, as `stiffmbs.comparison` does."""
    own = [(row.error, row.seconds) for row in rows if row.solver == solver]
    for target in targets:
        seconds = value_at_error(own, target)
        if seconds is not None:
            yield Row(solver, f"{AT_TARGET} {target:g}", target, seconds, peer)


def _points(contestant: Contestant, reference: np.ndarray, targets: Sequence[float]) -> Iterator[Point]:
    beyond, loosest, tightest = 0, max(targets) * LINE.window, min(targets) / LINE.window
    for setting in contestant.settings or TOLERANCES:
        begun = time.process_time()
        try:
            solve = contestant.at(setting)
            ready = time.process_time() - begun
            seconds, found = seconds_of(solve)
            if seconds > LONGEST:  # the first solution may have compiled what all others find
                seconds, found = seconds_of(solve)
        except Failed:
            continue
        error = error_of(found, reference)
        if tightest <= error <= loosest:
            again = solve if seconds < TIMING.once else None  # what a slow one holds in memory is let go
            yield Point(again, [seconds], contestant, setting, error, ready)
        beyond += error < tightest
        if beyond == ENOUGH or seconds > LONGEST:
            return


def error_of(found: np.ndarray, reference: np.ndarray) -> float:
    """Largest over all coordinates at the output times that were met; infinite where the solution is not finite."""
    met = ~np.all(np.isnan(found), axis=1)
    error = float(np.max(np.abs(found[met] - reference[met])))
    return error if np.isfinite(error) else np.inf


@dataclass(frozen=True)
class Race:
    """Times at one error: all contestants', and by how much the best peer is slower than the best of this package."""

    error: float
    seconds: dict[str, float]
    best_own: str
    best_peer: str
    ratio: float


def races(rows: Sequence[Row], targets: Sequence[float] = TARGETS) -> Iterator[Race]:
    """For each error that this package and a peer reach."""
    for target in targets:
        there = [row for row in at_target_rows(rows) if row.error == target]
        own = min((r for r in there if not r.peer), key=lambda r: r.seconds, default=None)
        peer = min((r for r in there if r.peer), key=lambda r: r.seconds, default=None)
        if own and peer:
            seconds = {row.solver: row.seconds for row in there}
            yield Race(target, seconds, own.solver, peer.solver, peer.seconds / own.seconds)
