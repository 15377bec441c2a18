"""Factors of one supernode of a block LU (`stiffmbs.solve.linear_solvers.native.block_lu`), with pivots from its own rows.

Its block is replaced by U^-1, its rows right of it are multiplied by L^-1 P, and later rows by U^-1.  Complex numbers are
pairs of real and imaginary part, at 2 r and 2 r + 1 of a line; a panel has a line for each number of the supernode.  Stiff bushings
make blocks ill-conditioned.  Products with triangular inverses then still leave residuals near rounding, unlike
products with the inverse of the whole block.

References
----------
Du Croz and Higham, Stability of methods for matrix inversion, IMA J. Numer. Anal. 12 (1992) 1-19.
"""

from stiffmbs.compile.machine.native.access import compiled, shifted
from stiffmbs.compile.machine.native.simd import (
    add_pair_products,
    add_products,
    by_case,
    plus_product,
    product_of,
    quad,
    set_quad,
    spread,
    times_i,
)
from stiffmbs.sparse.block_updates import ROWS


@compiled
def single():
    """Return the number of parts of a real number."""
    return 1


@compiled
def pair():
    """Return the number of parts of a complex number."""
    return 2


@compiled
def magnitude(line, k, parts):
    """Return the magnitude of number k of a line; `parts`, here and below, is `single` or `pair`."""
    found = abs(line[parts() * k])
    if parts() == 2:  # |re| + |im| chooses a pivot as well as the modulus (cabs1 of LINPACK)
        found += abs(line[parts() * k + 1])
    return found


@compiled
def _exchange(line, a, b, parts):
    for part in range(parts()):
        kept = line[parts() * a + part]
        line[parts() * a + part] = line[parts() * b + part]
        line[parts() * b + part] = kept


@compiled
def _pivoted(s, d, stride, t, width, size, k, parts):
    """Exchange rows so that the largest of the numbers of column k from the k-th on is its pivot; return the column."""
    line = shifted(d, k * stride)
    largest = k
    for r in range(k + 1, size):
        if magnitude(line, r, parts) > magnitude(line, largest, parts):
            largest = r
    if largest != k:  # lines are columns: an exchange of rows is one within each line
        for i in range(size):
            _exchange(shifted(d, i * stride), k, largest, parts)
        for i in range(k):
            _exchange(shifted(t, s.order[i] * width), k, largest, parts)
        kept = s.order[k]
        s.order[k] = s.order[largest]
        s.order[largest] = kept
    return line


@compiled
def _reciprocal(line, k, parts, part):
    """Return the real (0) or imaginary part (1) of one over number k of a line."""
    if parts() == 1:
        return 1.0 / line[k]
    squared = line[2 * k] * line[2 * k] + line[2 * k + 1] * line[2 * k + 1]
    return line[2 * k] / squared if part == 0 else -line[2 * k + 1] / squared


@compiled
def _divided(s, line, k, own, stride, parts):
    """Divide a line by its number k, from the quad after `own` on; `scratch` has all quotients, those of `own` too."""
    first, real = quad(line, own), spread(_reciprocal(line, k, parts, 0))
    if parts() == 1:
        for at in range(own, stride, 4):
            part = product_of(quad(line, at), real)
            set_quad(s.scratch, at, part)
            set_quad(line, at, part)
    else:
        imaginary = spread(_reciprocal(line, k, parts, 1))
        for at in range(own, stride, 4):
            part = quad(line, at)
            part = plus_product(product_of(part, real), times_i(part), imaginary)
            set_quad(s.scratch, at, part)
            set_quad(line, at, part)
    set_quad(line, own, first)


@compiled
def _reduced(s, line, k, first, width, parts):
    """Subtract number k of a line times a pivot's multipliers."""
    real = spread(-line[parts() * k])
    if parts() == 1:
        for at in range(first, width, 4):
            set_quad(line, at, plus_product(quad(line, at), real, quad(s.scratch, at)))
    else:  # (a + ib) z = a z + b (iz): two real factors, of the pairs and of the pairs turned by i
        imaginary = spread(-line[2 * k + 1])
        for at in range(first, width, 4):
            by = quad(s.scratch, at)
            set_quad(line, at, plus_product(plus_product(quad(line, at), real, by), imaginary, times_i(by)))


