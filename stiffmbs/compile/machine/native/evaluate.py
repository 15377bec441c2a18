"""Evaluation of term sets, and assembly of residuals and matrices from their values."""

from __future__ import annotations

from math import cos, sin

from .access import call_kernel, compiled, floats, ints, shifted, state_view
from .orientation import TURN_STRIDE, share_orientation
from .sine_cosine import share_four
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


def terms(t, term_set, state):
    """Compute all terms of a set at the state in the table."""
    evaluate(state_view(state), term_set, t)
