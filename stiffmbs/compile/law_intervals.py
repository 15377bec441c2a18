"""Intervals of force laws in the state between breakpoints of tables, exp, tanh and similar functions.

A bump in a table over distance may lie between the ends of a step. Breakpoints divide the argument of each law into
intervals without hidden features: a cubic describes the table, tanh has saturated, exp has vanished. Solvers ensure
that no step crosses a whole interval (`stiffmbs.solve.events.native.within_step`). A sine has no intervals: its
phase change per step is limited, as is that of a periodic table with few intervals. A law continues unchanged for a
distance beyond a breakpoint; a step that ends within it has missed nothing.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from .system import System
from .table_values import REPEATS, ends_of, value_of


def _on_both_sides(*breakpoints: float) -> np.ndarray:
    return np.array([*(-breakpoint for breakpoint in reversed(breakpoints)), *breakpoints])


TURN, DIRECTION = "turn", "direction"
TABLE, TABLE_OF_DIRECTION = TABLES = "table", "table of a direction"
FIXED = {
    "exp": _on_both_sides(0.5, 2.0, 6.0, 15.0, 37.0),
    "tanh": _on_both_sides(1.0, 3.0, 8.0, 19.0),
    "atan": _on_both_sides(1.0, 4.0, 20.0),
    "reciprocal": _on_both_sides(0.0, *2.0 * 4.0 ** np.arange(-20, 21))[1:],
    TURN: np.empty(0),
    DIRECTION: np.empty(0),
}
"""Breakpoints of exp, cosh and sinh (exp(-37) is rounding), tanh (1 - tanh(19) is rounding), atan, and 1/x and other
negative powers. None of these is at 1, an extremum of 1 + x^2 and cos(x), where rounding would decide. They are graded,
so that a step near a feature is limited to its size."""
FEW = 8
"""Number of intervals per period up to which the phase of a periodic table is limited too."""
CLOSE = 1e-3
"""Relative error at which two curves are the same: of a cubic from a table, relative to the range of its values, and of a
table from its tangent at a breakpoint, relative to its change. Also the part of the narrower interval at a breakpoint over
which a function is straight."""
WITHIN = np.array([0.0, 0.25, 0.5, 0.75, 1.0])
"""Sampling points within a piece for that error."""
NOTHING = 1e-9
"""Departure of a table from its tangent that is rounding, relative to the range of its values."""
NEARER = 2.0 ** -np.arange(21)
"""Sampling distances for the departure, as parts of an interval."""
BARELY = NEARER[-1]
"""Part of an interval over which a table always continues: less is rounding of its argument."""


class Intervals(NamedTuple):
    """Intervals of all event functions, in the order of the values of the set ``event_function``.

    - `first` of shape (n + 1,): index of the first breakpoint of each function.
    - `breakpoints`: breakpoints in increasing order for each function; zero and infinity for an event function, whose
      bounds are others while it stays at zero (`stiffmbs.solve.events.chattering.HoveringEvents`).
    - `overlap`: distance on both sides of each breakpoint over which the law continues unchanged; zero for an event
      function.
    - `period` of shape (n,): period of a law; 0 if it is not periodic.
    - `turns`: indices of the functions that are arguments of sines or of periodic tables with few intervals.
    - `radians`: radians per unit of such an argument: 1 for a sine, 2 pi divided by the period for a table; -1 for a sine
      whose argument jumps by full turns, as the angle of a direction does.
    - `kinks` of shape (n,): 1 for arguments of tables with a kink, 0 for others.
    - `zoned`: number of functions with breakpoints.
    - `tables` of shape (n,): 1 for arguments of tables that end at their first and last breakpoint, 0 for others.
    - `jumping`: indices of the arguments of periodic tables that jump by periods, as the angle of a direction does.
    """

    first: np.ndarray
    breakpoints: np.ndarray
    overlap: np.ndarray
    period: np.ndarray
    turns: np.ndarray
    radians: np.ndarray
    kinks: np.ndarray
    zoned: int
    tables: np.ndarray
    jumping: np.ndarray

    def of_kinked(self, values: np.ndarray) -> list[int]:
        """Return the number of the interval of each argument of a table with a kink, from the values of all functions."""
        found = []
        for k in np.flatnonzero(self.kinks):
            breakpoints, period = self.breakpoints[self.first[k] : self.first[k + 1]], self.period[k]
            argument = breakpoints[0] + (values[k] - breakpoints[0]) % period if period else values[k]
            found.append(int(np.searchsorted(breakpoints, argument)))
        return found


def intervals_of(system: System) -> Intervals:
    """Return the intervals of all event functions of a system, cached for unchanged tables."""
    numbers = b"".join(group.numbers.tobytes() for group in system.groups if group.record.laws)
    if system.known_intervals.get("numbers") != numbers:
        system.known_intervals.update(numbers=numbers, intervals=_intervals_of(system))
    found: Intervals = system.known_intervals["intervals"]
    return found


def _intervals_of(system: System) -> Intervals:
    of_event_function = "", np.array([0.0, np.inf]), np.zeros(2), 0.0
    found = [of_event_function] * system.n_event_functions + list(_of_arguments(system))
    counts = np.array([len(breakpoints) for _, breakpoints, _, _ in found], dtype=np.int64)
    period = np.array([period for *_, period in found])
    repeated = (period > 0) & (counts <= FEW)
    turns = np.flatnonzero(np.array([name in (TURN, DIRECTION) for name, *_ in found], dtype=bool) | repeated)
    sines = np.array([-1.0 if found[k][0] == DIRECTION else 1.0 for k in turns])
    return Intervals(
        np.concatenate([[0], np.cumsum(counts)]).astype(np.int64),
        np.concatenate([np.empty(0), *(breakpoints for _, breakpoints, _, _ in found)]),
        np.concatenate([np.empty(0), *(overlap for _, _, overlap, _ in found)]),
        period,
        turns,
        np.divide(2 * np.pi, period[turns], out=sines, where=period[turns] > 0),
        np.array(
            # a law departs from its tangent immediately at a breakpoint
            [np.any((o > 0) & (o < 4 * BARELY * _narrower(breakpoints, turn))) for _, breakpoints, o, turn in found],
            dtype=np.int64,
        ),
        int(np.count_nonzero(counts)),
        np.array([name in TABLES and period == 0.0 for name, _, _, period in found], dtype=np.int64),
        np.flatnonzero([name == TABLE_OF_DIRECTION and period > 0.0 for name, _, _, period in found]),
    )


def _of_arguments(system: System) -> Iterator[tuple[str, np.ndarray, np.ndarray, float]]:
    """Yield name, breakpoints, overlaps and period of each argument, by kind and element."""
    for group in system.groups:
        own = group.index[:, 2 * group.kind.n_bodies] if group.record.laws else ()
        for start in own:
            for name, number in group.record.laws:
                if name not in TABLES:
                    yield name, FIXED[name], CLOSE * _narrower(FIXED[name]), 0.0
                    continue
                at = int(start + group.numbers[start + number])
                count = int(group.numbers[at])
                yield name, *_of_table(group.numbers[at : at + 2 + count + 4 * (count - 1)].tobytes())


def _narrower(breakpoints: np.ndarray, period: float = 0.0) -> np.ndarray:
    """Return the width of the narrower interval at each breakpoint; outermost intervals are infinite or periodic."""
    if not len(breakpoints):
        return breakpoints
    around = breakpoints[0] + period - breakpoints[-1] if period else np.inf
    widths = np.concatenate([[around], np.diff(breakpoints), [around]])
    return np.minimum(widths[:-1], widths[1:])


@lru_cache(maxsize=256)
def _of_table(data: bytes) -> tuple[np.ndarray, np.ndarray, float]:
    """Return breakpoints, overlaps and period of a table (`stiffmbs.compile.table_values.spline_data`)."""
    numbers = np.frombuffer(data)
    count = int(numbers[0])
    knots, pieces = numbers[2 : 2 + count], numbers[2 + count :].reshape(-1, 4)
    x = (knots[:-1, None] + np.diff(knots)[:, None] * WITHIN).ravel()
    z = x.reshape(-1, len(WITHIN)) - knots[:-1, None]
    a, b, c, d = (column[:, None] for column in pieces.T)
    y = (((a * z + b) * z + c) * z + d).ravel()
    allowed = CLOSE * float(np.ptp(y))
    starts = list(_intervals(x, y, 0, count - 1, allowed))
    period = float(knots[-1] - knots[0]) if numbers[1] == REPEATS else 0.0
    at = np.array(starts if period else [*starts, count - 1])
    return knots[at], _overlaps(numbers, at, _narrower(knots[at], period)), period


def _overlaps(numbers: np.ndarray, at: np.ndarray, narrower: np.ndarray) -> np.ndarray:
    """Return the distances from the knots `at` over which a table follows the tangents of the other side."""
    knots, level, before, behind = (values[..., None] for values in ends_of(numbers))
    distances = narrower[:, None] * NEARER
    sides = {side: value_of(numbers, knots[at] + side * distances) - level[at] for side in (1.0, -1.0)}
    span = np.ptp(np.hstack(list(sides.values())), axis=1)[:, None]
    keeps = np.ones(distances.shape, dtype=bool)
    for side, slope in ((1.0, before), (-1.0, behind)):
        change = sides[side]
        keeps &= np.abs(change - side * slope[at] * distances) <= CLOSE * np.abs(change) + NOTHING * span
    near = np.logical_and.accumulate(keeps[:, ::-1], axis=1).sum(axis=1)
    return narrower * BARELY * 2.0 ** np.maximum(near - 1, 0)


def _intervals(x: np.ndarray, y: np.ndarray, first: int, end: int, allowed: float) -> Iterator[int]:
    """Yield the first pieces of the intervals between two knots, halved until a cubic describes each."""
    if end - first == 1 or _described(x, y, first, end, allowed):
        yield first
        return
    middle = (first + end) // 2
    yield from _intervals(x, y, first, middle, allowed)
    yield from _intervals(x, y, middle, end, allowed)


def _described(x: np.ndarray, y: np.ndarray, first: int, end: int, allowed: float) -> bool:
    part = slice(first * len(WITHIN), end * len(WITHIN))
    place = 2 * (x[part] - x[part][0]) / (x[part][-1] - x[part][0]) - 1
    powers = np.power.outer(place, np.arange(4))
    fitted, *_ = np.linalg.lstsq(powers, y[part], rcond=None)
    return bool(np.abs(powers @ fitted - y[part]).max() <= allowed)


def has_kinks(system: System) -> bool:
    """Return True if forces, states or tables of a system have breakpoints."""
    return system.n_event_functions > 0 or bool(intervals_of(system).kinks.any())
