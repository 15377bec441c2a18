"""Solution by the factors of a block LU with pivots within supernodes: products of blocks and vectors."""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled, floats, shifted
from stiffmbs.compile.machine.native.quads import add_products, plus_product, quad, set_quad, spread, sum_of


@compiled
def panel(s, at):
    """Return the panels from a position on."""
    return shifted(floats(s.panels), at)


@compiled
def _forward(s, k):
    """Multiply supernode k of x by L^-1 P, and update later supernodes."""
    size, stride = s.size[k], s.down_width[k]
    down = panel(s, s.start[2 * k])
    lower = panel(s, s.start[2 * k + 1] + size * s.right_width[k])
    own = shifted(s.x, s.node_start[k])
    width = s.node_start[k + 1] - s.node_start[k]
    for j in range(size):
        s.scratch[j] = -own[j]
    for at in range(0, width, 4):
        set_quad(own, at, spread(0.0))
        add_products(1, 1, shifted(own, at), 0, s.scratch, 1, shifted(lower, at), width, size)
    first = s.down_at[k]
    for place in range(first, s.down_at[k + 1]):
        at = width + 4 * (place - first)
        add_products(1, 1, shifted(s.x, s.down_x[place]), 0, own, 1, shifted(down, at), stride, size)
    for j in range(size):
        own[j] = -own[j]


@compiled
def _backward(s, k):
    """Update supernode k of x by later supernodes, and multiply it by U^-1."""
    size, stride, width = s.size[k], s.down_width[k], s.right_width[k]
    down, right = panel(s, s.start[2 * k]), panel(s, s.start[2 * k + 1])
    own = shifted(s.x, s.node_start[k])
    first = s.right_at[k]
    for place in range(first, s.right_at[k + 1]):
        set_quad(s.scratch, 4 * (place - first), quad(s.x, s.right_x[place]))
    for i in range(size):
        total = spread(0.0)
        for at in range(0, width, 4):
            total = plus_product(total, quad(right, i * width + at), quad(s.scratch, at))
        s.scratch[width + i] = own[i] + sum_of(total)
    known = shifted(s.scratch, width)
    for at in range(0, s.node_start[k + 1] - s.node_start[k], 4):
        set_quad(own, at, spread(0.0))
        add_products(
            1, 1, shifted(own, at), 0, shifted(known, at), 1, shifted(down, at * stride + at), stride, size - at
        )


@compiled
def solved(s, of):
    """Compute x = A^-1 b by the factors, at the positions of the supernodes."""
    for p in range(s.node_start[s.n_nodes]):
        s.x[p] = 0.0
    for j in range(s.n):
        s.x[s.place[j]] = of[j]
    for k in range(s.n_nodes):
        _forward(s, k)
    for k in range(s.n_nodes - 1, -1, -1):
        _backward(s, k)
