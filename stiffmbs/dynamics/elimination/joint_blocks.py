"""Index lists of J M^-1 J^T by dense joint blocks (`stiffmbs.dynamics.elimination.native.by_blocks`)."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from itertools import accumulate, combinations_with_replacement, product
from operator import mul
from typing import Any

import numpy as np

from ...compile.equations import ABSENT
from ...compile.machine.layout import QUAD, arrays_of, at_a_line
from ...compile.system import System
from ...sparse.block_updates import pieces_of
from ...sparse.blocks import Blocks, filled_below
from .joint_jacobian import Jacobian, jacobian_of
from .native.layouts import (
    BLOCK_ELIMINATION,
    MOST_ROWS,
    BlockProduct,
    CopiedBlock,
    EntryProduct,
    JointPanel,
    PanelUpdate,
    SingleEntry,
)

Piece = tuple[int, int, int]
"""Shape, first line and first column of the part of a product that fits into registers."""


class Joints(Blocks):
    """Joints in the order of elimination, each with a panel: its block, then those of later joints that it updates.

    `rows`: equations of each joint that are solved. `bodies`: bodies of each joint, without ground.
    """

    bodies: list[list[int]]

    def __init__(self, rows: list[np.ndarray], bodies: list[list[int]]) -> None:
        below = _below(bodies)
        super().__init__(rows, below, below)
        vars(self).update(bodies=bodies)

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
    def panels(self) -> list[int]:
        """Return the starts of the panels, and the end of the last."""
        return list(accumulate(map(mul, self.sizes, self.down_width), initial=0))

    @cached_property
    def scaled(self) -> list[int]:
        """Return the starts of each joint's right blocks times its inverse, after all panels, and their end."""
        return list(accumulate(map(mul, self.sizes, self.right_width), initial=self.panels[-1]))


def block_lists(joints: Joints, system: System, kept: np.ndarray) -> dict[str, object]:
    """Return the lists of joints in `stiffmbs.dynamics.elimination.native.layouts.BLOCK_ELIMINATION`.

    `kept`: entries of J in solved equations.
    """
    place = np.full(system.n_c, ABSENT)
    for start, rows in zip(joints.node_starts, joints.nodes, strict=False):
        place[rows] = start + np.arange(len(rows))
    gamma = system.term("acceleration", "gamma")
    solved = np.flatnonzero(place[gamma.row] != ABSENT)
    j, scale, width = jacobian_of(joints, system, kept), 1.0 / np.sqrt(system.mass), system.of_body.n_u
    updates = [list(_updates(joints, k)) for k in range(len(joints.sizes))]
    right = [
        [x for b in below for x in range(joints.node_starts[b], joints.node_starts[b + 1], QUAD)]
        for below in joints.below
    ]
    copied, singles = _copied(joints, j, width)
    products, single_products = _products(joints, j)
    lists = {
        "gamma_source": gamma.source[solved],
        "gamma_place": place[gamma.row[solved]],
        "j_source": j.source,
        "j_at": j.at,
        "j_scale": scale[j.column],
        "scale": scale,
        "j": at_a_line(j.end),
        "full": j.full,
        "full_source": j.full_source,
        "diagonal": j.diagonal,
        "copied": copied,
        "single": singles,
        "product": products,
        "single_product": single_products,
        "joint": list(_panels(joints, updates, right)),
        "blocks": at_a_line(joints.scaled[-1]),
        "update": [row for part in updates for row in part],
        "right": [x for part in right for x in part],
        "place": place,
        "pivot": np.zeros(sum(joints.sizes)),
        "pivot_scale": np.zeros(sum(joints.sizes)),
        "x": at_a_line(joints.node_starts[-1]),
        "y": at_a_line(joints.node_starts[-1]),
    }
    numbers = {
        "n_gamma": len(solved),
        "n_first": len({*np.asarray(j.at).tolist()}),
        "n_j": len(j.at),
        "n_full": len(j.full),
        "n_diagonal": len(j.diagonal),
        "n_copied": len(copied),
        "n_single": len(singles),
        "n_products": len(products),
        "n_single_products": len(single_products),
        "n_joints": len(joints.sizes),
        "n_panels": joints.panels[-1],
        "n_x": joints.node_starts[-1],
        "n_pivots": sum(joints.sizes),
    }
    return {**arrays_of(BLOCK_ELIMINATION, lists), **numbers}


