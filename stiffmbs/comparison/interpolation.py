"""Interpolation of the cost of solvers, such as time or steps, at an error between measured ones."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence

import numpy as np

WINDOW = 10**1.5
"""Factor around the target error within which points determine the line."""
FEWEST = 4
"""Least number of points of a line; with fewer in the window, it runs between the two neighbours of the target."""


def value_at_error(points: Iterable[tuple[float, float]], target: float) -> float | None:
    """Return the value at an error: on a line through several points about it, or between two neighbours.

    A point with a smaller error and a smaller value than the line counts with its own value.  Looser settings may take
    longer where stability, not the error, limits steps; they make no solver slower.

    Parameters
    ----------
    points : iterable of (float, float)
        Errors and values, each positive.
    target : float
        Error.

    Returns
    -------
    float or None
        None if all errors are larger than the target, or there are none.
    """
    own = sorted(points, key=lambda point: point[0])
    if not own or own[0][0] > target:
        return None
    near = [point for point in own if target / WINDOW <= point[0] <= target * WINDOW]
    if len(near) < FEWEST:
        near = [point for pair in itertools.pairwise(own) if pair[0][0] <= target < pair[1][0] for point in pair]
    values = [value for error, value in own if error <= target]
    if near and near[0][0] <= target <= near[-1][0]:
        values.append(on_line(near, target))
    elif own[-1][0] >= target:
        return None
    return min(values)


def on_line(points: Sequence[tuple[float, float]], target: float) -> float:
    """Return the value at an error, on the straight line through the logarithms of values and errors."""
    errors, values = np.array(points).T
    return float(np.exp(np.polyfit(np.log(errors / target), np.log(values), 1)[-1]))
