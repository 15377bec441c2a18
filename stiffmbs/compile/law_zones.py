"""Zones of the laws that are called with something of the state: where a table, exp or tanh has features of its own.

A bump of 0.1 m in a table over distance, or a Gaussian of it, may lie between the ends of a step.  The edges here part the
argument of each law into zones such that within a zone nothing is overlooked: a cubic describes the table, tanh has
saturated, exp has vanished.  Solvers see to it that no step passes a whole zone (`stiffmbs.solve.native.event_search.within_step`).
The argument of a sine has no zones: what counts is how far it turns in a step; for a periodic table of few zones both count.
A law goes on beyond an edge as it was before it for a while, and a step that goes no further has overlooked nothing: a damper
that swings by a millimetre a second over a knot of its table does not change its law.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from .system import System
from .table_values import ends_of, value_of


def _on_both_sides(*edges: float) -> np.ndarray:
    return np.array([*(-edge for edge in reversed(edges)), *edges])


TURN = "turn"
FIXED = {
    "exp": _on_both_sides(0.5, 2.0, 6.0, 15.0, 37.0),
    "tanh": _on_both_sides(1.0, 3.0, 8.0, 19.0),
    "atan": _on_both_sides(1.0, 4.0, 20.0),
    "reciprocal": _on_both_sides(0.0, *2.0 * 4.0 ** np.arange(-20, 21))[1:],
    TURN: np.empty(0),
}
"""Edges of functions: of exp, cosh and sinh (exp(-37) is rounding); of tanh (so is 1 - tanh(19)); of atan; of 1/x and other
negative powers, none at 1, where 1 + x^2 and cos(x) turn round and rounding would decide.  They are graded, so that a step
that begins near a feature is no longer than what it has seen of it."""
FEW = 8
"""Zones in the period of a table up to which its features are as long as parts of the period."""
DESCRIBED = 1e-3
"""Part of the range of a table's values up to which one cubic describes pieces of it that then are one zone."""
WITHIN = np.array([0.0, 0.25, 0.5, 0.75, 1.0])
"""Places within a piece at which that is looked at."""
SMOOTH = 1e-3
"""Part of the narrower zone beside an edge of a function over which the function is straight."""
DEPARTED, NOTHING = 1e-3, 1e-9
"""Departure of a table from its tangent at an edge up to which it goes on as before the edge: part of its change from there, and
of the range of its values in both zones."""
BARELY = 2.0**-20
"""Part of a zone over which a table goes on in any case: less is rounding of its argument."""
NEARER = 2.0 ** -np.arange(21)
"""Parts of a zone at which that is looked at."""


class Zones(NamedTuple):
    """Zones of all event functions, in the order of the values of the set ``event_function``.

    Attributes
    ----------
    first : ndarray of int, shape (n + 1,)
        Where the edges of each function begin among all.
    edges : ndarray
        Increasing for each function; of an event function zero alone.
    overlap : ndarray
        How far the law goes on beyond each edge, to both sides, as it was before the edge; zero for an event function.
    period : ndarray, shape (n,)
        Of a law that repeats; 0 for others.
    turns : ndarray of int
        Numbers of the functions that are arguments of sines or of periodic tables of few zones.
    radians : ndarray
        Of such an argument: 1 for a sine, 2 pi by the period for a table.
    kinks : ndarray of int, shape (n,)
        1 for arguments of tables of which an edge is a kink, 0 for others.
    zoned : int
        Number of functions with edges.
    """

    first: np.ndarray
    edges: np.ndarray
    overlap: np.ndarray
    period: np.ndarray
    turns: np.ndarray
    radians: np.ndarray
    kinks: np.ndarray
    zoned: int


def zones_of(system: System) -> Zones:
    """The zones of all event functions of a system; those of the last run where its tables have the same numbers."""
    numbers = b"".join(group.numbers.tobytes() for group in system.groups if group.record.laws)
    if system.known_zones.get("numbers") != numbers:
        system.known_zones.update(numbers=numbers, zones=_zones_of(system))
    found: Zones = system.known_zones["zones"]
    return found


def _zones_of(system: System) -> Zones:
    of_event_function = np.zeros(1), np.zeros(1), 0.0
    found = [of_event_function] * system.n_event_functions + list(_of_arguments(system))
    counts = np.array([len(edges) for edges, _, _ in found], dtype=np.int64)
    period = np.array([period for _, _, period in found])
    repeated = (period > 0) & (counts <= FEW)
    turns = np.flatnonzero([False] * system.n_event_functions + [name == TURN for name in _names(system)] | repeated)
    return Zones(
        np.concatenate([[0], np.cumsum(counts)]).astype(np.int64),
        np.concatenate([np.empty(0), *(edges for edges, _, _ in found)]),
        np.concatenate([np.empty(0), *(overlap for _, overlap, _ in found)]),
        period,
        turns,
        np.divide(2 * np.pi, period[turns], out=np.ones(len(turns)), where=period[turns] > 0),
        np.array([_has_kinks(edges, overlap, period) for edges, overlap, period in found], dtype=np.int64),
        int(np.count_nonzero(counts)),
    )


