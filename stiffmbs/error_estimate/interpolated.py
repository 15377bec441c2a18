"""Tangent spaces at many nodes, most of them interpolated between a few at which the equations are linearised.

Interpolated spaces share the coordinates a = S e, where S is the matrix `left` of one of them, because bases of null spaces that are
computed one by one do not depend continuously on the pose.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ..dynamics.dynamics import Dynamics
from .evaluated import Evaluated
from .linearised import Linearised, linearised
from .parameters import ESTIMATE


@dataclass(frozen=True)
class Along:
    """Tangent spaces at all nodes of some pieces, and a mask of the nodes at which the equations were linearised."""

    space: Linearised
    computed: np.ndarray

    def at(self, chosen: slice) -> Along:
        """Return the tangent spaces at some of the nodes."""
        return Along(self.space.at(chosen), self.computed[chosen])


def linearised_along(dynamics: Dynamics, at: Evaluated, starts: np.ndarray, reach: float) -> Along:
    """Return the tangent spaces at the nodes of pieces, of which each begins at one of `starts`.

    Intervals between nodes are halved until linear interpolation is accurate in their middle; a parabola then interpolates within
    them. `reach`: longest time over which an error is transported with the same rates, s.
    """
    count, apart = len(at.t), ESTIMATE.apart
    bounds = np.append(starts, count)
    knots = [np.append(np.arange(first, end - 1, apart), end - 1) for first, end in pairwise(bounds)]
    first, last = (np.concatenate([each[ends] for each in knots]) for ends in (slice(None, -1), slice(1, None)))
    computed = np.zeros(count, dtype=bool)
    computed[np.concatenate([*knots, _middles(first, last)])] = True
    some = np.flatnonzero(computed)
    found = linearised(dynamics, at.at(some), reach)
    arrays = [np.empty((count, *each.shape[1:])) for each in (found.basis, found.rates, found.left)]
    space = Linearised(*arrays)
    while len(some):
        for whole, each in zip(arrays, (found.basis, found.rates, found.left), strict=True):
            whole[some] = each
        first, last = (ends[last - first > 1] for ends in (first, last))
        middle = _middles(first, last)
        on_line = _interpolate(space, at.t, (first, middle, last), dynamics.system.n_pose)
        first, last = (np.concatenate(pair)[np.tile(~on_line, 2)] for pair in ((first, middle), (middle, last)))
        some = _middles(first, last)[last - first > 1]
        computed[some] = True
        found = linearised(dynamics, at.at(some), reach) if len(some) else found
    return Along(space, computed)


def _middles(first: np.ndarray, last: np.ndarray) -> np.ndarray:
    return np.asarray((first + last) // 2)


def _interpolate(space: Linearised, t: np.ndarray, intervals: tuple[np.ndarray, ...], n_pose: int) -> np.ndarray:
    """Interpolate in the intervals (first, middle, last) where that is accurate in the middle; return a mask of these."""
    accurate = np.zeros(len(intervals[0]), dtype=bool)
    count = max(1, ESTIMATE.numbers_at_once // max(1, 9 * space.basis[0].size))
    for k in range(0, len(accurate), count):
        ends = np.array([each[k : k + count] for each in intervals])
        aligned = _aligned(space, ends)
        accurate[k : k + count] = found = _are_on_a_line(*aligned, space.left[ends[1]], t[ends], n_pose)
        arrays = _with_left(space, ends[:, found], *(each[:, found] for each in aligned))
        for n, (first, middle, last) in enumerate(ends.T[found]):
            rows = np.arange(first + 1, last)
            weights = _parabolas(t[rows], t[first], t[middle], t[last])
            for name, values in arrays.items():
                getattr(space, name)[rows] = np.tensordot(weights, values[:, n], 1)
    return accurate


def _parabolas(t: np.ndarray, first: float, middle: float, last: float) -> np.ndarray:
    """Return the weights by which a parabola through values at three times is evaluated at other times, shape (n, 3)."""
    weights = [
        (t - middle) * (t - last) / ((first - middle) * (first - last)),
        (t - first) * (t - last) / ((middle - first) * (middle - last)),
        (t - first) * (t - middle) / ((last - first) * (last - middle)),
    ]
    return np.stack(weights, axis=1)


def _aligned(space: Linearised, ends: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the matrices `basis` and `rates` at three nodes of intervals in the coordinates a = S e, S of the second."""
    turn = np.linalg.inv(space.left[ends[1]] @ space.basis[ends])
    return space.basis[ends] @ turn, space.rates[ends] @ turn


def _with_left(space: Linearised, ends: np.ndarray, basis: np.ndarray, rates: np.ndarray) -> dict[str, np.ndarray]:
    """Return the matrices by name, `left` in the coordinates of the others, with L B = 1."""
    left = space.left[ends]
    return {"basis": basis, "rates": rates, "left": np.linalg.solve(left @ basis, left)}


def _are_on_a_line(basis: np.ndarray, rates: np.ndarray, left: np.ndarray, t: np.ndarray, n_pose: int) -> np.ndarray:
    """Return a mask of the intervals in whose middle linear interpolation between the ends is accurate enough.

    An error D of the matrix M of a' = M a counts as c (c - M)^-1 D (c - M)^-1, c the inverse of the interval: the change of an
    implicit step over it. Stiff directions must be right relative to themselves, and soft ones relative to the interval.

    `basis`, `rates` of shape (3, intervals, full, n): at the first, middle and last node, in the coordinates of the middle, with
    its matrices `left`. `t` of shape (3, intervals): times, s.
    """
    with np.errstate(all="ignore"):
        part, size = ((t[1] - t[0]) / (t[2] - t[0]))[:, None, None], (t[2] - t[0])[:, None, None]
        off_basis, off_rates = (each[0] + part * (each[2] - each[0]) - each[1] for each in (basis, rates))
        step = np.linalg.inv(np.eye(left.shape[1]) - size * (left @ rates[1]))
        change = step @ (size * (left @ off_rates)) @ step
        of_poses = (left[..., :n_pose] != 0.0).any(axis=(0, 2))
        unit = np.where(of_poses, size[:, 0], 1.0)  # velocities are changes of poses within the interval
        change *= unit[:, None] / unit[:, :, None]
        turned = np.linalg.norm(off_basis, axis=(1, 2)) / np.linalg.norm(basis[1], axis=(1, 2))
        off = np.maximum(np.linalg.norm(change, axis=(1, 2)), turned) / (4.0 * part * (1.0 - part))[:, 0, 0]
        return np.asarray(off <= ESTIMATE.interpolated)
