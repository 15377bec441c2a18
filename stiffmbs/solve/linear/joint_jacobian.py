"""J by dense blocks of a joint and a body."""

from __future__ import annotations

from itertools import accumulate
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...compile.system import System
from .joint_sides import Sides, sides_of

if TYPE_CHECKING:
    from .joint_blocks import Joints


class Jacobian(NamedTuple):
    """Blocks of J for pairs of a joint and a body, by columns, each padded to whole quads.

    Attributes
    ----------
    source, at, column : ndarrays of int
        Value, position and velocity of each entry.  Entries added to others come last.
    begin : dict
        Start of the block of a joint and a body.
    end : int
        End of the last block.
    thirds : dict
        Rows of the joint with entries for each of three velocities, by joint, body and first velocity.
    sides : Sides
        Thirds whose entries are not copied one by one; the entries above exclude them.
    """

    source: np.ndarray
    at: np.ndarray
    column: np.ndarray
    begin: dict[tuple[int, int], int]
    end: int
    thirds: dict[tuple[int, int, int], list[set[int]]]
    sides: Sides


def jacobian_of(joints: Joints, system: System, kept: np.ndarray) -> Jacobian:
    """Return the blocks of J; its entries `kept` are those in solved equations."""
    node, within = np.zeros(system.n_c, dtype=np.int64), np.zeros(system.n_c, dtype=np.int64)
    for k, rows in enumerate(joints.rows):
        node[rows], within[rows] = k, np.arange(len(rows))
    jacobian, width = system.term("acceleration", "J"), system.of_body.n_u
    row, column, source = jacobian.row[kept], jacobian.column[kept], jacobian.source[kept]
    body, line = column // width, column % width
    pairs = [(k, own) for k, bodies in enumerate(joints.bodies) for own in bodies]
    begins = list(accumulate((width * joints.widths[k] for k, _ in pairs), initial=0))
    begin = dict(zip(pairs, begins, strict=False))
    starts = np.array([begin[both] for both in zip(node[row].tolist(), body.tolist(), strict=True)], dtype=np.int64)
    at = starts + line * np.array(joints.widths, dtype=np.int64)[node[row]] + within[row]
    thirds: dict[tuple[int, int, int], list[set[int]]] = {}
    for k, own, place, r in zip(node[row].tolist(), body.tolist(), line.tolist(), within[row].tolist(), strict=True):
        third = thirds.setdefault((k, own, place - place % 3), [set(), set(), set()])
        third[place % 3].add(r)
    places = list(zip(node[row].tolist(), body.tolist(), line.tolist(), within[row].tolist(), strict=True))
    sides = sides_of(places, source.tolist(), joints.sizes)
    copied = [n for n, (k, own, place, _) in enumerate(places) if (k, own, place - place % 3) not in sides.handled]
    order = np.array(copied, dtype=np.int64)[np.argsort(_occurrence(at[copied]), kind="stable")]
    return Jacobian(source[order], at[order], column[order], begin, begins[-1], thirds, sides)


def _occurrence(at: np.ndarray) -> np.ndarray:
    """Return 0 for the first occurrence of each number in a list, 1 for others."""
    again = np.ones(len(at), dtype=np.int64)
    again[np.unique(at, return_index=True)[1]] = 0
    return again
