"""Accelerations by elimination of u' from the block system: J M^-1 J^T lam = J M^-1 f - gamma.

Twice as fast as the LU of the whole where bodies carry few joints each; the mass matrix is diagonal.
"""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled, eliminated_view, state_view
from stiffmbs.compile.machine.native.evaluate import ACCELERATION, evaluate

LOST = 1e-6
"""A pivot that keeps less than this part of its diagonal entry is left to the LU with pivoting."""
SMALL, TOGETHER, BESIDE = 1e-2, 1e-9, 1e-5
"""Pivots that keep less than the first part, and what they may keep together: the loss of digits of one is passed on to the next.
Beside what they have kept together elsewhere on the way they may keep the last part."""


@compiled
def _assemble(r, values):
    """S = j j^T by slots with j = J M^-1/2, a = M^-1/2 f and b = j a - gamma."""
    for k in range(r.n_u):
        r.a[k] = 0.0
    for k in range(r.n_f):
        r.a[r.f_row[k]] += values[r.f_source[k]]
    for k in range(r.n_u):
        r.a[k] *= r.scale[k]
    for k in range(r.n):
        r.b[k] = 0.0
    for k in range(r.n_gamma):
        r.b[r.gamma_row[k]] -= values[r.gamma_source[k]]
    for k in range(r.n_j):
        value = values[r.j_source[k]] * r.j_scale[k]
        r.j[k] = value
        r.b[r.j_row[k]] += value * r.a[r.j_column[k]]
    at = 0
    for k in range(r.n_slots):
        total = 0.0
        end = r.product_end[k]
        while at < end:
            total += r.j[r.product_first[at]] * r.j[r.product_second[at]]
            at += 1
        r.s[k] = total
    for k in range(r.n):
        r.diagonal[k] = r.s[r.column_start[k]]


@compiled
def _factored(r):
    """S = L D L^T column by column, and b overwritten by D^-1 L^-1 b on the way; whether all pivots kept enough digits.

    The diagonal slots of `s` receive 1/D.
    """
    at = 0
    kept = 1.0
    r.kept = kept
    for k in range(r.n):
        first = r.column_start[k]
        end = r.column_start[k + 1]
        pivot = r.s[first]
        if not pivot > SMALL * r.diagonal[k]:
            kept *= pivot / r.diagonal[k]
            r.kept = kept
            if not pivot > LOST * r.diagonal[k] or not kept > max(TOGETHER, BESIDE * r.most_kept):
                return False
        inverse = 1.0 / pivot
        r.s[first] = inverse
        b = r.b[k]
        r.b[k] = b * inverse
        for p in range(first + 1, end):
            r.l[p] = r.s[p] * inverse
            r.b[r.row[p]] -= r.l[p] * b
        for p in range(first + 1, end):
            value = r.l[p]
            for below in range(p, end):
                r.s[r.update_slot[at]] -= value * r.s[below]
                at += 1
    r.most_kept = max(r.most_kept, kept)
    return True


@compiled
def _forward(r):
    """b overwritten by D^-1 L^-1 b."""
    for k in range(r.n):
        b = r.b[k]
        for p in range(r.column_start[k] + 1, r.column_start[k + 1]):
            r.b[r.row[p]] -= r.l[p] * b
        r.b[k] = b * r.s[r.column_start[k]]


@compiled
def _backward(r):
    """b overwritten by L^-T b."""
    for k in range(r.n - 1, -1, -1):
        value = r.b[k]
        for p in range(r.column_start[k] + 1, r.column_start[k + 1]):
            value -= r.l[p] * r.b[r.row[p]]
        r.b[k] = value


@compiled
def eliminated_accelerations(r, s, t):
    """Accelerations (in r.a) and multipliers (in lam) at the current state; whether that could be done."""
    values = evaluate(s, ACCELERATION, t)
    _assemble(r, values)
    r.ready = _factored(r)
    if not r.ready:
        return False
    _backward(r)
    for k in range(r.n_j):
        r.a[r.j_column[k]] -= r.j[k] * r.b[r.j_row[k]]
    for k in range(r.n_u):
        r.a[k] *= r.scale[k]
    for k in range(s.n_c):
        s.lam[k] = r.b[r.at_lam[k]] if r.at_lam[k] >= 0 else 0.0
    return True


@compiled
def smallest_move(r, s, violations):
    """In r.a, the smallest change of velocities in the mass matrix, or move of the pose, that closes small violations; by J and the
    factors of the last accelerations."""
    for k in range(s.n_c):
        if r.at_lam[k] >= 0:
            r.b[r.at_lam[k]] = violations[k]
    _forward(r)
    _backward(r)
    for k in range(r.n_u):
        r.a[k] = 0.0
    for k in range(r.n_j):
        r.a[r.j_column[k]] -= r.j[k] * r.b[r.j_row[k]] * r.j_scale[k]


def accelerate(t, acceleration, eliminated):
    """`eliminated_accelerations` from Python; accelerations are copied out."""
    r = eliminated_view(eliminated)
    done = eliminated_accelerations(r, state_view(r.state), t)
    for k in range(r.n_u):
        acceleration[k] = r.a[k]
    return done
