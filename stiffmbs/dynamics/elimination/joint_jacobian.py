"""J by dense blocks of a joint and a body."""

from __future__ import annotations

from itertools import accumulate
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...compile.system import System
from .native.layouts import MOST_ROWS, DiagonalBlock, FullBlock

if TYPE_CHECKING:
    from .joint_blocks import Joints

COLUMNS = range(3)
Third = tuple[int, int, int]
"""Joint, body, and the first of three velocities."""
Entries = dict[tuple[int, int], list[int]]
"""Sources of the entries of a third by row and column; several are added."""


class Jacobian(NamedTuple):
    """Blocks of J for pairs of a joint and a body, by columns, each padded to whole quads.

    - `source`, `at`, `column`: value, position and velocity of each entry outside regular blocks.  Entries added to
      others come last.
    - `begin`: start of the block of a joint and a body.
    - `end`: end of the last block.
    - `thirds`: rows of the joint with entries for each of three velocities.
    - `full`, `full_source`: blocks with three velocities in all rows of a joint, and the start of each row's entries
      among the values.
    - `diagonal`: blocks with three velocities diagonally in three rows.
    - `regular`: thirds of these blocks.
    """

    source: np.ndarray
    at: np.ndarray
    column: np.ndarray
    begin: dict[tuple[int, int], int]
    end: int
    thirds: dict[Third, list[set[int]]]
    full: list[FullBlock]
    full_source: list[list[int]]
    diagonal: list[DiagonalBlock]
    regular: set[Third]


def jacobian_of(joints: Joints, system: System, kept: np.ndarray) -> Jacobian:
    """Return the blocks of J; its entries `kept` are those in solved equations."""
    joint, within = np.zeros(system.n_c, dtype=np.int64), np.zeros(system.n_c, dtype=np.int64)
    for k, rows in enumerate(joints.nodes):
        joint[rows], within[rows] = k, np.arange(len(rows))
    jacobian, width = system.term("acceleration", "J"), system.of_body.n_u
    row, column, source = jacobian.row[kept], jacobian.column[kept], jacobian.source[kept]
    body, line = column // width, column % width
    pairs = [(k, own) for k, bodies in enumerate(joints.bodies) for own in bodies]
    begins = list(accumulate((width * joints.widths[k] for k, _ in pairs), initial=0))
    begin = dict(zip(pairs, begins, strict=False))
    starts = np.array([begin[both] for both in zip(joint[row].tolist(), body.tolist(), strict=True)], dtype=np.int64)
    at = starts + line * np.array(joints.widths, dtype=np.int64)[joint[row]] + within[row]
    keys: list[Third] = list(zip(joint[row].tolist(), body.tolist(), (line - line % 3).tolist(), strict=True))
    entries: dict[Third, Entries] = {}
    for key, r, c, value in zip(keys, within[row].tolist(), (line % 3).tolist(), source.tolist(), strict=True):
        entries.setdefault(key, {}).setdefault((r, c), []).append(value)
    thirds = {key: [{r for r, c in own if c == column} for column in COLUMNS] for key, own in entries.items()}
    full, full_source, diagonal, regular = [], [], [], set[Third]()
    for key, own in entries.items():
        if starts_of_rows := _full(own, joints.sizes[key[0]]):
            full.append(_full_block(joints, key, begin, width))
            full_source.append([*starts_of_rows, *[0] * (MOST_ROWS - len(starts_of_rows))])
        elif sources := _diagonal(own):
            diagonal.append(_diagonal_block(joints, key, begin, width, min(r for r, _ in own), sources))
        else:
            continue
        regular.add(key)
    copied = [n for n, key in enumerate(keys) if key not in regular]
    added = np.ones(len(copied), dtype=bool)
    added[np.unique(at[copied], return_index=True)[1]] = False
    order = np.array(copied, dtype=np.int64)[np.argsort(added, kind="stable")]
    return Jacobian(
        source[order], at[order], column[order], begin, begins[-1], thirds, full, full_source, diagonal, regular
    )


def _full(own: Entries, size: int) -> list[int] | None:
    """Return the starts of the rows' entries of a third that is full, with entries of a row one after the other."""
    starts = [own.get((row, 0), [0])[0] for row in range(size)]
    wanted = {(row, c): [starts[row] + c] for row in range(size) for c in COLUMNS}
    return starts if size <= MOST_ROWS and own == wanted else None


def _diagonal(own: Entries) -> list[int] | None:
    """Return the sources of a third with one entry in each of three successive rows."""
    first = min(row for row, _ in own)
    found = [own.get((first + c, c), []) for c in COLUMNS]
    return [part[0] for part in found] if len(own) == 3 and all(len(part) == 1 for part in found) else None


def _full_block(joints: Joints, key: Third, begin: dict[tuple[int, int], int], width: int) -> FullBlock:
    k, body, first = key
    return FullBlock(
        size=joints.sizes[k],
        block=joints.panels[k],
        stride=joints.down_width[k],
        x=joints.node_starts[k],
        j=begin[k, body] + first * joints.widths[k],
        velocity=width * body + first,
    )


def _diagonal_block(
    joints: Joints, key: Third, begin: dict[tuple[int, int], int], width: int, row: int, sources: list[int]
) -> DiagonalBlock:
    k, body, first = key
    step = joints.down_width[k] + 1
    return DiagonalBlock(
        joints.panels[k] + row * step, step, joints.node_starts[k] + row,
        begin[k, body] + first * joints.widths[k] + row, joints.widths[k] + 1, width * body + first, *sources,
    )  # fmt: skip
