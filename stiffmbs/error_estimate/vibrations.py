"""Transport of the error step by step, where blocks of steps do not resolve a vibration.

Stiff, lightly damped bushings vibrate with some ten steps in a period, and the errors of their forces with them. A block of
several steps would damp these errors.
"""

from __future__ import annotations

import numpy as np

from .linearised import Linearised
from .parameters import ESTIMATE
from .transport import RADAU_NODES, Block, at_once, integrals


def are_affordable(steps: int, size: int) -> bool:
    """Return True if a transport step by step is affordable for rows (x, v, s) of a size."""
    return steps * size**3 < ESTIMATE.operations


def are_resolved(space: Linearised, t: np.ndarray, nodes: np.ndarray, blocks: list[Block]) -> np.ndarray:
    """Return a mask of the blocks that resolve the vibrations that the steps of a run resolve.

    `space`: at the rows `nodes` of a piece with the times `t`. All blocks do if most of them do. Otherwise those do whose steps
    are far longer than the vibrations that others do not resolve.
    """
    if not space.n:
        return np.ones(len(blocks), dtype=bool)
    some = np.linspace(0, len(nodes) - 1, min(len(nodes), ESTIMATE.spectra)).astype(int)
    left = space.left[some]
    matrices = np.linalg.solve(left @ space.basis[some], left @ space.rates[some])
    rates = np.linalg.eigvals(np.where(np.isfinite(matrices), matrices, 0.0))
    frequencies = np.where(np.abs(rates.real) < np.abs(rates.imag), np.abs(rates.imag), 0.0)

    def longest(steps: np.ndarray, at: np.ndarray, resolved: float) -> np.ndarray:
        waves = frequencies[at] * steps[:, None]
        return np.asarray(np.where(waves > resolved, 0.0, waves).max(axis=1))

    at_some = longest(np.diff(t, prepend=2 * t[0] - t[1])[nodes[some]], np.arange(len(some)), ESTIMATE.resolved)
    if np.sort(at_some)[len(some) // 2] * ESTIMATE.block <= ESTIMATE.turn:
        return np.ones(len(blocks), dtype=bool)
    nearest = np.abs(t[[block.nodes[-1] for block in blocks]][:, None] - t[nodes[some]]).argmin(axis=1)
    steps = np.array([np.diff(t[block.nodes[0] : block.nodes[-1] + 1]).max() for block in blocks])
    return longest(steps, nearest, ESTIMATE.resolved * ESTIMATE.block) * ESTIMATE.block <= ESTIMATE.turn


def step_by_step(
    t: np.ndarray, defects: np.ndarray, space: Linearised, nodes: np.ndarray, start: np.ndarray
) -> np.ndarray:
    """Return the errors at the ends of the steps of a piece, shape (rows, full), from that at its start.

    Each step of a' = M a + d is one of the Radau method of three stages, with M linear in time between nodes: stiff directions
    turn with their bodies. The coordinates a and M are those of the tangent space at the next node. `defects`: of the steps that end at
    each row. `space`: tangent spaces at the rows `nodes`.
    """
    errors = np.zeros((len(t), len(start)))
    errors[0] = start
    if not space.n:
        return errors
    coordinates, onto, before, after = _in_next_space(space)
    a, next_node = coordinates[0] @ start, np.searchsorted(nodes, np.arange(len(t)))
    count = at_once(len(RADAU_NODES) * space.n)
    for first in range(1, len(t), count):
        rows = np.arange(first, min(first + count, len(t)))
        k, h = next_node[rows], t[rows] - t[rows - 1]
        at = t[rows - 1, None] + h[:, None] * RADAU_NODES
        part = (at - t[nodes[k - 1], None]) / (t[nodes[k]] - t[nodes[k - 1]])[:, None]
        matrices = before[k - 1, None] + part[..., None, None] * (after[k - 1] - before[k - 1])[:, None]
        sources = np.einsum("kif,kf->ki", coordinates[k], defects[rows])
        for n, node, step in zip(rows, k, _steps(h, matrices, sources), strict=True):
            if n == nodes[node - 1] + 1:
                a = onto[node - 1] @ a
            a = step[:, :-1] @ a + step[:, -1]
            errors[n] = space.basis[node] @ a
    return errors


def _in_next_space(space: Linearised) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return matrices of all nodes and of all pairs of successive nodes.

    `coordinates` of shape (nodes, n, full): from variations to coordinates in the tangent space. `onto` of shape
    (nodes - 1, n, n): from coordinates in one space to those in the next. `before`, `after`: matrices M at both nodes, in the
    coordinates a = C e of the second: a' = C R (C B)^-1 a.
    """
    coordinates = np.linalg.solve(space.left @ space.basis, space.left)
    onto = coordinates[1:] @ space.basis[:-1]
    before = coordinates[1:] @ space.rates[:-1] @ np.linalg.inv(onto)  # rates leave the tangent space, which turns
    return coordinates, onto, before, coordinates[1:] @ space.rates[1:]


def _steps(h: np.ndarray, matrices: np.ndarray, sources: np.ndarray) -> np.ndarray:
    """Return the matrices of some steps of lengths h, with a last column for their sources, shape (steps, n, n + 1).

    `matrices` of shape (steps, 3, n, n): M_i at the Radau nodes. `sources` d of shape (steps, n).

    With the inverse W of the matrix of weights, (W_ii - h M_i) a_i + sum_j W_ij a_j = w_i a + h d; a_1 and a_2 are eliminated.
    """
    w, one, h = np.linalg.inv(integrals(RADAU_NODES)), np.eye(matrices.shape[2]), h[:, None, None]
    sums = w.sum(axis=1)
    diagonal = np.diagonal(w)[:, None, None] * one - h[:, None] * matrices
    first = np.linalg.inv(diagonal[:, 0])
    second = (w[2, 1] * one - w[2, 0] * w[0, 1] * first) @ np.linalg.inv(diagonal[:, 1] - w[1, 0] * w[0, 1] * first)
    both = second @ first
    below = diagonal[:, 2] - w[2, 0] * w[0, 2] * first - w[1, 2] * second + w[1, 0] * w[0, 2] * both
    step = sums[2] * one - sums[0] * w[2, 0] * first - sums[1] * second + sums[0] * w[1, 0] * both
    source = h * (one - w[2, 0] * first - second + w[1, 0] * both) @ sources[..., None]
    return np.asarray(np.linalg.solve(below, np.concatenate([step, source], axis=2)))
