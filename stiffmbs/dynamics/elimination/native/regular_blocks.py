"""Diagonal blocks of J M^-1 J^T, and right-hand side, by regular blocks of J.

These are the full and diagonal blocks of `stiffmbs.dynamics.elimination.joint_jacobian`.
"""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled, row_of, shifted
from stiffmbs.compile.machine.native.joint_rows import add_rows, take_rows
from stiffmbs.compile.machine.native.quads import by_case
from stiffmbs.dynamics.elimination.native.layouts import MOST_ROWS, DiagonalBlock, FullBlock

full_block = row_of(FullBlock)
diagonal_block = row_of(DiagonalBlock)
add_sized_rows = by_case(add_rows, {size: (size,) for size in range(MOST_ROWS, 0, -1)})


@compiled
def add_full_blocks(r, b, values):
    """Add the full blocks of J to j, to the diagonal blocks and to x."""
    for k in range(b.n_full):
        f = full_block(b.full, k)
        source = shifted(b.full_source, MOST_ROWS * k)
        block, x, j = shifted(b.blocks, f.block), shifted(b.x, f.x), shifted(b.j, f.j)
        scale, a = shifted(b.scale, f.velocity), shifted(r.a, f.velocity)
        add_sized_rows(f.size, values, source, scale, j, x, a, block, f.stride)


@compiled
def add_diagonal_blocks(r, b, values):
    """Add the diagonal blocks of J to j, to the diagonal blocks of the matrix and to x."""
    for k in range(b.n_diagonal):
        d = diagonal_block(b.diagonal, k)
        step, down = d.step, d.j_step
        block, x, j = shifted(b.blocks, d.block), shifted(b.x, d.x), shifted(b.j, d.j)
        scale, a = shifted(b.scale, d.velocity), shifted(r.a, d.velocity)
        j0, j1, j2 = values[d.source_0] * scale[0], values[d.source_1] * scale[1], values[d.source_2] * scale[2]
        x0, x1, x2 = x[0] + j0 * a[0], x[1] + j1 * a[1], x[2] + j2 * a[2]
        s0, s1, s2 = block[0] + j0 * j0, block[step] + j1 * j1, block[2 * step] + j2 * j2
        j[0], j[down], j[2 * down] = j0, j1, j2
        x[0], x[1], x[2] = x0, x1, x2
        block[0], block[step], block[2 * step] = s0, s1, s2


@compiled
def subtract_reactions(r, b):
    """Compute a -= j^T x for both kinds of blocks."""
    for k in range(b.n_full):
        f = full_block(b.full, k)
        j, x, a = shifted(b.j, f.j), shifted(b.x, f.x), shifted(r.a, f.velocity)
        if f.size > 4:
            take_rows(5, j, x, a)
        else:
            take_rows(1, j, x, a)
    for k in range(b.n_diagonal):
        d = diagonal_block(b.diagonal, k)
        down = d.j_step
        j, x, a = shifted(b.j, d.j), shifted(b.x, d.x), shifted(r.a, d.velocity)
        a0, a1, a2 = a[0] - j[0] * x[0], a[1] - j[down] * x[1], a[2] - j[2 * down] * x[2]
        a[0], a[1], a[2] = a0, a1, a2
