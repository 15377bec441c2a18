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
    """J by blocks of a joint and a body, column by column, each filled up to whole quads.

    Attributes
    ----------
    source, at, column : ndarrays of int
        Of each entry: its value, its place, its velocity.  What is added to other entries comes last.
    begin : dict
        Where the block of a joint and a body begins.
    end : int
        Where the last ends.
    thirds : dict
        For a joint, a body and the first of three of its velocities, the rows of the joint in which each has entries.
    sides : Sides
        Those thirds whose entries are not copied one by one; what is listed above is without them.
    """

    source: np.ndarray
    at: np.ndarray
    column: np.ndarray
    begin: dict[tuple[int, int], int]
    end: int
    thirds: dict[tuple[int, int, int], list[set[int]]]
    sides: Sides


def jacobian_of(joints: Joints, system: System, kept: np.ndarray) -> Jacobian:
    """The blocks of J, of which the entries `kept` stand in equations that are solved for."""
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
    """0 where a number stands first in a list, 1 where it stands again."""
    again = np.ones(len(at), dtype=np.int64)
    again[np.unique(at, return_index=True)[1]] = 0
    return again
