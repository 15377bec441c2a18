"""Quadratic functions of modal coordinates, at many times."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np

AT_ONCE = 50_000_000
"""Numbers in the coefficients of a function, or in its values, that are in memory at once; they take 400 MB."""


class Quadratic:
    """Homogeneous quadratic function of the coordinates of n modes.

    Many values are sums of products of coordinates with coefficients, which are found once.

    Parameters
    ----------
    function : callable
        Function of a displacement, shape (size,). It returns an array of any shape.
    modes : ndarray, shape (size, n)
        Displacements by unit coordinates.
    times : int
        Number of times at which values may be needed. For fewer ones than coefficients, each value is found by itself.
    """

    def __init__(self, function: Callable[[np.ndarray], np.ndarray], modes: np.ndarray, times: int) -> None:
        self._function, self._modes, self._times = function, modes, times
        self._pairs = np.triu_indices(modes.shape[1])

    def __call__(self, coordinates: np.ndarray) -> np.ndarray:
        """Return the values at coordinates, shape (times, n); the first axis is that of the times."""
        if self._coefficients is None:
            found = [self._function(self._modes @ each) for each in coordinates]
            return np.array(found) if found else np.empty((0, *self._function(np.zeros(len(self._modes))).shape))
        one, other = self._pairs
        return np.tensordot(coordinates[:, one] * coordinates[:, other], self._coefficients, 1)

    @cached_property
    def _coefficients(self) -> np.ndarray | None:
        """Coefficients of products of two coordinates, on the first axis; None if there are too many."""
        count, modes = len(self._pairs[0]), self._modes.T
        if not 0 < count < self._times or count * self._function(modes[0]).size > AT_ONCE:
            return None
        squares = [self._function(mode) for mode in modes]
        return np.array([
            squares[k] if k == j else self._function(modes[k] + modes[j]) - squares[k] - squares[j]
            for k, j in zip(*self._pairs, strict=True)
        ])  # fmt: skip
