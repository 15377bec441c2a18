"""Transport of the error step by step, where blocks of steps do not resolve a vibration.

Stiff, lightly damped bushings vibrate with some ten steps in a period, and the errors of their forces with them. A block of
several steps would damp these errors.
"""

from __future__ import annotations

import numpy as np

from .linearised import Linearised
from .parameters import ESTIMATE
from .transport import Block, at_once


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

    Each step takes the stability function of the Radau method of three stages with the matrix M of its middle: a+ = D(Z)^-1
    (N(Z) a + (1 - Z/10 + Z^2/60) h d), Z = h M. The coordinates a and M are those of the tangent space at the next node: a mean of
    stiff matrices of two spaces is not stable. `defects`: of the steps that end at each row. `space`: tangent spaces at the rows
    `nodes`.
    """
    errors = np.zeros((len(t), len(start)))
    errors[0] = start
    if not space.n:
        return errors
    coordinates, onto, before, after = _in_next_space(space)
    a, next_node = coordinates[0] @ start, np.searchsorted(nodes, np.arange(len(t)))
    count = at_once(space.n)
    for first in range(1, len(t), count):
        rows = np.arange(first, min(first + count, len(t)))
        k, h = next_node[rows], t[rows] - t[rows - 1]
        part = (t[rows] - 0.5 * h - t[nodes[k - 1]]) / (t[nodes[k]] - t[nodes[k - 1]])
        matrices = before[k - 1] + part[:, None, None] * (after[k - 1] - before[k - 1])
        sources = h[:, None] * np.einsum("kif,kf->ki", coordinates[k], defects[rows])
        for n, node, step in zip(rows, k, _steps(h[:, None, None] * matrices, sources), strict=True):
            if n == nodes[node - 1] + 1:
                a = onto[node - 1] @ a
            a = step[:, :-1] @ a + step[:, -1]
            errors[n] = space.basis[node] @ a
    return errors


def _in_next_space(space: Linearised) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return matrices of all nodes and of all pairs of successive nodes.

    `coordinates` of shape (nodes, n, full): from variations to coordinates in the tangent space. `onto` of shape
    (nodes - 1, n, n): from coordinates in one space to those in the next. `before`, `after`: matrices M at both nodes, in the
    coordinates of the second.
    """
    coordinates = np.linalg.solve(space.left @ space.basis, space.left)
    matrices = coordinates @ space.rates
    onto = coordinates[1:] @ space.basis[:-1]
    return coordinates, onto, onto @ matrices[:-1] @ np.linalg.inv(onto), matrices[1:]


def _steps(z: np.ndarray, sources: np.ndarray) -> np.ndarray:
    """Return the matrices of some steps, with a last column for their sources."""
    square, one = z @ z, np.eye(z.shape[1])
    below = one - 0.6 * z + 0.15 * square - z @ square / 60.0
    source = (one - 0.1 * z + square / 60.0) @ sources[..., None]
    return np.linalg.solve(below, np.concatenate([one + 0.4 * z + 0.05 * square, source], axis=2))
