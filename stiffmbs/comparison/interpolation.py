"""Interpolate what solvers need, such as time or steps, to an error between those that were measured."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence

import numpy as np

WINDOW = 10**1.5
"""Points with errors within this factor of the target determine the line."""
FEWEST = 4
"""Points of a line; where there are fewer within the window, it runs between the two neighbours of the target."""


def value_at_error(points: Iterable[tuple[float, float]], target: float) -> float | None:
    """Return the value at an error: on a line through many points about it, or between two neighbours.

    A point that has a smaller error and a smaller value than the line counts with its own value: looser settings that
    take longer, where steps follow stability and not the error, make no solver slower.

    Parameters
    ----------
    points : iterable of (float, float)
        Errors and values, each positive.
    target : float
        The error.

    Returns
    -------
    float or None
        None where all errors are larger than the target, or there are none.
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
