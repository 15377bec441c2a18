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


def _between(matrices: np.ndarray, t: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Return matrices at other times, interpolated linearly between those at the times `t`."""
    right = np.clip(np.searchsorted(t, times), 1, len(t) - 1)
    part = ((times - t[right - 1]) / (t[right] - t[right - 1]))[:, None, None]
    return np.asarray(matrices[right - 1] + part * (matrices[right] - matrices[right - 1]))


def changes_little(space: Linearised, t: np.ndarray) -> bool:
    """Return True if the matrices at the times `t` may be interpolated between these."""
    if len(t) < 3:
        return False
    matrices = space.rates @ np.linalg.solve(space.left @ space.basis, space.left)
    part = ((t[1:-1] - t[:-2]) / (t[2:] - t[:-2]))[:, None, None]
    expected = matrices[:-2] + part * (matrices[2:] - matrices[:-2])
    off = np.linalg.norm(matrices[1:-1] - expected, axis=(1, 2)) / np.linalg.norm(matrices[1:-1], axis=(1, 2))
    return bool(off.max() <= ESTIMATE.interpolated)


def step_by_step(
    t: np.ndarray, defects: np.ndarray, space: Linearised, nodes: np.ndarray, start: np.ndarray
) -> np.ndarray:
    """Return the errors at the ends of the steps of a piece, shape (rows, full), from that at its start.

    Each step takes the stability function of the Radau method of three stages with the matrix A of its middle: e+ = D(Z)^-1
    (N(Z) e + (1 - Z/10 + Z^2/60) h d), Z = h A. `defects`: of the steps that end at each row. `space`: tangent spaces at
    the rows `nodes`.
    """
    coordinates = np.linalg.solve(space.left @ space.basis, space.left)
    rates, onto = space.rates @ coordinates, space.basis @ coordinates
    at_node = dict(zip(nodes.tolist(), onto, strict=True))
    errors = np.zeros((len(t), len(start)))
    errors[0] = start
    count = at_once(len(start))
    for first in range(0, len(t) - 1, count):
        ends = slice(first + 1, first + 1 + count)
        h = np.diff(t[first : ends.stop])
        matrices = _between(rates, t[nodes], t[ends] - 0.5 * h)
        for n, step in enumerate(_steps(h[:, None, None] * matrices, h[:, None] * defects[ends]), ends.start):
            errors[n] = step[:, :-1] @ errors[n - 1] + step[:, -1]
            if n in at_node:
                errors[n] = at_node[n] @ errors[n]
    return errors


def _steps(z: np.ndarray, sources: np.ndarray) -> np.ndarray:
    """Return the matrices of some steps, with a last column for their sources."""
    square, one = z @ z, np.eye(z.shape[1])
    below = one - 0.6 * z + 0.15 * square - z @ square / 60.0
    source = (one - 0.1 * z + square / 60.0) @ sources[..., None]
    return np.linalg.solve(below, np.concatenate([one + 0.4 * z + 0.05 * square, source], axis=2))
