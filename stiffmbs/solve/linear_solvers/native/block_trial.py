"""Validation of the factors of a block LU by the residual of a trial solution.

References
----------
Oettli and Prager, Compatibility of approximate solution of linear equations, Numer. Math. 6 (1964) 405-409: residual.
"""

from stiffmbs.compile.machine.native.access import compiled, factors_view, floats, shifted
from stiffmbs.compile.machine.native.simd import (
    plus_product,
    product_of,
    quad,
    quad_of,
    set_quad,
    spread,
    sum_of,
    times_i,
)
from stiffmbs.solve.linear_solvers.native.layouts import COORDINATE, MULTIPLIER
from stiffmbs.solve.linear_solvers.native.node_factors import add_columns, pair, single
from stiffmbs.solve.linear_solvers.native.parameters import PIVOTS


@compiled
def _near_tried(s):
    """Return True if no pivot has changed much since the last trial."""
    if s.serves == 0:
        return False
    s.serves -= 1
    far = 0
    for k in range(s.n):
        ratio = abs(s.pivot[k] * s.tried[k])  # sign ignored: equally large rows may be exchanged
        far += 0 if 1.0 / PIVOTS.changed < ratio < PIVOTS.changed else 1
    return far == 0


@compiled
def _sized(s, f):
    """Scale the trial solution: coordinates of 1, velocities of the rate, multipliers of comparable effect."""
    # Errors of a factor show only in a solution of realistic proportions.  Those of a Newton correction are: velocities
    # cj times coordinates, cj being the factor of dF/dy', which is on the diagonal of the coordinates' equations; and
    # multipliers whose largest term in an equation equals the other terms of this equation.
    rate = 0.0 if s.n_diagonal > 0 else 1.0
    for k in range(s.n_diagonal):
        rate = max(rate, abs(f.a[s.diagonal[k]]))
    for i in range(f.n):
        s.terms[i] = 0.0
    for j in range(f.n):
        s.trial[j] = s.state[j] * (1.0 if s.kind[j] == COORDINATE else rate)
        if s.kind[j] != MULTIPLIER:
            for p in range(f.a_start[j], f.a_start[j + 1]):
                s.terms[f.a_row[p]] += abs(f.a[p] * s.trial[j])
    for j in range(f.n):
        if s.kind[j] == MULTIPLIER:
            part = 0.0
            for p in range(f.a_start[j], f.a_start[j + 1]):
                if s.kind[f.a_row[p]] != MULTIPLIER:
                    part = max(part, abs(f.a[p]) / s.terms[f.a_row[p]])
            s.trial[j] = s.state[j] / part if 0.0 < part < float("inf") else s.state[j]


@compiled
def _multiply(s, f, by):
    """Compute A times a vector in `product`, and the sums of the magnitudes of each row's terms in `terms`."""
    for i in range(f.n):
        s.product[i] = 0.0
        s.terms[i] = 0.0
    for j in range(f.n):
        for p in range(f.a_start[j], f.a_start[j + 1]):
            part = f.a[p] * by[j]
            s.product[f.a_row[p]] += part
            s.terms[f.a_row[p]] += abs(part)


@compiled
def trusted(s, f):
    """Return True if the factors leave a small residual; validated by a trial if pivots have changed."""
    if _near_tried(s):
        return True
    # b = A x for a known x is solved.  A residual is allowed in each row in proportion to sum_j |a_ij x_j|: then the
    # solution is that of a matrix whose entries differ relatively by as much (Oettli and Prager).
    _sized(s, f)
    _multiply(s, f, s.trial)
    for i in range(f.n):
        s.allowed[i] = PIVOTS.largest_residual * s.terms[i]
    left = _left_after_solution(s, f)
    s.refined = 1 if 1.0 < left <= PIVOTS.refinable / PIVOTS.largest_residual else 0
    if s.refined:
        left = _left_after_solution(s, f)
    for k in range(f.n):
        s.tried[k] = 1.0 / s.pivot[k]
    s.serves = PIVOTS.most_between_trials if left <= 1.0 else 0
    return left <= 1.0


