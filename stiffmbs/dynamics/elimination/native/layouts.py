"""Memory layouts of matrix and factors of an elimination.

Letters of these tables in native functions: docs/project/notation.md.
"""

from __future__ import annotations

from typing import Final, NamedTuple

from stiffmbs.compile.machine.layout import FLOATS, INDICES, INT, INTS, Layout

PIN_ELIMINATION = Layout({
    "n": INT, "n_adjacent": INT, "pin": INDICES, "inverse": FLOATS, "w": FLOATS, "product": INDICES, "mass": FLOATS,
    "start": INDICES, "later": INDICES, "update": INDICES,
    "block": FLOATS, "diagonal": FLOATS, "adjacent": FLOATS, "scaled": FLOATS, "x": FLOATS,
})  # fmt: skip
"""Matrix and factors of planar revolute joints in the order of elimination (`stiffmbs.dynamics.elimination.eliminated`).  The
rows of `pin` are `Pin`, `inverse` holds the inverse masses of both bodies.  Off-diagonal blocks are
stored joint by joint from `start` on, each with its `later` joint.  Rows of `product` (`PinProduct`) list the blocks of J M^-1
that form them, `mass` the masses between these; `update` lists the block that two blocks of a joint update."""


class Pin(NamedTuple):
    """Planar revolute joint.

    - `x_i`, `y_i`, `x_j`, `y_j`: starts of two entries of J for both equations of body i and of body j.
    - `gamma_x`, `gamma_y`: sources of gamma.
    - `velocity_i`, `velocity_j`: first velocities of the bodies.
    - `row`: first equation.
    """

    x_i: int
    y_i: int
    x_j: int
    y_j: int
    gamma_x: int
    gamma_y: int
    velocity_i: int
    velocity_j: int
    row: int


class PinProduct(NamedTuple):
    """Starts of two blocks of J M^-1."""

    first: int
    second: int


BLOCK_ELIMINATION = Layout({
    "n_gamma": INT, "gamma_source": INDICES, "gamma_place": INDICES,
    "n_first": INT, "n_j": INT, "j_source": INDICES, "j_at": INDICES, "j_scale": FLOATS, "j": FLOATS, "scale": FLOATS,
    "n_full": INT, "full": INDICES, "full_source": INDICES, "n_diagonal": INT, "diagonal": INDICES,
    "n_copied": INT, "copied": INDICES, "n_single": INT, "single": INDICES,
    "n_products": INT, "product": INDICES, "n_single_products": INT, "single_product": INDICES,
    "n_joints": INT, "joint": INDICES, "n_panels": INT, "blocks": FLOATS, "update": INDICES, "right": INDICES,
    "place": INTS, "n_pivots": INT, "pivot": FLOATS, "pivot_scale": FLOATS, "n_x": INT, "x": FLOATS, "y": FLOATS,
})  # fmt: skip
"""Matrix and factors by dense blocks, for groups of three velocities (`stiffmbs.dynamics.elimination.joint_blocks`).

J by blocks of a joint and a body, column by column; `j_scale` and `scale` are the inverse roots of the masses.  Its
entries come from full and diagonal blocks (`FullBlock`, `DiagonalBlock`); all others are copied one by one: the first
`n_first` are set, later ones are added.  The right-hand side of copied blocks and entries follows from `CopiedBlock` and
`SingleEntry`, the matrix from `BlockProduct` and `EntryProduct`.

`blocks` holds the panel of each joint (`JointPanel`), then its right blocks divided by the pivots.  `right` holds the
positions in x of the columns right of each joint, four at a time.  `place` is the position of each equation in x;
`pivot_scale` is that of `ELIMINATED`."""

MOST_ROWS: Final = 6
"""Rows of a full block, and lines of a product of two quads, that fit into registers."""


class FullBlock(NamedTuple):
    """Block of J with three velocities in all rows of a joint; `full_source` holds the start of each row's entries.

    - `size`: number of rows.
    - `block`, `stride`: joint's diagonal block.
    - `x`: joint's position in x.
    - `j`: block of J.
    - `velocity`: first velocity.
    """

    size: int
    block: int
    stride: int
    x: int
    j: int
    velocity: int


class DiagonalBlock(NamedTuple):
    """Block of J with three velocities in one row each, one after the other.

    - `block`, `step`: first entry in the joint's diagonal block, and distance to the next.
    - `x`: position of the first row in x.
    - `j`, `j_step`: first entry in the block of J, and distance to the next.
    - `velocity`: first velocity.
    - `source_0`, `source_1`, `source_2`: entries among the values.
    """

    block: int
    step: int
    x: int
    j: int
    j_step: int
    velocity: int
    source_0: int
    source_1: int
    source_2: int


class CopiedBlock(NamedTuple):
    """Block of J for three velocities that is copied entry by entry.

    `x`: joint's position in x. `j`, `width`: block of J, and length of its columns. `velocity`: first velocity.
    """

    x: int
    j: int
    velocity: int
    width: int


class SingleEntry(NamedTuple):
    """Entry of J, one of at most three in a block: position in x, entry, velocity."""

    x: int
    j: int
    velocity: int


class BlockProduct(NamedTuple):
    """Part of the product of two blocks of J over three velocities.

    `shape`: as in `stiffmbs.dynamics.elimination.native.by_blocks`. `target`, `stride`: part of the matrix. `first`,
    `first_stride`, `second`, `second_stride`: both factors.
    """

    shape: int
    target: int
    stride: int
    first: int
    first_stride: int
    second: int
    second_stride: int


class EntryProduct(NamedTuple):
    """Product of two entries of J: entry of the matrix, both factors."""

    target: int
    first: int
    second: int


class JointPanel(NamedTuple):
    """Panel of a joint in the matrix: its diagonal block, then the blocks right of it.

    - `size`, `width`: number of equations, and the same rounded up to whole SIMD vectors, at which the right blocks
      start.
    - `start`, `stride`: panel among the blocks.
    - `scaled`, `scaled_width`: right blocks divided by the pivots: start, and length of a row.
    - `x`: position in x.
    - `pivot`: first pivot.
    - `updates_end`, `right_end`: ends of the joint's rows in `update` and in `right`.
    """

    size: int
    width: int
    start: int
    stride: int
    scaled: int
    scaled_width: int
    x: int
    pivot: int
    updates_end: int
    right_end: int


class PanelUpdate(NamedTuple):
    """Update of a part of a later panel by an eliminated joint.

    `shape`: as in `stiffmbs.dynamics.elimination.native.by_blocks`. `target`, `stride`: part of the panel. `factors`,
    `rows`: right blocks of the joint, divided by the pivots and not.
    """

    shape: int
    target: int
    stride: int
    factors: int
    rows: int
