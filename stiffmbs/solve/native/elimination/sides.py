"""Diagonal blocks of J M^-1 J^T and right-hand side by regular blocks of J (`stiffmbs.solve.linear.joint_sides`)."""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled, shifted
from stiffmbs.compile.machine.native.joint_rows import add_rows, take_rows

FULL, STRAIGHT = 12, 9
"""Numbers in a row of the lists."""


@compiled
def add_full_sides(r, b, values):
    """Add the blocks of J with three velocities in all rows of a joint to j, the blocks and x."""
    for k in range(b.n_full):
        p = shifted(b.full, FULL * k)
        size, source = p[0], shifted(p, 6)
        block, x, j = shifted(b.blocks, p[1]), shifted(b.x, p[3]), shifted(b.j, p[4])
        scale, a = shifted(b.scale, p[5]), shifted(r.a, p[5])
        if size == 5:
            add_rows(5, values, source, scale, j, x, a, block, p[2])
        elif size == 3:
            add_rows(3, values, source, scale, j, x, a, block, p[2])
        elif size == 6:
            add_rows(6, values, source, scale, j, x, a, block, p[2])
        elif size == 4:
            add_rows(4, values, source, scale, j, x, a, block, p[2])
        elif size == 2:
            add_rows(2, values, source, scale, j, x, a, block, p[2])
        else:
            add_rows(1, values, source, scale, j, x, a, block, p[2])


@compiled
def add_straight_sides(r, b, values):
    """Add the blocks of J with three velocities in one row each to j, the blocks and x."""
    for k in range(b.n_diagonals):
        p = shifted(b.straight, STRAIGHT * k)
        step, down = p[1], p[4]
        block, x, j = shifted(b.blocks, p[0]), shifted(b.x, p[2]), shifted(b.j, p[3])
        scale, a = shifted(b.scale, p[5]), shifted(r.a, p[5])
        j0, j1, j2 = values[p[6]] * scale[0], values[p[7]] * scale[1], values[p[8]] * scale[2]
        x0, x1, x2 = x[0] + j0 * a[0], x[1] + j1 * a[1], x[2] + j2 * a[2]
        s0, s1, s2 = block[0] + j0 * j0, block[step] + j1 * j1, block[2 * step] + j2 * j2
        j[0], j[down], j[2 * down] = j0, j1, j2
        x[0], x[1], x[2] = x0, x1, x2
        block[0], block[step], block[2 * step] = s0, s1, s2


@compiled
def take_side_reactions(r, b):
    """Compute a -= j^T x for both kinds of blocks."""
    for k in range(b.n_full):
        p = shifted(b.full, FULL * k)
        size = p[0]
        j, x, a = shifted(b.j, p[4]), shifted(b.x, p[3]), shifted(r.a, p[5])
        if size > 4:
            take_rows(5, j, x, a)
        else:
            take_rows(1, j, x, a)
    for k in range(b.n_diagonals):
        p = shifted(b.straight, STRAIGHT * k)
        down = p[4]
        j, x, a = shifted(b.j, p[3]), shifted(b.x, p[2]), shifted(r.a, p[5])
        a0, a1, a2 = a[0] - j[0] * x[0], a[1] - j[down] * x[1], a[2] - j[2 * down] * x[2]
        a[0], a[1], a[2] = a0, a1, a2
