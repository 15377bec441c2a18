"""Accelerations by elimination of u' from the block system: J M^-1 J^T lam = J M^-1 f - gamma.

The mass matrix is diagonal.  The method is far faster than the whole LU if bodies have few joints each.
"""

from math import log
from typing import Final

from stiffmbs.compile.machine.native.access import compiled, state_view
from stiffmbs.compile.machine.native.calls import int32
from stiffmbs.compile.machine.native.evaluate import ACCELERATION, evaluate
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.dynamics.elimination.native.by_blocks import (
    accelerate_by_blocks,
    blocks_view,
    factor_by_blocks,
    move_by_blocks,
)
from stiffmbs.dynamics.elimination.native.by_pins import accelerate_by_pins, move_by_pins, pins_view
from stiffmbs.dynamics.native.parameters import ELIMINATION
from stiffmbs.dynamics.native.views import eliminated_view

SMALL_PRODUCT: Final = 1e-100
"""Product of pivots from which on the next one may not be a number of full precision."""


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
    r.ready = accelerate_by_blocks(r, blocks_view(r.lists), s, values)
    _scale(r)
    if r.ready and r.trees and r.kept <= ELIMINATION.lost:
        _correct(r, blocks_view(r.lists), s, values)
    return r.ready


@compiled
def _correct(r, b, s, values):
    """Correct accelerations and multipliers once by the residual of J u' = gamma, which squares their relative error."""
    for row in range(s.n_c):
        r.left[row] = 0.0
    for k in range(r.n_gamma):
        r.left[r.gamma_row[k]] -= values[r.gamma_source[k]]
    for k in range(r.n_j):
        r.left[r.j_row[k]] += values[r.j_source[k]] * r.a[r.j_column[k]]
    copied(r.u_before, r.a, r.n_u)
    smallest_move(r, s, r.left)
    for k in range(r.n_u):
        r.a[k] += r.u_before[k]
    for k in range(s.n_c):
        s.lam[k] += b.x[b.place[k]] if b.place[k] >= 0 else 0.0


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
    move_by_blocks(r, blocks_view(r.lists), s, violations)
    _scale(r)


@compiled
def log_determinant_by_blocks(r):
    """Return log |det| of the block matrix [M J^T; J 0], as det M det(J M^-1 J^T)."""
    b = blocks_view(r.lists)
    total = r.log_mass
    product = 1.0
    for k in range(b.n_pivots):
        product *= b.pivot[k]
        if not SMALL_PRODUCT <= product <= 1.0 / SMALL_PRODUCT:  # logarithms are expensive
            total += log(product)
            product = 1.0
    return total + log(product)


def attempt(t, acceleration, eliminated):
    """Call `eliminated_accelerations` from other compiled code, and copy the accelerations."""
    r = eliminated_view(eliminated)
    done = eliminated_accelerations(r, state_view(r.state), t)
    for k in range(r.n_u):
        acceleration[k] = r.a[k]
    return int32(done)


def factor(t, joints, eliminated):
    """Factor the blocks for moves at the current pose; `joints`: table of the state with their acceleration terms alone."""
    r = eliminated_view(eliminated)
    r.ready = factor_by_blocks(r, blocks_view(r.lists), evaluate(state_view(joints), ACCELERATION, t))
    return int32(r.ready)


def move(violations, eliminated):
    """Call `smallest_move` from other compiled code."""
    r = eliminated_view(eliminated)
    smallest_move(r, state_view(r.state), violations)
    return int32(0)
