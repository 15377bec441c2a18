"""The rank of one loop's equations: at the start, and in general, seen at perturbed assembled poses."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from .loop_equations import AGREES, CLOSED, LoopEquations, Pose
from .small_singular import small_singular

SOUND = 1e-5
"""Least singular value of the scaled J above which the equations are independent beyond doubt."""
DEPENDENT = 1e-8
"""Singular values of the scaled J below this, at poses away from singular ones, belong to redundant equations."""
BY_GAP = 30.0
"""Singular values below so many gaps do so too, where equations agree to some digits only."""
UNCLEAR = 1e-9, 1e-5
"""A pose with singular values between these, near a singular one by chance, is not asked where others are clear."""
SINGULAR_START = 1e-5
"""Part of the general pose's least singular value below which the start counts as singular."""
POSES, PERTURBATION, SHRINKS = 3, 0.1, 5
"""Poses to confirm the rank at, the size of a perturbation (arms, rad), and how often it is made smaller in vain."""


class LoopRank(NamedTuple):
    """What the singular values of one loop's scaled J say.

    Attributes
    ----------
    equations : LoopEquations
    start : Pose
        Assembled.
    rank : int
        In general: the greatest that is found.
    start_rank : int
        At the start; less than `rank` at a singular pose.
    least : float
        The smallest singular value that counts in the rank.
    null_spaces : list of (Pose, ndarray, shape (n, n - rank))
        At general poses, and at the start where that is one: combinations of rows of the scaled J that vanish.
    """

    equations: LoopEquations
    start: Pose
    rank: int
    start_rank: int
    least: float
    null_spaces: list[tuple[Pose, np.ndarray]]

    @property
    def redundancy(self) -> int:
        """Number of redundant equations."""
        return len(self.equations.loop.rows) - self.rank


def loop_rank(equations: LoopEquations, q: np.ndarray, t: float) -> LoopRank:
    """Find the rank of a loop's equations near a pose.

    A singular pose has a smaller rank than its neighbours; redundant equations depend on each other everywhere.  So
    only where the rank is not full at the start is it sought by singular values, there and at perturbed poses.

    Parameters
    ----------
    q : ndarray
        Coordinates of the loop's bodies, m and rad.
    t : float
        s.
    """
    start = equations.assembled(q, t)
    count = len(start.C)
    if start.J.singular_values_above(SOUND):
        return LoopRank(equations, start, count, count, SOUND, [])
    others = list(_perturbed(equations, start))
    poses = [start, *others]
    before = equations.row_scale.copy()
    equations.scale_rows([pose.J for pose in poses])
    rescaled = equations.row_scale / before
    decomposed = [small_singular(pose.J.scaled(rescaled, np.ones(pose.J.shape[1]))) for pose in poses]
    values = [s for s, _ in decomposed]
    gap = start.gap if CLOSED < start.gap <= AGREES else 0.0
    asked = (values[1:] if gap else _clear(values[1:])) or values[1:] or values
    rank = max(int(np.sum(s > max(DEPENDENT, BY_GAP * gap))) for s in asked)
    least = max(float(s[rank - 1]) for s in asked) if rank else 0.0
    start_rank = int(np.sum(values[0][:rank] > SINGULAR_START * least))
    general = [k for k, s in enumerate(values) if _is_general(s, rank, least, k == 0 or any(s is own for own in asked))]
    null_spaces = [(poses[k], _last(decomposed[k][1], count - rank)) for k in general]
    return LoopRank(equations, start, rank, start_rank, least, null_spaces)


def _last(vectors: np.ndarray, count: int) -> np.ndarray:
    """The last columns, so many of them."""
    return vectors[:, vectors.shape[1] - count :]


def _clear(values: list[np.ndarray]) -> list[np.ndarray]:
    """The singular values of poses that are not near a singular one."""
    return [s for s in values if not np.any((s > UNCLEAR[0]) & (s < UNCLEAR[1]))]


def _is_general(values: np.ndarray, rank: int, least: float, asked: bool) -> bool:
    """Whether a pose has the rank that there is in general."""
    return asked and int(np.sum(values > SINGULAR_START * least)) == rank


def _perturbed(equations: LoopEquations, start: Pose) -> Iterator[Pose]:
    """Assembled poses near the start; smaller moves where larger ones cannot be assembled."""
    rng = np.random.default_rng(1)
    size, found = PERTURBATION, 0
    for _ in range(POSES + SHRINKS if start.gap <= AGREES else POSES):
        move = size * rng.uniform(-1, 1, len(equations.loop.columns))
        pose = equations.assembled(equations.moved(start.q, move), start.t)
        if pose.J.finite and pose.gap <= max(CLOSED, 2 * start.gap):
            yield pose
            found += 1
            if found == POSES:
                return
        else:
            size /= 4
