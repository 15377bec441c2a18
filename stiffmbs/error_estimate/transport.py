"""Transport of the error, e' = J e + d, along the recorded steps, by collocation over blocks of them.

With e = B a in the tangent space of each node, L B a = L (B_0 a_0 + D + sum_j w_j R_j a_j) at the nodes of a block, whose
first state is the end of the block before it. The nodes are near those of a Radau method, so that stiff parts decay.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..solve.radau.collocation import radau
from .linearised import Linearised
from .parameters import ESTIMATE

RADAU_NODES = radau(3).nodes


@dataclass(frozen=True)
class Block:
    """Nodes of one block, as rows of the piece: its start, then the others.

    `local` of shape (nodes, full): integrals of the defect from the start to each node but the first. `times` of shape
    (nodes,): those of these nodes since the start, s.
    """

    nodes: np.ndarray
    local: np.ndarray
    times: np.ndarray


def blocks_of_bdf(t: np.ndarray, defects: np.ndarray) -> list[Block]:
    """Return the blocks of the steps that end at t[1:], with their mean defects in the rows of `defects`."""
    found, first = [], 0
    summed = np.cumsum(np.diff(t, prepend=t[0])[:, None] * defects, axis=0)
    while first < len(t) - 1:
        rows = _rows(t, first)
        found.append(Block(rows, summed[rows[1:]] - summed[rows[0]], t[rows[1:]] - t[rows[0]]))
        first = int(rows[-1])
    return found


def _rows(t: np.ndarray, first: int) -> np.ndarray:
    """Return the rows of a block: its start, and ends of steps near Radau nodes, or else those of two steps."""
    left = len(t) - 1 - first
    for steps in range(min(ESTIMATE.block, left), len(RADAU_NODES) - 1, -1):
        ends = (t[first + 1 : first + steps + 1] - t[first]) / (t[first + steps] - t[first])
        chosen = np.abs(ends[:, None] - RADAU_NODES).argmin(axis=0)
        near = np.abs(ends[chosen] - RADAU_NODES).max() < ESTIMATE.off_node
        if near and chosen[0] < chosen[1] < chosen[2]:
            return np.concatenate([[first], first + 1 + chosen])
    return first + np.arange(min(2, left) + 1)


def integrals(nodes: np.ndarray) -> np.ndarray:
    """Return the integrals from 0 to each node of the Lagrange polynomials through the nodes.

    `nodes` of shape (..., k). Returns an array of shape (..., k, k).
    """
    size = nodes[..., -1:, None]
    powers = np.arange(nodes.shape[-1])
    x = nodes[..., None] / size
    transposed = np.swapaxes(x**powers, -1, -2)
    integrated = np.swapaxes(x ** (powers + 1) / (powers + 1), -1, -2)
    return np.asarray(size * np.swapaxes(np.linalg.solve(transposed, integrated), -1, -2))


def integrated(sizes: np.ndarray, rates: np.ndarray) -> np.ndarray:
    """Return the integrals of rates at the points of steps of radau from their starts, shape (steps, points, full)."""
    return np.asarray(sizes[:, None, None] * np.einsum("ij,njf->nif", integrals(radau(rates.shape[1]).nodes), rates))


def blocks_of_radau(t: np.ndarray, local: np.ndarray) -> list[Block]:
    """Return one block for each step of radau from the integrals of defects at its points, shape (steps, points, full)."""
    steps, points, _ = local.shape
    rows = np.arange(steps)[:, None] * points + np.arange(points + 1)
    sizes = t[rows[:, -1]] - t[rows[:, 0]]
    return [Block(*each) for each in zip(rows, local, sizes[:, None] * radau(points).nodes, strict=True)]


def transported(blocks: list[Block], space: Linearised, place: np.ndarray, start: np.ndarray) -> np.ndarray:
    """Return the errors at the nodes of all blocks, one row for each state of `space`.

    `place`: index in `space` of each row of the piece. `start` of shape (full,): the error at the start.
    """
    basis, left = space.basis, space.left
    errors = np.zeros((len(basis), basis.shape[1]))
    n = space.n
    if not n:
        return errors
    maps, sources = _solved(blocks, space, place)
    first = place[blocks[0].nodes[0]]
    a = np.linalg.solve(left[first] @ basis[first], left[first] @ start)
    errors[first] = basis[first] @ a
    for block, by_start, source in zip(blocks, maps, sources, strict=True):
        inner = by_start @ a + source
        at = place[block.nodes[1:]]
        errors[at] = np.einsum("kfn,kn->kf", basis[at], inner.reshape(len(at), n))
        a = inner[-n:]
    return errors


def at_once(size: int) -> int:
    """Return the number of matrices of a size that are in memory at once."""
    return max(1, ESTIMATE.numbers_at_once // size**2)


def _solved(blocks: list[Block], space: Linearised, place: np.ndarray) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Return a at the nodes of each block as a linear function of a at its start: matrix and constant part."""
    n, maps, sources = space.n, {}, {}
    counts = np.array([len(block.nodes) - 1 for block in blocks])
    for k in np.flatnonzero(np.bincount(counts)):
        chosen = np.flatnonzero(counts == k)
        count = at_once(int(k) * n)
        for some in np.split(chosen, np.arange(count, len(chosen), count)):
            own = [blocks[b] for b in some]
            first = place[np.array([block.nodes[0] for block in own])]
            at = place[np.array([block.nodes[1:] for block in own])]
            weights = integrals(np.array([block.times for block in own]))
            local = np.array([block.local for block in own])
            left = space.left[at]  # (blocks, k, n, full)
            matrix = -weights[:, :, None, :, None] * np.einsum("bknf,bjfm->bknjm", left, space.rates[at], optimize=True)
            own_part = left @ space.basis[at]
            for i in range(k):
                matrix[:, i, :, i] += own_part[:, i]
            by_start = left @ space.basis[first][:, None]
            constant = left @ local[..., None]
            right = np.concatenate([by_start, constant], axis=3).reshape(len(own), k * n, n + 1)
            found = np.linalg.solve(matrix.reshape(len(own), k * n, k * n), right)
            for b, each in zip(some.tolist(), found, strict=True):
                maps[b], sources[b] = each[:, :n], each[:, n]
    return [maps[b] for b in range(len(blocks))], [sources[b] for b in range(len(blocks))]
