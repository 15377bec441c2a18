"""Factors of one supernode of a complex block LU, as `stiffmbs.solve.linear_solvers.native.node_factors`, and its solutions.

Numbers are pairs of real and imaginary part, at 2 r and 2 r + 1 of a line. A panel has a line for each of the numbers of
the supernode.
"""

from stiffmbs.compile.machine.native.access import compiled, shifted
from stiffmbs.compile.machine.native.quads import (
    add_pair_products,
    plus_product,
    product_of,
    quad,
    quad_of,
    set_quad,
    spread,
    sum_of,
    times_i,
)
from stiffmbs.solve.linear_solvers.native.node_factors import in_natural_order, magnitude, pivoted


@compiled
def _reduced(s, line, k, first, width):
    """Subtract the k-th number of a line times a pivot's multipliers."""
    # (a + ib) z = a z + b (iz): two real factors, of the pairs and of the pairs turned by i.
    real = spread(-line[2 * k])
    imaginary = spread(-line[2 * k + 1])
    for at in range(first, width, 4):
        by = quad(s.scratch, at)
        set_quad(line, at, plus_product(plus_product(quad(line, at), real, by), imaginary, times_i(by)))


@compiled
def triangular_of_pairs(s, d, stride, t, width, size, first):
    """Factor a supernode's columns as L U with row pivoting; `t` becomes L^-1 P, later rows are multiplied by U^-1."""
    in_natural_order(s, size)
    for k in range(size):
        line = pivoted(s, d, stride, t, width, size, k, 2)
        pivot = magnitude(line, k, 2)  # twice, as trials compare one pivot for each real unknown
        s.pivot[2 * (first + k)] = pivot
        s.pivot[2 * (first + k) + 1] = pivot
        squared = line[2 * k] * line[2 * k] + line[2 * k + 1] * line[2 * k + 1]
        real = spread(line[2 * k] / squared)
        imaginary = spread(-line[2 * k + 1] / squared)
        within = 2 * (k % 2)
        own = 2 * k - within
        for at in range(own, stride, 4):
            part = quad(line, at)
            part = plus_product(product_of(part, real), times_i(part), imaginary)
            if at == own:
                set_quad(s.scratch, own, product_of(part, quad(s.above, 4 * (within + 1))))
            else:
                set_quad(s.scratch, at, part)
                set_quad(line, at, part)
        for i in range(k + 1, size):
            _reduced(s, shifted(d, i * stride), k, own, stride)
        for i in range(k):
            _reduced(s, shifted(t, s.order[i] * width), k, own, width)
        into = shifted(t, s.order[k] * width)
        for at in range(0, own, 4):
            set_quad(into, at, spread(0.0))
        set_quad(into, own, plus_product(quad(s.unit, 4 * within), spread(-1.0), quad(s.scratch, own)))
        for at in range(own + 4, width, 4):
            set_quad(into, at, product_of(spread(-1.0), quad(s.scratch, at)))


@compiled
def inverted_of_pairs(s, d, stride, width, size):
    """Replace U, above the diagonal of a supernode's columns, by its inverse."""
    for j in range(size):
        line = shifted(d, j * stride)
        squared = line[2 * j] * line[2 * j] + line[2 * j + 1] * line[2 * j + 1]
        real = line[2 * j] / squared
        imaginary = -line[2 * j + 1] / squared
        for i in range(j):
            s.scratch[2 * i] = imaginary * line[2 * i + 1] - real * line[2 * i]
            s.scratch[2 * i + 1] = -imaginary * line[2 * i] - real * line[2 * i + 1]
        for at in range(0, width, 4):
            set_quad(line, at, spread(0.0))
        for at in range(0, 2 * j, 4):
            add_pair_products(1, 1, shifted(line, at), 0, s.scratch, 2, shifted(d, at), stride, j)
        line[2 * j] = real
        line[2 * j + 1] = imaginary


@compiled
def forward_pairs(s, k, down, right):
    """Multiply supernode k of x by L^-1 P, and update later supernodes."""
    size, stride = s.size[k], s.down_width[k]
    lower = shifted(right, size * s.right_width[k])
    own = shifted(s.x, s.node_start[k])
    width = s.node_start[k + 1] - s.node_start[k]
    for at in range(0, width, 4):
        set_quad(s.scratch, at, product_of(spread(-1.0), quad(own, at)))
        set_quad(own, at, spread(0.0))
    for at in range(0, width, 4):
        add_pair_products(1, 1, shifted(own, at), 0, s.scratch, 2, shifted(lower, at), width, size)
    first = s.down_at[k]
    for place in range(first, s.down_at[k + 1]):
        at = width + 4 * (place - first)
        add_pair_products(1, 1, shifted(s.x, s.down_x[place]), 0, own, 2, shifted(down, at), stride, size)
    for at in range(0, width, 4):
        set_quad(own, at, product_of(spread(-1.0), quad(own, at)))


@compiled
def backward_pairs(s, k, down, right):
    """Update supernode k of x by later supernodes, and multiply it by U^-1."""
    size, stride, width = s.size[k], s.down_width[k], s.right_width[k]
    own = shifted(s.x, s.node_start[k])
    turned = shifted(s.scratch, width)
    known = shifted(s.scratch, 2 * width)
    first = s.right_at[k]
    for place in range(first, s.right_at[k + 1]):
        at = 4 * (place - first)
        # Real dot products of a line with (re, -im) and with (im, re) are the parts of its complex product with x.
        conjugate = product_of(quad(s.x, s.right_x[place]), quad_of(1.0, -1.0, 1.0, -1.0))
        set_quad(s.scratch, at, conjugate)
        set_quad(turned, at, times_i(conjugate))
    for i in range(size):
        real = spread(0.0)
        imaginary = spread(0.0)
        for at in range(0, width, 4):
            line = quad(right, i * width + at)
            real = plus_product(real, line, quad(s.scratch, at))
            imaginary = plus_product(imaginary, line, quad(turned, at))
        known[2 * i] = own[2 * i] + sum_of(real)
        known[2 * i + 1] = own[2 * i + 1] + sum_of(imaginary)
    for at in range(0, s.node_start[k + 1] - s.node_start[k], 4):
        set_quad(own, at, spread(0.0))
        j = at // 2
        add_pair_products(
            1, 1, shifted(own, at), 0, shifted(known, at), 2, shifted(down, j * stride + at), stride, size - j
        )