@compiled
def triangular(s, d, stride, t, width, size, first, parts):
    """Factor a supernode's columns as L U with row pivoting; `t` becomes L^-1 P, later rows are multiplied by U^-1."""
    # A line holds a column, from the diagonal block down.  Step k divides column k by its pivot and subtracts multiples
    # of it from the later columns, and from the columns of the unit matrix, which become L^-1 P.  The multipliers are
    # kept in `scratch` from quad `own` on; `above` clears those of the rows up to the pivot's within this quad.
    for k in range(size):
        s.order[k] = k
    for k in range(size):
        line = _pivoted(s, d, stride, t, width, size, k, parts)
        pivot, at = magnitude(line, k, parts), parts() * (first + k)
        s.pivot[at], s.pivot[at + parts() - 1] = pivot, pivot  # trials compare one pivot for each real unknown
        within = parts() * k % 4
        own = parts() * k - within
        _divided(s, line, k, own, stride, parts)
        set_quad(s.scratch, own, product_of(quad(s.scratch, own), quad(s.above, 4 * (within + parts() - 1))))
        for i in range(k + 1, size):
            _reduced(s, shifted(d, i * stride), k, own, stride, parts)
        for i in range(k):
            _reduced(s, shifted(t, s.order[i] * width), k, own, width, parts)
        into = shifted(t, s.order[k] * width)  # not changed by earlier steps: its only entry is in the pivot's row
        for at in range(0, own, 4):
            set_quad(into, at, spread(0.0))
        set_quad(into, own, plus_product(quad(s.unit, 4 * within), spread(-1.0), quad(s.scratch, own)))
        for at in range(own + 4, width, 4):
            set_quad(into, at, product_of(spread(-1.0), quad(s.scratch, at)))


@compiled
def add_columns(parts, into, a, b, stride, depth):
    """Add the sum of a[k] b[k] over k to a quad, of columns of factors with a stride."""
    if parts() == 1:
        add_products(1, 1, into, 0, a, 1, b, stride, depth)
    else:
        add_pair_products(1, 1, into, 0, a, 2, b, stride, depth)


@compiled
def inverted(s, d, stride, width, size, parts):
    """Replace U, above the diagonal of a supernode's columns, by its inverse."""
    # Column j of X = U^-1 from the columns before it: x_j = -X u_j / u_jj above the diagonal, 1 / u_jj on it.
    for j in range(size):
        line = shifted(d, j * stride)
        real, imaginary = _reciprocal(line, j, parts, 0), _reciprocal(line, j, parts, 1) if parts() == 2 else 0.0
        for i in range(j):
            if parts() == 1:
                s.scratch[i] = -real * line[i]
            else:
                s.scratch[2 * i] = imaginary * line[2 * i + 1] - real * line[2 * i]
                s.scratch[2 * i + 1] = -imaginary * line[2 * i] - real * line[2 * i + 1]
        for at in range(0, width, 4):
            set_quad(line, at, spread(0.0))
        for at in range(0, parts() * j, 4):  # the quads with a row before j
            add_columns(parts, shifted(line, at), s.scratch, shifted(d, at), stride, j)
        line[parts() * j] = real
        if parts() == 2:
            line[2 * j + 1] = imaginary


add_two_quads = by_case(add_products, {rows: (rows, 2) for rows in ROWS})
add_one_quad = by_case(add_products, {rows: (rows, 1) for rows in ROWS})
add_two_quads_of_pairs = by_case(add_pair_products, {rows: (rows, 2) for rows in ROWS})
add_one_quad_of_pairs = by_case(add_pair_products, {rows: (rows, 1) for rows in ROWS})
"""Products for one to four rows of two quads, and of one, of real and of complex numbers."""


@compiled
def rows_at_once(left):
    """Return the number of rows of the next product, as `stiffmbs.sparse.block_updates.split`."""
    return 3 if left == 5 or left == 6 or left == 9 else min(left, 4)


@compiled
def multiplied(s, d, stride, u, width, size, parts):
    """Multiply a supernode's rows right of its diagonal block by L^-1 P, `d`, and by -1."""
    # In strips of two quads of columns, which are copied with the opposite sign: the product replaces its own factor.
    for column in range(0, width, 8):
        two = column + 4 < width
        for i in range(size):
            for at in range(0, 8 if two else 4, 4):
                place = i * width + column + at
                set_quad(s.scratch, 8 * i + at, product_of(spread(-1.0), quad(u, place)))
                set_quad(u, place, spread(0.0))
        line = 0
        while line < size:
            rows = rows_at_once(size - line)
            into, of = shifted(u, line * width + column), shifted(d, parts() * line)
            if parts() == 2:
                if two:
                    add_two_quads_of_pairs(rows, into, width, of, stride, s.scratch, 8, size)
                else:
                    add_one_quad_of_pairs(rows, into, width, of, stride, s.scratch, 8, size)
            elif two:
                add_two_quads(rows, into, width, of, stride, s.scratch, 8, size)
            else:
                add_one_quad(rows, into, width, of, stride, s.scratch, 8, size)
            line += rows
