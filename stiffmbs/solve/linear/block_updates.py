"""What the elimination of each node takes out of later blocks, as lists of small products of one shape."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from typing import Any

import numpy as np

from .blocks import QUAD, Blocks

ROWS, QUADS = (4, 3, 2, 1), (2, 1)
"""Rows and quads of columns of the products: what fits into a processor's registers."""
SHAPES = tuple(product((0, 1), ROWS, QUADS))
"""Shapes of products in both kinds of targets: lines of first panels, of second ones."""

Update = tuple[int, int, int, int]
"""Target, stride of its lines, the factors that are spread, the lines of columns."""


def updates(blocks: Blocks) -> dict[str, np.ndarray]:
    """All products, node by node and shape by shape, and where each node's of each shape end."""
    ends, listed = [], []
    for k in range(len(blocks.nodes)):
        of_shape: dict[Any, list[Update]] = {shape: [] for shape in SHAPES}
        for kind, parts in ((0, _downward(blocks, k)), (1, _rightward(blocks, k))):
            for rows, quads, update in parts:
                of_shape[kind, rows, quads].append(update)
        for shape in SHAPES:
            listed += of_shape[shape]
            ends.append(len(listed))
    return {
        "update_end": np.array(ends, dtype=np.int64),
        "update": np.array(listed or [(0, 0, 0, 0)], dtype=np.int64).reshape(-1),
    }


def split(rows: int) -> list[int]:
    """So many rows in parts of at most four, none alone where that can be."""
    if rows <= max(ROWS):
        return [rows] if rows else []
    first = 3 if rows in (5, 6, 9) else 4
    return [first, *split(rows - first)]


def _downward(blocks: Blocks, k: int) -> Iterator[tuple[int, int, Update]]:
    """Products for lines of first panels: the columns of each node right of k, from its own diagonal down."""
    down, right = (int(start) for start in blocks.starts[2 * k : 2 * k + 2])
    for b in blocks.right[k]:
        target, stride, at = int(blocks.starts[2 * b]), blocks.down_width[b], blocks.down_at[b]
        ahead = [a for a in blocks.below[k] if a >= b]
        quads = _quads(blocks, ahead, blocks.down_at[k], at)
        for line, rows in _lines(blocks.sizes[b]):
            for count, own, into in quads:
                update = target + line * stride + into, stride, right + blocks.right_at[k][b] + line, down + own
                yield rows, count, update


def _rightward(blocks: Blocks, k: int) -> Iterator[tuple[int, int, Update]]:
    """Products for lines of second panels: the rows of each node below k, right of its own diagonal."""
    down, right = (int(start) for start in blocks.starts[2 * k : 2 * k + 2])
    for a in blocks.below[k]:
        target, stride, at = int(blocks.starts[2 * a + 1]), blocks.right_width[a], blocks.right_at[a]
        ahead = [b for b in blocks.right[k] if b > a]
        quads = _quads(blocks, ahead, blocks.right_at[k], at)
        for line, rows in _lines(blocks.sizes[a]):
            for count, own, into in quads:
                update = target + line * stride + into, stride, down + blocks.down_at[k][a] + line, right + own
                yield rows, count, update


def _lines(size: int) -> list[tuple[int, int]]:
    """First line and number of lines of each part of a block."""
    parts = split(size)
    return list(zip(np.cumsum([0, *parts]).tolist(), parts, strict=False))


def _quads(blocks: Blocks, nodes: list[int], own: dict[int, int], into: dict[int, int]) -> list[tuple[int, int, int]]:
    """One or two quads at a time of the blocks of some nodes: how many, where they stand, and where they go."""
    single = [
        (own[a] + shift, into[a] + shift) for a in nodes for shift in range(0, blocks.widths[a], QUAD)
    ]  # fmt: skip
    found, at = [], 0
    while at < len(single):
        here, there = single[at]
        two = at + 1 < len(single) and single[at + 1] == (here + QUAD, there + QUAD)
        found.append((2 if two else 1, here, there))
        at += 2 if two else 1
    return found