def _names(system: System) -> Iterator[str]:
    """The name of the zones of each argument, in the order of the arguments."""
    for group in system.groups:
        for _ in group.index[:, 2 * group.kind.n_bodies] if group.record.laws else ():
            yield from (name for name, _ in group.record.laws)


def _of_arguments(system: System) -> Iterator[tuple[np.ndarray, np.ndarray, float]]:
    """Edges, overlaps and period for each argument: kind after kind, element after element."""
    for group in system.groups:
        own = group.index[:, 2 * group.kind.n_bodies] if group.record.laws else ()
        for start in own:
            for name, number in group.record.laws:
                if name != "table":
                    yield FIXED[name], SMOOTH * _narrower(FIXED[name]), 0.0
                    continue
                at = int(start + group.numbers[start + number])
                count = int(group.numbers[at])
                yield _of_table(group.numbers[at : at + 2 + count + 4 * (count - 1)].tobytes())


def _narrower(edges: np.ndarray, period: float = 0.0) -> np.ndarray:
    """The width of the narrower zone beside each edge; beyond the outermost ones zones have no end, or the law repeats."""
    if not len(edges):
        return edges
    around = edges[0] + period - edges[-1] if period else np.inf
    widths = np.concatenate([[around], np.diff(edges), [around]])
    return np.minimum(widths[:-1], widths[1:])


@lru_cache(maxsize=256)
def _of_table(data: bytes) -> tuple[np.ndarray, np.ndarray, float]:
    """The edges of a table (`stiffmbs.compile.table_values.spline_data`), their overlaps, and its period."""
    numbers = np.frombuffer(data)
    count = int(numbers[0])
    knots, pieces = numbers[2 : 2 + count], numbers[2 + count :].reshape(-1, 4)
    x = (knots[:-1, None] + np.diff(knots)[:, None] * WITHIN).ravel()
    z = x.reshape(-1, len(WITHIN)) - knots[:-1, None]
    a, b, c, d = (column[:, None] for column in pieces.T)
    y = (((a * z + b) * z + c) * z + d).ravel()
    allowed = DESCRIBED * float(np.ptp(y))
    starts = list(_zones(x, y, 0, count - 1, allowed))
    period = float(knots[-1] - knots[0]) if numbers[1] else 0.0
    at = np.array(starts if period else [*starts, count - 1])
    return knots[at], _overlaps(numbers, at, _narrower(knots[at], period)), period


def _has_kinks(edges: np.ndarray, overlap: np.ndarray, period: float) -> bool:
    """Return True if a law departs from its tangent at an edge at once."""
    return bool(np.any((overlap > 0) & (overlap < 4 * BARELY * _narrower(edges, period))))


def _overlaps(numbers: np.ndarray, at: np.ndarray, narrower: np.ndarray) -> np.ndarray:
    """How far from the knots `at` a table keeps, on both sides, to its tangents on the other one."""
    knots, level, before, behind = (values[..., None] for values in ends_of(numbers))
    distances = narrower[:, None] * NEARER
    sides = {side: value_of(numbers, knots[at] + side * distances) - level[at] for side in (1.0, -1.0)}
    span = np.ptp(np.hstack(list(sides.values())), axis=1)[:, None]
    keeps = np.ones(distances.shape, dtype=bool)
    for side, slope in ((1.0, before), (-1.0, behind)):
        change = sides[side]
        keeps &= np.abs(change - side * slope[at] * distances) <= DEPARTED * np.abs(change) + NOTHING * span
    near = np.logical_and.accumulate(keeps[:, ::-1], axis=1).sum(axis=1)
    return narrower * BARELY * 2.0 ** np.maximum(near - 1, 0)


def _zones(x: np.ndarray, y: np.ndarray, first: int, end: int, allowed: float) -> Iterator[int]:
    """The first pieces of the zones between two knots: halved until a cubic describes each."""
    if end - first == 1 or _described(x, y, first, end, allowed):
        yield first
        return
    middle = (first + end) // 2
    yield from _zones(x, y, first, middle, allowed)
    yield from _zones(x, y, middle, end, allowed)


def _described(x: np.ndarray, y: np.ndarray, first: int, end: int, allowed: float) -> bool:
    """Whether one cubic is within `allowed` of some pieces."""
    part = slice(first * len(WITHIN), end * len(WITHIN))
    place = 2 * (x[part] - x[part][0]) / (x[part][-1] - x[part][0]) - 1
    powers = np.power.outer(place, np.arange(4))
    fitted, *_ = np.linalg.lstsq(powers, y[part], rcond=None)
    return bool(np.abs(powers @ fitted - y[part]).max() <= allowed)
