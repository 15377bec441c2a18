"""Rank of one loop's equations: at the start, and in general, at perturbed assembled poses."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from .loop_equations import LoopEquations, Pose
from .parameters import REDUNDANCY
from .sparse_matrix import SparseMatrix


class LoopRank(NamedTuple):
    """Rank of one loop's scaled J.

    - `start`: assembled.
    - `rank`: in general: the largest rank at any pose.
    - `start_rank`: at the start; less than `rank` at a singular pose.
    - `least`: smallest singular value that counts in the rank.
    - `null_spaces` of shape (n, n - rank): left null vectors of the scaled J at general poses, including the start if
      it is one.
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
    """Return the rank of a loop's equations near a pose.

    A singular pose has a smaller rank than its neighbours; redundant equations are dependent at every pose. Singular
    values, there and at perturbed poses, are computed only if the rank is not full at the start. `q`: coordinates of
    the loop's bodies, m and rad. `t`: s.
    """
    start = equations.assembled(q, t)
    count = len(start.C)
    if start.J.singular_values_above(REDUNDANCY.sound):
        return LoopRank(equations, start, count, count, REDUNDANCY.sound, [])
    others = list(_perturbed(equations, start))
    poses = [start, *others]
    before = equations.row_scale.copy()
    equations.scale_rows([pose.J for pose in poses])
    rescaled = equations.row_scale / before
    decomposed = [small_singular(pose.J.scaled(rescaled, np.ones(pose.J.shape[1]))) for pose in poses]
    values = [s for s, _ in decomposed]
    gap = start.gap if REDUNDANCY.closed < start.gap <= REDUNDANCY.agrees else 0.0
    asked = (values[1:] if gap else _clear(values[1:])) or values[1:] or values
    rank = max(int(np.sum(s > max(REDUNDANCY.dependent, REDUNDANCY.by_gap * gap))) for s in asked)
    least = max(float(s[rank - 1]) for s in asked) if rank else 0.0
    start_rank = int(np.sum(values[0][:rank] > REDUNDANCY.sound * least))
    null_spaces = [
        (poses[k], vectors[:, vectors.shape[1] - (count - rank) :])
        for k, (s, vectors) in enumerate(decomposed)
        if (k == 0 or any(s is own for own in asked)) and np.sum(s > REDUNDANCY.sound * least) == rank
    ]
    return LoopRank(equations, start, rank, start_rank, least, null_spaces)


def _clear(values: list[np.ndarray]) -> list[np.ndarray]:
    """Return the singular values of poses that are not nearly singular."""
    return [s for s in values if not np.any((s > REDUNDANCY.dependent) & (s < REDUNDANCY.sound))]


def _perturbed(equations: LoopEquations, start: Pose) -> Iterator[Pose]:
    """Yield assembled poses near the start, with smaller perturbations if larger ones cannot be assembled."""
    rng = np.random.default_rng(1)
    size, found = REDUNDANCY.perturbation, 0
    for _ in range(REDUNDANCY.poses + REDUNDANCY.shrinks if start.gap <= REDUNDANCY.agrees else REDUNDANCY.poses):
        move = size * rng.uniform(-1, 1, len(equations.loop.columns))
        pose = equations.assembled(equations.moved(start.q, move), start.t)
        if pose.J.finite and pose.gap <= max(REDUNDANCY.closed, 2 * start.gap):
            yield pose
            found += 1
            if found == REDUNDANCY.poses:
                return
        else:
            size /= 4


def small_singular(J: SparseMatrix) -> tuple[np.ndarray, np.ndarray]:
    """Return the singular values, shape (n,), in descending order, and left singular vectors of the last of them.

    For a large matrix, one of those above `REDUNDANCY.clearly_regular` replaces all larger ones. `J`: with n rows.
    """
    n = J.shape[0]
    count = None if J.is_small else J.singular_values_below(REDUNDANCY.clearly_regular)
    if count is not None and count + REDUNDANCY.more < n:
        return _by_iteration(J, count + REDUNDANCY.more)
    vectors, values, _ = np.linalg.svd(J.dense(), full_matrices=n > J.shape[1])
    return np.pad(values, (0, n - len(values))), vectors


def _by_iteration(J: SparseMatrix, width: int) -> tuple[np.ndarray, np.ndarray]:
    """Compute the small ones by subspace iteration (Bathe and Wilson, J. Eng. Mech. Div. 98, 1972) and J^T on it."""
    n = J.shape[0]
    vectors = np.random.default_rng(1).standard_normal((n, width))
    for _ in range(REDUNDANCY.iterations):
        vectors, _ = np.linalg.qr(J.solved_gram(REDUNDANCY.shift, vectors))
    projected = J.transposed_times_all(vectors)
    _, values, turn = np.linalg.svd(projected, full_matrices=width > len(projected))
    values = np.pad(values, (0, width - len(values)))
    return np.concatenate([np.full(n - width, values[0]), values]), vectors @ turn.T
