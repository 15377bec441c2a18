"""Updates by the elimination of each supernode, as lists of small products of the same shape."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache
from itertools import product
from typing import NamedTuple

import numpy as np

from .blocks import QUAD, Blocks

ROWS, QUADS = tuple(range(QUAD, 0, -1)), tuple(range(2, 0, -1))
"""Numbers of rows and of column quads of the products, limited by the processor's registers."""
DOWN, RIGHT = range(2)
"""Kinds of targets: lines of first panels and of second panels."""
SHAPES = tuple(product((DOWN, RIGHT), ROWS, QUADS))
"""Shapes of products, in order."""


class Target(NamedTuple):
    """Lines of a supernode's panel that the elimination of an earlier supernode updates."""

    k: int  # eliminated supernode
    kind: int
    # start, stride: start and stride of the panel's lines
    start: int
    stride: int
    factors: int  # start of the multipliers of the lines, one for each
    size: int  # number of lines
    # contiguous quads: offset in the source lines, offset in the target lines, and number
    runs: list[tuple[int, int, int]]


def updates(blocks: Blocks) -> dict[str, np.ndarray]:
    """Return all products, sorted by supernode and shape, and the end of each group.

    A product consists of its target, the stride there, the multipliers, and the source lines.
    """
    targets = [target for k in range(len(blocks.nodes)) for target in _targets(blocks, k)]
    line_target, line, rows = _spread([_lines(target.size) for target in targets], 2)
    run_target, own, into, quads = _spread([target.runs for target in targets], 3)
    piece_run, shift, count = _spread([pieces_of(n) for n in quads.tolist()], 2)
    piece_target = run_target[piece_run]
    column = [
        np.array([getattr(target, name) for target in targets], dtype=np.int64)
        for name in ("k", "kind", "start", "stride", "factors")
    ]
    n_lines, n_pieces = (np.bincount(of, minlength=len(targets)) for of in (line_target, piece_target))
    of, within = _numbered(n_lines * n_pieces)
    at_line = (np.cumsum(n_lines) - n_lines)[of] + within // np.maximum(n_pieces[of], 1)
    at_piece = (np.cumsum(n_pieces) - n_pieces)[of] + within % np.maximum(n_pieces[of], 1)
    k, kind, start, stride, factors = (part[of] for part in column)
    shape = len(SHAPES) // 2 * kind + len(QUADS) * (max(ROWS) - rows[at_line]) + (max(QUADS) - count[at_piece])
    run, ahead = piece_run[at_piece], shift[at_piece]
    listed = np.stack(
        [
            start + line[at_line] * stride + into[run] + ahead,
            stride,
            factors + blocks.parts * line[at_line],
            own[run] + ahead,
        ],
        axis=1,
    )
    order = np.argsort(len(SHAPES) * k + shape, kind="stable")
    counts = np.bincount(len(SHAPES) * k + shape, minlength=len(SHAPES) * len(blocks.nodes))
    return {
        "update_end": np.cumsum(counts, dtype=np.int64),
        "update": np.ascontiguousarray(listed[order], dtype=np.int32).reshape(-1),
    }


@cache
def split(rows: int) -> list[int]:
    """Return parts of at most four rows, without single rows if possible."""
    if rows <= max(ROWS):
        return [rows] if rows else []
    first = 3 if rows in (5, 6, 9) else 4
    return [first, *split(rows - first)]


@cache
def _lines(size: int) -> list[tuple[int, int]]:
    """Return the first line and the number of lines of each part of a block."""
    parts = split(size)
    return list(zip(np.cumsum([0, *parts]).tolist(), parts, strict=False))


@cache
def pieces_of(quads: int) -> list[tuple[int, int]]:
    """Return the offset and the number of quads of each part of a run."""
    most = max(QUADS)
    return [(QUAD * first, min(most, quads - first)) for first in range(0, quads, most)]


def _targets(blocks: Blocks, k: int) -> Iterator[Target]:
    """Yield the targets of supernode k: later columns from the diagonal down, later rows right of the diagonal."""
    down, right = (int(start) for start in blocks.starts[2 * k : 2 * k + 2])
    down_at, right_at = blocks.down_at[k], blocks.right_at[k]
    below, right_of = blocks.below[k], blocks.right[k]
    for b in right_of:
        runs = _runs(blocks, [a for a in below if a >= b], down_at, blocks.down_at[b], down)
        yield Target(
            k, DOWN, int(blocks.starts[2 * b]), blocks.down_width[b], right + right_at[b], blocks.sizes[b], runs
        )
    for a in below:
        runs = _runs(blocks, [b for b in right_of if b > a], right_at, blocks.right_at[a], right)
        yield Target(
            k, RIGHT, int(blocks.starts[2 * a + 1]), blocks.right_width[a], down + down_at[a], blocks.sizes[a], runs
        )


def _runs(
    blocks: Blocks, nodes: list[int], own: dict[int, int], into: dict[int, int], start: int
) -> list[tuple[int, int, int]]:
    """Return the quads of some supernodes' blocks, joined where they are contiguous in both panels."""
    runs: list[tuple[int, int, int]] = []
    for a in nodes:
        here, there, quads = start + own[a], into[a], blocks.widths[a] // QUAD
        if runs:
            first, first_there, before = runs[-1]
            if (here, there) == (first + QUAD * before, first_there + QUAD * before):
                runs[-1] = first, first_there, before + quads
                continue
        runs.append((here, there, quads))
    return runs


def _spread(lists: Sequence[Sequence[tuple[int, ...]]], width: int) -> tuple[np.ndarray, ...]:
    """Return the concatenated members of some lists: the list of each, and its `width` numbers."""
    of, _ = _numbered(np.array([len(part) for part in lists], dtype=np.int64))
    members = np.array([number for part in lists for member in part for number in member], dtype=np.int64)
    return of, *members.reshape(-1, width).T


def _numbered(counts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the list number and the index in its list of each member, for lists of these lengths."""
    of = np.repeat(np.arange(len(counts)), counts)
    return of, np.arange(len(of)) - np.repeat(np.cumsum(counts) - counts, counts)
