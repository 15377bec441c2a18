"""Evaluation of term sets, and assembly of residuals and matrices from their values."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, pi, sin

from .access import call_kernel, compiled, floats, ints, shifted, state_view
from .orientation import TURN_STRIDE, add_by_rotation, share_orientation
from .simd import item_of, nearest_whole, plus_product, product_of, quad_of, spread
from .tables import CALL

POSITION, MOTION, TANGENT, ACCELERATION, OUTPUT, SWITCH, EFFORT, EFFORT_TANGENT = range(8)
CALL_WIDTH = len(CALL)


@compiled
def evaluate(s, term_set, t):
    """Compute all terms of a set at the state in `s`; return a pointer to their values."""
    share_turns(s, ints(s.turned[term_set]), s.n_turned[term_set])
    return call_kernels(s, term_set, t)


@compiled
def share_one(s, at):
    """Compute the shared orientation values of the body whose first coordinate has index `at`."""
    if s.spatial:
        share_orientation(shifted(s.q, at + 3), shifted(s.turn, TURN_STRIDE * at))
    else:
        cosine, sine = cos(s.q[at + 2]), sin(s.q[at + 2])  # both before a store, so that the compiler merges the calls
        s.turn[at] = cosine
        s.turn[at + 1] = sine


@compiled
def share_turns(s, turned, count):
    """Compute the shared orientation values of some bodies, given by their first coordinates."""
    k = 0
    while k < count:
        if not s.spatial and k + 4 <= count and share_four(s.q, shifted(turned, k), s.turn):
            k += 4
        else:
            share_one(s, turned[k])
            k += 1


@compiled
def call_kernels(s, term_set, t):
    """Compute all terms of a set from current shared orientation values; return a pointer to their values."""
    s.evaluated[0] += 1
    calls = ints(s.calls[term_set])
    values = floats(s.values[term_set])
    for k in range(s.n_calls[term_set]):
        _call(s, shifted(calls, CALL_WIDTH * k), t, values)
    return values


@compiled
def _call(s, call, t, values):
    call_kernel(
        call[0], call[1], ints(call[2]), floats(call[3]), t, s.q, s.turn, s.u, s.a, s.lam, s.mu, ints(call[4]), values
    )


@compiled
def evaluate_some(s, term_set, t, wanted):
    """Compute the terms of the selected kernels of a set; return a pointer to all values."""
    share_turns(s, ints(s.turned[term_set]), s.n_turned[term_set])
    s.evaluated[0] += 1
    calls = ints(s.calls[term_set])
    values = floats(s.values[term_set])
    for k in range(s.n_calls[term_set]):
        if wanted[k]:
            _call(s, shifted(calls, CALL_WIDTH * k), t, values)
    return values


@compiled
def load(s, e, y, yp):
    """Copy q, u, mu and lam from a vector of unknowns, and accelerations from its derivative.

    Fixed coordinates keep their values. If the formulation integrates the multipliers, they are read from the
    derivative.
    """
    for k in range(e.n_moving_q):
        at = e.moving_q[k]
        s.q[at] = e.offset[at] + e.q_ratio[at] * y[e.q_from[k]]
    for k in range(e.n_moving_u):
        at = e.moving_u[k]
        s.u[at] = e.u_ratio[at] * y[e.u_from[k]]
        s.a[at] = e.u_ratio[at] * yp[e.u_from[k]]
    multipliers = yp if e.integrated else y
    if e.has_mu:
        for k in range(s.n_c):
            s.mu[k] = multipliers[e.at_mu[k]] if e.at_mu[k] >= 0 else 0.0
    if e.has_lam:
        for k in range(s.n_c):
            s.lam[k] = multipliers[e.at_lam[k]] if e.at_lam[k] >= 0 else 0.0


@compiled
def add_products(e, values, y, yp, r):
    """Compute r = sum of factor * value * operand; the operand is 1, an unknown, or an unknown's derivative."""
    for k in range(e.n):
        r[k] = 0.0
    for k in range(e.n_plain):
        r[e.r_row[k]] += e.r_factor[k] * values[e.r_source[k]]
    for k in range(e.n_plain, e.n_with_y):
        r[e.r_row[k]] += e.r_factor[k] * values[e.r_source[k]] * y[e.r_operand[k]]
    add_rate_terms(e, values, yp, r)


@compiled
def add_rate_terms(e, values, yp, r):
    """Add the terms M y' of the residual."""
    for k in range(e.n_with_y, e.n_with_yp):
        r[e.r_row[k]] += e.r_factor[k] * values[e.r_source[k]] * yp[e.r_operand[k]]


@compiled
def add_sizes(e, values, y, yp, size):
    """Sum the magnitudes of the terms of `add_products` in each row."""
    for k in range(e.n):
        size[k] = 0.0
    for k in range(e.n_plain):
        size[e.r_row[k]] += abs(e.r_factor[k] * values[e.r_source[k]])
    for k in range(e.n_plain, e.n_with_y):
        size[e.r_row[k]] += abs(e.r_factor[k] * values[e.r_source[k]] * y[e.r_operand[k]])
    for k in range(e.n_with_y, e.n_with_yp):
        size[e.r_row[k]] += abs(e.r_factor[k] * values[e.r_source[k]] * yp[e.r_operand[k]])


