"""Accelerations by elimination of u' from the block system: J M^-1 J^T lam = J M^-1 f - gamma.

The mass matrix is diagonal.  The method is far faster than the whole LU if bodies have few joints each.
"""

from __future__ import annotations

from math import log

from stiffmbs.compile.machine.native.access import compiled, state_view, view_of
from stiffmbs.compile.machine.native.calls import int32
from stiffmbs.compile.machine.native.evaluate import ACCELERATION, evaluate
from stiffmbs.dynamics.elimination.native.by_blocks import accelerate_by_blocks, blocks_view, move_by_blocks
from stiffmbs.dynamics.elimination.native.by_pins import accelerate_by_pins, move_by_pins, pins_view
from stiffmbs.dynamics.elimination.native.digits import keeps_digits
from stiffmbs.dynamics.elimination.native.layouts import ENTRY_ELIMINATION
from stiffmbs.dynamics.native.views import eliminated_view


@compiled
def _scale(r):
    for k in range(r.n_u):
        r.a[k] *= r.scale[k]


@compiled
def eliminated_accelerations(r, s, t):
    """Compute accelerations (in r.a) and multipliers (in lam) at the current state; return True if successful."""
    values = evaluate(s, ACCELERATION, t)
    for k in range(r.n_u):
        r.a[k] = 0.0
    for k in range(r.n_f):
        r.a[r.f_row[k]] += values[r.f_source[k]]
    if r.by_pins:
        r.ready = accelerate_by_pins(r, pins_view(r.lists), s, values)
        return r.ready
    _scale(r)
    if r.by_blocks:
        r.ready = accelerate_by_blocks(r, blocks_view(r.lists), s, values)
    else:
        r.ready = accelerate_by_entries(r, entries_view(r.lists), s, values)
    _scale(r)
    return r.ready


@compiled
def smallest_move(r, s, violations):
    """Compute in r.a the change of velocities or pose that closes small violations, by the last J and factors.

    Its norm in the mass matrix is minimal.
    """
    for k in range(r.n_u):
        r.a[k] = 0.0
    if r.by_pins:
        move_by_pins(r, pins_view(r.lists), violations)
        return
    if r.by_blocks:
        move_by_blocks(r, blocks_view(r.lists), s, violations)
    else:
        move_by_entries(r, entries_view(r.lists), s, violations)
    _scale(r)


@compiled
def log_determinant_by_blocks(r):
    """Return log |det| of the block matrix [M J^T; J 0], as det M det(J M^-1 J^T)."""
    b = blocks_view(r.lists)
    total = 0.0
    for k in range(b.n_pivots):
        total += log(b.pivot[k])
    for k in range(r.n_u):
        total -= 2.0 * log(r.scale[k])
    return total


def attempt(t, acceleration, eliminated):
    """Call `eliminated_accelerations` from other compiled code, and copy the accelerations."""
    r = eliminated_view(eliminated)
    done = eliminated_accelerations(r, state_view(r.state), t)
    for k in range(r.n_u):
        acceleration[k] = r.a[k]
    return int32(done)


def move(violations, eliminated):
    """Call `smallest_move` from other compiled code."""
    r = eliminated_view(eliminated)
    smallest_move(r, state_view(r.state), violations)
    return int32(0)


entries_view = view_of("EntryElimination", ENTRY_ELIMINATION)


@compiled
def _assemble(r, e, values):
    """Assemble S = j j^T by slots with j = J M^-1/2, and b = j a - gamma."""
    for k in range(e.n):
        e.b[k] = 0.0
    for k in range(e.n_gamma):
        e.b[e.gamma_row[k]] -= values[e.gamma_source[k]]
    for k in range(e.n_j):
        value = values[e.j_source[k]] * e.j_scale[k]
        e.j[k] = value
        e.b[e.j_row[k]] += value * r.a[e.j_column[k]]
    at = 0
    for k in range(e.n_slots):
        total = 0.0
        end = e.product_end[k]
        while at < end:
            total += e.j[e.product_first[at]] * e.j[e.product_second[at]]
            at += 1
        e.s[k] = total
    for k in range(e.n):
        e.diagonal[k] = e.s[e.column_start[k]]


@compiled
def _factored(r, e):
    """Factor S = L D L^T by columns, and overwrite b by D^-1 L^-1 b; return True if all pivots are accurate.

    The diagonal slots of `s` receive 1/D.
    """
    at = 0
    r.kept = 1.0
    for k in range(e.n):
        first = e.column_start[k]
        end = e.column_start[k + 1]
        pivot = e.s[first]
        if not keeps_digits(r, pivot, e.diagonal[k]):
            return False
        inverse = 1.0 / pivot
        e.s[first] = inverse
        b = e.b[k]
        e.b[k] = b * inverse
        for p in range(first + 1, end):
            e.l[p] = e.s[p] * inverse
            e.b[e.row[p]] -= e.l[p] * b
        for p in range(first + 1, end):
            value = e.l[p]
            for below in range(p, end):
                e.s[e.update_slot[at]] -= value * e.s[below]
                at += 1
    r.most_kept = max(r.most_kept, r.kept)
    return True


@compiled
def _forward(e):
    """Overwrite b by D^-1 L^-1 b."""
    for k in range(e.n):
        b = e.b[k]
        for p in range(e.column_start[k] + 1, e.column_start[k + 1]):
            e.b[e.row[p]] -= e.l[p] * b
        e.b[k] = b * e.s[e.column_start[k]]


@compiled
def _backward(e):
    """Overwrite b by L^-T b."""
    for k in range(e.n - 1, -1, -1):
        value = e.b[k]
        for p in range(e.column_start[k] + 1, e.column_start[k + 1]):
            value -= e.l[p] * e.b[e.row[p]]
        e.b[k] = value


@compiled
def accelerate_by_entries(r, e, s, values):
    """Compute M^1/2 u' in r.a from M^-1/2 f there, and multipliers in lam; return True if successful."""
    _assemble(r, e, values)
    if not _factored(r, e):
        return False
    _backward(e)
    for k in range(e.n_j):
        r.a[e.j_column[k]] -= e.j[k] * e.b[e.j_row[k]]
    for k in range(s.n_c):
        s.lam[k] = e.b[e.at_lam[k]] if e.at_lam[k] >= 0 else 0.0
    return True


@compiled
def move_by_entries(r, e, s, violations):
    """Compute in r.a M^1/2 times the minimum-norm change of velocities that closes violations."""
    for k in range(s.n_c):
        if e.at_lam[k] >= 0:
            e.b[e.at_lam[k]] = violations[k]
    _forward(e)
    _backward(e)
    for k in range(e.n_j):
        r.a[e.j_column[k]] -= e.j[k] * e.b[e.j_row[k]]
