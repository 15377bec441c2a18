"""Index lists of J M^-1 J^T by dense joint blocks (`stiffmbs.solve.native.elimination.by_blocks`)."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from itertools import accumulate, combinations_with_replacement, product
from typing import Any

import numpy as np

from ...compile.equations import ABSENT
from ...compile.machine.layout import arrays_of
from ...compile.system import System
from ..native.tables.linear import BLOCK_ELIMINATION
from .block_updates import pieces_of
from .blocks import QUAD, at_a_line, padded
from .joint_jacobian import Jacobian, jacobian_of
from .joint_sides import side_lists

MOST_LINES = 6
"""Lines of a product of two quads that fit into registers."""
Rows = list[tuple[int, ...]]
Piece = tuple[int, int, int]
"""Shape, first line and first column of the part of a product that fits into registers."""


class Joints:
    """Joints in the order of elimination, each with a panel: its block, then those of later joints.

    Parameters
    ----------
    rows : list of ndarray of int
        Equations of each joint that are solved.
    bodies : list of list of int
        Bodies of each joint, without ground.

    Attributes
    ----------
    sizes, widths : lists of int
        Number of equations of each joint, and the same rounded up to whole quads.
    below : list of list of int
        Later joints that the elimination of each joint updates.
    """

    def __init__(self, rows: list[np.ndarray], bodies: list[list[int]]) -> None:
        self.rows, self.bodies = rows, bodies
        self.sizes = list(map(len, rows))
        self.widths = list(map(padded, self.sizes))
        self.below = _filled(bodies)

    @property
    def updates(self) -> int:
        """Return the number of multiplications of the elimination."""
        heights = (
            sum(self.sizes[b] for b in below) + left
            for size, below in zip(self.sizes, self.below, strict=True)
            for left in range(size)
        )
        return sum(height * (height + 1) // 2 for height in heights)

    @cached_property
    def offsets(self) -> list[dict[int, int]]:
        """Return the offsets of blocks in the lines of each panel; the line length has the number of joints as key."""
        return [
            dict(
                zip(
                    [k, *below, len(self.rows)],
                    accumulate((self.widths[b] for b in [k, *below]), initial=0),
                    strict=True,
                )
            )
            for k, below in enumerate(self.below)
        ]

    @cached_property
    def strides(self) -> list[int]:
        """Return the lengths of the panels' lines."""
        return [offsets[len(self.rows)] for offsets in self.offsets]

    @cached_property
    def starts(self) -> list[int]:
        """Return the starts of the panels, and the end of the last."""
        return list(
            accumulate((size * stride for size, stride in zip(self.sizes, self.strides, strict=True)), initial=0)
        )

    @cached_property
    def multiplied_starts(self) -> list[int]:
        """Return the starts of each joint's right blocks times its inverse, after all panels, and their end."""
        lengths = (s * (stride - w) for s, stride, w in zip(self.sizes, self.strides, self.widths, strict=True))
        return list(accumulate(lengths, initial=self.starts[-1]))

    @cached_property
    def places(self) -> list[int]:
        """Return the start of each joint in a vector of whole quads, and the end of the last."""
        return list(accumulate(self.widths, initial=0))


def block_lists(joints: Joints, system: System, kept: np.ndarray) -> dict[str, Any]:
    """Return the lists of joints in `stiffmbs.solve.native.tables.linear.BLOCK_ELIMINATION`.

    Parameters
    ----------
    joints : Joints
    system : System
    kept : ndarray of int
        Entries of J in solved equations.
    """
    place = np.full(system.n_c, ABSENT)
    for start, rows in zip(joints.places, joints.rows, strict=False):
        place[rows] = start + np.arange(len(rows))
    gamma = system.term("acceleration", "gamma")
    solved = np.flatnonzero(place[gamma.row] != ABSENT)
    j, scale = jacobian_of(joints, system, kept), 1.0 / np.sqrt(system.mass)
    updates = [list(_updates(joints, k)) for k in range(len(joints.sizes))]
    right = [[x for b in below for x in range(joints.places[b], joints.places[b + 1], QUAD)] for below in joints.below]
    pairs, singles = _pairs(joints, j, system.of_body.n_u)
    forming, products = _products(joints, j)
    lists = {
        "gamma_source": gamma.source[solved], "gamma_place": place[gamma.row[solved]],
        "j_source": j.source, "j_at": j.at, "j_scale": scale[j.column], "scale": scale, "j": at_a_line(j.end),
        **side_lists(joints, j.sides, j.begin, system.of_body.n_u),
        "pair": pairs, "single": singles, "forming": forming, "product": products,
        "node": list(_nodes(joints, updates, right)), "blocks": at_a_line(joints.multiplied_starts[-1]),
        "update": [row for part in updates for row in part], "right": [x for part in right for x in part], "place": place,
        "pivot": np.zeros(sum(joints.sizes)), "diagonal": np.zeros(sum(joints.sizes)),
        "x": at_a_line(joints.places[-1]), "y": at_a_line(joints.places[-1]),
    }  # fmt: skip
    return {
        **arrays_of(BLOCK_ELIMINATION, lists), "n_full": len(lists["full"]), "n_diagonals": len(lists["straight"]), "n_gamma": len(solved), "n_first": len(np.unique(j.at)), "n_j": len(j.at),
        "n_pairs": len(pairs), "n_singles": len(singles), "n_forming": len(forming), "n_products": len(products),
        "n_nodes": len(joints.sizes), "n_panels": joints.starts[-1], "n_x": joints.places[-1], "n_pivots": sum(joints.sizes),
    }  # fmt: skip


