"""Zones of the laws that are called with something of the state: where a table, exp or tanh has features of its own.

A bump of 0.1 m in a table over distance, or a Gaussian of it, may lie between the ends of a step.  The edges here part the
argument of each law into zones such that within a zone nothing is overlooked: a cubic describes the table, tanh has
saturated, exp has vanished.  Solvers see to it that no step passes a whole zone (`stiffmbs.solve.native.event_search.within_step`).
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache

import numpy as np

from .system import System


def _on_both_sides(*edges: float) -> np.ndarray:
    return np.array([*(-edge for edge in reversed(edges)), *edges])


FIXED = {
    "exp": _on_both_sides(0.5, 2.0, 6.0, 15.0, 37.0),
    "tanh": _on_both_sides(1.0, 3.0, 8.0, 19.0),
    "atan": _on_both_sides(1.0, 4.0, 20.0),
    "reciprocal": _on_both_sides(0.0, *2.0 * 4.0 ** np.arange(-20, 21))[1:],
}
"""Edges of functions: of exp, cosh and sinh (exp(-37) is rounding); of tanh (so is 1 - tanh(19)); of atan; of 1/x and other
negative powers, none at 1, where 1 + x^2 and cos(x) turn round and rounding would decide.  They are graded, so that a step
that begins near a feature is no longer than what it has seen of it."""
DESCRIBED = 1e-3
"""Part of the range of a table's values up to which one cubic describes pieces of it that then are one zone."""
WITHIN = np.array([0.0, 0.25, 0.5, 0.75, 1.0])
"""Places within a piece at which that is looked at."""


def edges_of(system: System) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The edges of all event functions, in the order of the values of the set ``event_function``.

    Returns
    -------
    first : ndarray of int, shape (n + 1,)
        Where the edges of each function begin among all.
    edges : ndarray
        Increasing for each function; of an event function zero alone.
    period : ndarray, shape (n,)
        Of a law that repeats; 0 for others.
    """
    found = [(np.zeros(1), 0.0)] * system.n_event_functions + list(_of_arguments(system))
    counts = [len(edges) for edges, _ in found]
    first = np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
    return (
        first,
        np.concatenate([np.empty(0), *(edges for edges, _ in found)]),
        np.array([period for _, period in found]),
    )


def _of_arguments(system: System) -> Iterator[tuple[np.ndarray, float]]:
    """Edges and period for each argument: kind after kind, element after element."""
    for group in system.groups:
        own = group.index[:, 2 * group.kind.n_bodies] if group.record.laws else ()
        for start in own:
            for name, number in group.record.laws:
                if name != "table":
                    yield FIXED[name], 0.0
                    continue
                at = int(start + group.numbers[start + number])
                count = int(group.numbers[at])
                yield _of_table(group.numbers[at : at + 2 + count + 4 * (count - 1)].tobytes())


@lru_cache(maxsize=256)
def _of_table(data: bytes) -> tuple[np.ndarray, float]:
    """The edges of a table (`stiffmbs.compile.table_values.spline_data`), and its period."""
    numbers = np.frombuffer(data)
    count = int(numbers[0])
    knots, pieces = numbers[2 : 2 + count], numbers[2 + count :].reshape(-1, 4)
    x = (knots[:-1, None] + np.diff(knots)[:, None] * WITHIN).ravel()
    z = x.reshape(-1, len(WITHIN)) - knots[:-1, None]
    a, b, c, d = (column[:, None] for column in pieces.T)
    y = (((a * z + b) * z + c) * z + d).ravel()
    allowed = DESCRIBED * float(np.ptp(y))
    starts = list(_zones(x, y, 0, count - 1, allowed))
    periodic = bool(numbers[1])
    edges = knots[starts] if periodic else knots[[*starts, count - 1]]
    return edges, float(knots[-1] - knots[0]) if periodic else 0.0


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