def _panels(joints: Joints, updates: list[Any], right: list[Any]) -> Iterator[JointPanel]:
    update_ends, right_ends = (list(accumulate(map(len, part))) for part in (updates, right))
    pivots = list(accumulate(joints.sizes, initial=0))
    for k, (size, width, stride) in enumerate(zip(joints.sizes, joints.widths, joints.down_width, strict=True)):
        yield JointPanel(
            size=size,
            width=width,
            start=joints.panels[k],
            stride=stride,
            scaled=joints.scaled[k],
            scaled_width=stride - width,
            x=joints.node_starts[k],
            pivot=pivots[k],
            updates_end=update_ends[k],
            right_end=right_ends[k],
        )


def _copied(joints: Joints, j: Jacobian, width: int) -> tuple[list[CopiedBlock], list[SingleEntry]]:
    """Return the rows of ``copied`` and ``single``."""
    blocks: list[CopiedBlock] = []
    singles: list[SingleEntry] = []
    for (k, body, first), rows in j.thirds.items():
        if (k, body, first) in j.regular:
            continue
        begin, velocity, x = j.begin[k, body] + first * joints.widths[k], width * body + first, joints.node_starts[k]
        if _is_thin(rows):
            singles += [
                SingleEntry(x + row, begin + i * joints.widths[k] + row, velocity + i)
                for i, own in enumerate(rows)
                for row in own
            ]
        else:
            blocks.append(CopiedBlock(x, begin, velocity, joints.widths[k]))
    return blocks, singles


def _products(joints: Joints, j: Jacobian) -> tuple[list[BlockProduct], list[EntryProduct]]:
    """Return the rows of ``product`` and ``single_product``: products of blocks of J of two joints of a body."""
    of_third: dict[tuple[int, int], list[int]] = {}
    for k, body, first in sorted(j.thirds):
        of_third.setdefault((body, first), []).append(k)
    products: list[BlockProduct] = []
    single: list[EntryProduct] = []
    for (body, first), meeting in of_third.items():
        for k, other in combinations_with_replacement(meeting, 2):
            if k == other and (k, body, first) in j.regular:
                continue
            start, stride = joints.panels[k] + joints.down_at[k][other], joints.down_width[k]
            widths = joints.widths[k], joints.widths[other]
            a, b = (j.begin[one, body] + first * width for one, width in zip((k, other), widths, strict=True))
            rows, columns = j.thirds[k, body, first], j.thirds[other, body, first]
            if _is_thin(rows) and _is_thin(columns):
                single += [
                    EntryProduct(start + row * stride + column, a + i * widths[0] + row, b + i * widths[1] + column)
                    for i, both in enumerate(zip(rows, columns, strict=True))
                    for row, column in product(*both)
                ]
                continue
            products += [
                BlockProduct(shape, start + line * stride + shift, stride, a + line, widths[0], b + shift, widths[1])
                for shape, line, shift in _parts(joints.sizes[k], widths[1])
            ]
    return products, single


def _is_thin(rows: list[set[int]]) -> bool:
    """Return True if each of three velocities is in at most one equation."""
    return max(map(len, rows)) < 2


def _updates(joints: Joints, k: int) -> Iterator[PanelUpdate]:
    """Yield the rows of ``update`` of one joint: updates of the panels of later joints by its elimination."""
    below, offsets = joints.below[k], joints.down_at[k]
    for first, b in enumerate(below):
        factors = joints.scaled[k] + offsets[b] - joints.widths[k]
        for a in below[first:]:
            into, lines = joints.panels[b] + joints.down_at[b][a], joints.panels[k] + offsets[a]
            for shape, line, column in _parts(joints.sizes[b], joints.widths[a]):
                target = into + line * joints.down_width[b] + column
                yield PanelUpdate(shape, target, joints.down_width[b], factors + line, lines + column)


def _parts(lines: int, width: int) -> Iterator[Piece]:
    """Yield the parts of a product with this number of lines."""
    for first in range(0, lines, MOST_ROWS):
        rows = min(MOST_ROWS, lines - first)
        for shift, quads in pieces_of(width // QUAD):
            yield 2 * rows - (2 - quads), first, shift


def _below(bodies: list[list[int]]) -> list[list[int]]:
    """Return the later joints that share a body with each joint, or become coupled with it by elimination."""
    of_body: dict[int, list[int]] = {}
    for k, places in enumerate(bodies):
        for body in places:
            of_body.setdefault(body, []).append(k)
    below: list[set[int]] = [set() for _ in bodies]
    for meeting in of_body.values():
        for first, k in enumerate(meeting):
            below[k] |= set(meeting[first + 1 :])
    return filled_below(below)