def _nodes(joints: Joints, updates: list[Any], right: list[Any]) -> Iterator[tuple[int, ...]]:
    """Yield the rows of ``node``."""
    ends = (accumulate(map(len, part)) for part in (updates, right))
    first = accumulate(joints.sizes, initial=0)
    for k, (pivot, update_end, right_end) in enumerate(zip(first, *ends, strict=False)):
        size, width, stride = joints.sizes[k], joints.widths[k], joints.strides[k]
        panel = size, width, joints.starts[k], stride, joints.multiplied_starts[k], stride - width
        yield *panel, joints.places[k], pivot, update_end, right_end


def _pairs(joints: Joints, j: Jacobian, width: int) -> tuple[Rows, Rows]:
    """Return the rows of ``pair`` and ``single``."""
    pairs: Rows = []
    singles: Rows = []
    for (k, body, first), rows in j.thirds.items():
        if (k, body, first) in j.sides.handled:
            continue
        begin, velocity, x = j.begin[k, body] + first * joints.widths[k], width * body + first, joints.places[k]
        if _is_thin(rows):
            singles += [
                (x + row, begin + i * joints.widths[k] + row, velocity + i) for i, own in enumerate(rows) for row in own
            ]
        else:
            pairs.append((x, begin, velocity, joints.widths[k]))
    return pairs, singles


def _products(joints: Joints, j: Jacobian) -> tuple[Rows, Rows]:
    """Return the rows of ``forming`` and ``product``: products of blocks of J of two joints of a body."""
    of_third: dict[tuple[int, int], list[int]] = {}
    for k, body, first in sorted(j.thirds):
        of_third.setdefault((body, first), []).append(k)
    forming: Rows = []
    single: Rows = []
    for (body, first), meeting in of_third.items():
        for k, other in combinations_with_replacement(meeting, 2):
            if k == other and (k, body, first) in j.sides.handled:
                continue
            start, stride = joints.starts[k] + joints.offsets[k][other], joints.strides[k]
            widths = joints.widths[k], joints.widths[other]
            a, b = (j.begin[one, body] + first * width for one, width in zip((k, other), widths, strict=True))
            rows, columns = j.thirds[k, body, first], j.thirds[other, body, first]
            if _is_thin(rows) and _is_thin(columns):
                single += [
                    (start + row * stride + column, a + i * widths[0] + row, b + i * widths[1] + column)
                    for i, both in enumerate(zip(rows, columns, strict=True))
                    for row, column in product(*both)
                ]
                continue
            forming += [
                (shape, start + line * stride + shift, stride, a + line, widths[0], b + shift, widths[1])
                for shape, line, shift in _parts(joints.sizes[k], widths[1])
            ]
    return forming, single


def _is_thin(rows: list[set[int]]) -> bool:
    """Return True if each of three velocities is in at most one equation."""
    return max(map(len, rows)) < 2


def _updates(joints: Joints, k: int) -> Iterator[tuple[int, ...]]:
    """Yield the rows of ``update`` of one joint: updates of the panels of later joints by its elimination."""
    below, offsets = joints.below[k], joints.offsets[k]
    for first, b in enumerate(below):
        factors = joints.multiplied_starts[k] + offsets[b] - joints.widths[k]
        for a in below[first:]:
            into, lines = joints.starts[b] + joints.offsets[b][a], joints.starts[k] + offsets[a]
            for shape, line, column in _parts(joints.sizes[b], joints.widths[a]):
                yield shape, into + line * joints.strides[b] + column, joints.strides[b], factors + line, lines + column


def _parts(lines: int, width: int) -> Iterator[Piece]:
    """Yield the parts of a product with this number of lines."""
    for first in range(0, lines, MOST_LINES):
        rows = min(MOST_LINES, lines - first)
        for shift, quads in pieces_of(width // QUAD):
            yield 2 * rows - (2 - quads), first, shift


def _filled(bodies: list[list[int]]) -> list[list[int]]:
    """Return the later joints that share a body with each joint, or become coupled with it by elimination."""
    of_body: dict[int, list[int]] = {}
    for k, places in enumerate(bodies):
        for body in places:
            of_body.setdefault(body, []).append(k)
    below: list[set[int]] = [set() for _ in bodies]
    for meeting in of_body.values():
        for first, k in enumerate(meeting):
            below[k] |= set(meeting[first + 1 :])
    for own in below:
        if own:
            parent = min(own)
            below[parent] |= own - {parent}
    return [sorted(own) for own in below]