@compiled
def _left_after_solution(s, f):
    """Subtract the solution for `product` from the trial; return the largest residual relative to the allowed one."""
    # The residual is A times the error of the solution: b - A x would lose its digits by cancellation.  A second call
    # solves for the residual that the first has left, which is a step of iterative refinement.
    solved(s, s.product)
    for j in range(f.n):
        s.trial[j] -= s.x[s.place[j]]
    _multiply(s, f, s.trial)
    largest = 0.0
    for i in range(f.n):
        left = 0.0 if s.product[i] == 0.0 else abs(s.product[i]) / s.allowed[i]
        if not left <= largest:
            largest = left if left < float("inf") else float("inf")  # also for NaN
    return largest


@compiled
def refine(s, x, b):
    """Refine a solution once by its residual."""
    _multiply(s, factors_view(s.factors), x)
    for i in range(s.n):
        s.product[i] = b[i] - s.product[i]
    solved(s, s.product)
    for j in range(s.n):
        x[j] += s.x[s.place[j]]


@compiled
def panel(s, at):
    """Return the panels from a position on."""
    return shifted(floats(s.panels), at)


@compiled
def _forward(s, k, parts):
    """Multiply supernode k of x by L^-1 P, and update later supernodes."""
    size, stride = s.size[k], s.down_width[k]
    down = panel(s, s.start[2 * k])
    lower = panel(s, s.start[2 * k + 1] + size * s.right_width[k])
    own = shifted(s.x, s.node_start[k])
    width = s.node_start[k + 1] - s.node_start[k]
    for at in range(0, width, 4):  # with the sign of -L^-1 P x until the end: products can only be added
        set_quad(s.scratch, at, product_of(spread(-1.0), quad(own, at)))
        set_quad(own, at, spread(0.0))
    for at in range(0, width, 4):
        add_columns(parts, shifted(own, at), s.scratch, shifted(lower, at), width, size)
    first = s.down_at[k]
    for place in range(first, s.down_at[k + 1]):
        at = width + 4 * (place - first)
        add_columns(parts, shifted(s.x, s.down_x[place]), own, shifted(down, at), stride, size)
    for at in range(0, width, 4):
        set_quad(own, at, product_of(spread(-1.0), quad(own, at)))


@compiled
def _backward(s, k, parts):
    """Update supernode k of x by later supernodes, and multiply it by U^-1."""
    size, stride, width = s.size[k], s.down_width[k], s.right_width[k]
    down, right = panel(s, s.start[2 * k]), panel(s, s.start[2 * k + 1])
    own = shifted(s.x, s.node_start[k])
    turned, known = shifted(s.scratch, width), shifted(s.scratch, parts() * width)
    # The later unknowns are gathered once: each line of the panel, which holds -U, is then one contiguous dot product.
    # Those of a complex line with (re, -im) and with (im, re) are the parts of its product with x.
    first = s.right_at[k]
    for place in range(first, s.right_at[k + 1]):
        at = 4 * (place - first)
        gathered = quad(s.x, s.right_x[place])
        if parts() == 2:
            gathered = product_of(gathered, quad_of(1.0, -1.0, 1.0, -1.0))
            set_quad(turned, at, times_i(gathered))
        set_quad(s.scratch, at, gathered)
    for i in range(size):
        total, other = spread(0.0), spread(0.0)
        if parts() == 1:
            for at in range(0, width, 4):
                total = plus_product(total, quad(right, i * width + at), quad(s.scratch, at))
        else:
            for at in range(0, width, 4):
                line = quad(right, i * width + at)
                total = plus_product(total, line, quad(s.scratch, at))
                other = plus_product(other, line, quad(turned, at))
            known[2 * i + 1] = own[2 * i + 1] + sum_of(other)
        known[parts() * i] = own[parts() * i] + sum_of(total)
    for at in range(0, s.node_start[k + 1] - s.node_start[k], 4):  # U^-1 is triangular: columns before j are zero
        set_quad(own, at, spread(0.0))
        j = at // parts()
        add_columns(parts, shifted(own, at), shifted(known, at), shifted(down, j * stride + at), stride, size - j)


@compiled
def _substituted(s, parts):
    """Solve with the factors for the vector x."""
    for k in range(s.n_nodes):
        _forward(s, k, parts)
    for k in range(s.n_nodes - 1, -1, -1):
        _backward(s, k, parts)


@compiled
def solved(s, of):
    """Compute x = A^-1 b by the factors, at the positions of the supernodes."""
    for p in range(s.node_start[s.n_nodes]):
        s.x[p] = 0.0
    for j in range(s.n):
        s.x[s.place[j]] = of[j]
    if s.parts == 1:
        _substituted(s, single)
    else:
        _substituted(s, pair)