@compiled
def add_entries(e, values, cj, a):
    """Assemble the matrix: each value times (constant + cj * cj-part) is added to its slot."""
    for k in range(e.n_slots):
        a[k] = 0.0
    for k in range(e.n_constant):
        a[e.m_slot[k]] += values[e.m_source[k]] * e.m_constant[k]
    for k in range(e.n_constant, e.n_entries):
        a[e.m_slot[k]] += values[e.m_source[k]] * (e.m_constant[k] + e.m_cj[k] * cj)


@compiled
def add_condensed(s, e, values, h, a):
    """Add the condensed entries of the matrix: derivatives by q, times h Z."""
    for k in range(e.n_straight):
        a[e.straight_slot[k]] += h * e.straight_factor[k] * values[e.straight_source[k]]
    for k in range(4 * e.n_turns):
        e.turn_row[k] = 0.0
    for k in range(e.n_turned):
        e.turn_row[e.turned_place[k]] += e.turned_factor[k] * values[e.turned_source[k]]
    for k in range(e.n_turns):
        add_by_rotation(s, e.turn_body[k], h, shifted(e.turn_row, 4 * k), shifted(e.turn_slot, 3 * k), a)


def terms(t, term_set, state):
    """Compute all terms of a set at the state in the table."""
    evaluate(state_view(state), term_set, t)


FARTHEST = 1e5
"""Largest angle for which two parts of pi/2 suffice, rad."""
QUARTER = pi / 2
QUARTER_REST = cos(QUARTER)
"""Two parts of pi/2, rad: its rounded value, and the rest."""
PER_QUARTER = 1 / QUARTER


@dataclass(frozen=True)
class Polynomial:
    """Coefficients of a polynomial in the square of the angle."""

    c1: float
    c2: float
    c3: float
    c4: float
    c5: float
    c6: float


SINE = Polynomial(
    -1.66666666666666324348e-01, 8.33333333332248946124e-03, -1.98412698298579493134e-04,
    2.75573137070700676789e-06, -2.50507602534068634195e-08, 1.58969099521155010221e-10,
)  # fmt: skip
COSINE = Polynomial(
    4.16666666666666019037e-02, -1.38888888888741095749e-03, 2.48015872894767294178e-05,
    -2.75573143513906633035e-07, 2.08757232129817482790e-09, -1.13596475577881948265e-11,
)  # fmt: skip


@compiled
def _values(p, z):
    """Evaluate a polynomial at four squares."""
    s = plus_product(spread(p.c4), z, plus_product(spread(p.c5), z, spread(p.c6)))
    return plus_product(spread(p.c1), z, plus_product(spread(p.c2), z, plus_product(spread(p.c3), z, s)))


@compiled
def share_four(q, turned, turn):
    """Store cosines and sines of four bodies, given by first coordinates; return False for large angles."""
    i, j, k, m = turned[0], turned[1], turned[2], turned[3]
    a, b, c, d = q[i + 2], q[j + 2], q[k + 2], q[m + 2]
    if not (max(abs(a), abs(b)) <= FARTHEST and max(abs(c), abs(d)) <= FARTHEST):
        return False
    x, one, minus = quad_of(a, b, c, d), spread(1.0), spread(-1.0)
    quarters = nearest_whole(product_of(x, spread(PER_QUARTER)))
    back = product_of(quarters, minus)
    near = plus_product(x, back, spread(QUARTER))
    y = plus_product(near, back, spread(QUARTER_REST))
    rest = plus_product(plus_product(near, y, minus), back, spread(QUARTER_REST))
    z = product_of(y, y)

    sine = plus_product(y, plus_product(rest, product_of(z, y), _values(SINE, z)), one)
    most = plus_product(one, z, spread(-0.5))
    lost = plus_product(plus_product(one, most, minus), z, spread(-0.5))
    lost = plus_product(plus_product(lost, product_of(z, z), _values(COSINE, z)), product_of(y, rest), minus)
    cosine = plus_product(most, lost, one)

    half = nearest_whole(plus_product(spread(-0.25), quarters, spread(0.5)))
    quarter = nearest_whole(plus_product(spread(-0.25), half, spread(0.5)))
    odd, turned_over = plus_product(quarters, half, spread(-2.0)), plus_product(half, quarter, spread(-2.0))
    even, sign = plus_product(one, odd, minus), plus_product(one, turned_over, spread(-2.0))
    sines = product_of(sign, plus_product(product_of(even, sine), odd, cosine))
    cosines = product_of(sign, plus_product(product_of(even, cosine), product_of(odd, minus), sine))
    turn[i], turn[i + 1] = item_of(cosines, 0), item_of(sines, 0)
    turn[j], turn[j + 1] = item_of(cosines, 1), item_of(sines, 1)
    turn[k], turn[k + 1] = item_of(cosines, 2), item_of(sines, 2)
    turn[m], turn[m + 1] = item_of(cosines, 3), item_of(sines, 3)
    return True
