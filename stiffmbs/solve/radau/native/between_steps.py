"""States of the last step in which joints are closed and stiff forces are in equilibrium.

The interpolation errors of positions would make large forces. In a step that is long for the stiff forces, a state is
therefore moved by Newton corrections with the factors of the step. Joints are then closed, and forces agree with the
polynomial of the efforts. The outputs of a step share a few such corrections, which are interpolated (Newton's form). No output
changes others, or the steps that follow.
"""

from stiffmbs.compile.machine.native.access import compiled, equations_view, ints, shifted, state_view
from stiffmbs.compile.machine.native.evaluate import EFFORT, evaluate, load
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.solve.error_control.native.parameters import POLISHING
from stiffmbs.solve.ida.native.output_correction import output_correction_view
from stiffmbs.solve.radau.native.memory import collocation_view, polynomial, polynomial_rates
from stiffmbs.solve.radau.native.newton import (
    add_efforts,
    exchange_terms,
    factored,
    residual,
    size_in_tolerances,
    solved_real,
    store_misfit,
)

ROUNDING = 1e-11
"""Relative size of corrections that are rounding."""
MOST_MOVED = 0.5
"""Largest change of the state at the end of a step, in tolerances."""
AGREED, CLOSED, OPEN = range(3)
UNKNOWN, SUFFICE, TOO_FEW = range(3)
"""Whether interpolated corrections suffice in a step."""


@compiled
def _defects(x, t):
    """Compute the negative residuals of joints in `x.b`, with zeros elsewhere, and the misfit of efforts.

    Rows with rates, such as constraints of accelerations, do not close joints.
    """
    if x.n_closing > 0:
        residual(x, t, x.y_stage, x.yp_stage, x.b, x.misfit)
        for k in range(x.n):
            x.b[k] = -x.b[k] if x.weight[k] == 0.0 and x.algebraic[k] > 0.0 else 0.0
        return
    s = state_view(x.state)
    load(s, equations_view(x.equations), x.y_stage, x.yp_stage)
    store_misfit(x, evaluate(s, EFFORT, t), x.y_stage, x.misfit)
    for k in range(x.n):
        x.b[k] = 0.0


@compiled
def closed(x, t, most):
    """Close the state in `x.y_stage`.

    Returns AGREED if its forces had agreed with the efforts before, and its joints were closed to the part of the tolerance
    that Newton's iteration may leave; or OPEN if forces do not agree after the corrections, or if these exceed a number of
    tolerances.
    """
    # Efforts are known to rtol of the largest.  Of the state, only what closes joints and balances stiff forces changes:
    # the other equations are taken as satisfied, as the error of the step in them needs no correction.
    allowed = 0.0
    for k in range(x.n, x.n_all):
        allowed = max(allowed, abs(x.y_stage[k]))
    allowed *= x.rtol
    first = 0.0
    before = 0.0
    size = 0.0
    moved = 0.0
    enough = False
    for count in range(POLISHING.most_corrections):
        _defects(x, t)
        apart = 0.0
        for k in range(x.n_efforts):
            apart = max(apart, abs(x.misfit[k]))
        if count == 0:
            first = apart
        if apart <= allowed and (count > 0 or x.n_closing == 0):
            enough = True
            break
        rate = apart / before if count > 0 else 1.0  # of convergence; its product with `apart` predicts the next misfit
        before = max(apart, 1e-300)
        for k in range(x.n_levers):
            x.b[x.lever_unknown[k]] += x.lever[k] * x.misfit[x.lever_effort[k]]
        solved_real(x)
        copied(x.d, x.x, x.n)
        add_efforts(x, x.d, x.misfit)
        for k in range(x.n_all):
            x.y_stage[k] += x.d[k]
        size = size_in_tolerances(x, x.d)
        moved += size
        if count == 0 and x.n_closing > 0:  # forces change as joints close
            for k in range(x.n, x.n_all):
                first = max(first, abs(x.d[k]))
        if rate * apart <= allowed:
            enough = True
            break
    if moved > most or not (enough or x.rtol * size <= ROUNDING):
        return OPEN
    return AGREED if first <= allowed and (x.n_closing == 0 or moved <= x.newton) else CLOSED


@compiled
def close_end(x, c, t, h):
    """Close the state at the end of the step, at a time t before the stop time; return True if that succeeded."""
    last = shifted(x.z, (c.stages - 1) * x.n_all)
    for k in range(x.n_all):
        x.y_stage[k] = x.y[k] + last[k]
    for k in range(x.n):
        x.yp_stage[k] = 0.0
    succeeded = closed(x, t, MOST_MOVED) != OPEN
    for k in range(x.n_all):
        last[k] = x.y_stage[k] - x.y[k]
    return succeeded


@compiled
def _corrected(x, c, place, count):
    """Compute the state in `x.y_stage`, with the first corrections; return their common factor at the place."""
    # Newton's form with the nodes 0 and 1, where states are closed, and the places before this one.
    polynomial(x, place, x.n_all, x.y_stage)
    factor = place * (1.0 - place)
    for j in range(count):
        correction = shifted(x.corrections, j * x.n_all)
        for k in range(x.n_all):
            x.y_stage[k] += factor * correction[k]
        factor *= place - c.between[j]
    return factor


@compiled
def most_moved_within(c):
    """Return the largest change of a state within a step, in tolerances: its error is that of the estimate."""
    return POLISHING.most_moved * max(1.0, c.relaxed)


@compiled
def _closed_at(x, c, t, place):
    """Close the state at a place; the matrix of the step may be too old for it. Return False if it stays open."""
    _corrected(x, c, place, 0)
    if x.n_closing > 0:
        polynomial_rates(x, place, x.yp_stage)
    if closed(x, t, most_moved_within(c)) != OPEN:
        return True
    exchange_terms(x)
    _corrected(x, c, place, 0)
    polynomial_rates(x, place, x.yp_stage)
    h = x.h_factored
    succeeded = factored(x, c, x.h_past, t, x.y_stage, x.yp_stage, True) and closed(x, t, most_moved_within(c)) != OPEN
    exchange_terms(x)
    factored(x, c, h, t, x.y_stage, x.yp_stage, False)
    if not succeeded:
        _corrected(x, c, place, 0)
    return succeeded


@compiled
def _find_corrections(x, c):
    """Close the state at a few places of the step, until the corrections at earlier places make that unnecessary."""
    x.suffice = TOO_FEW
    for j in range(c.n_between):
        place = c.between[j]
        factor = _corrected(x, c, place, j)
        if x.n_closing > 0:
            polynomial_rates(x, place, x.yp_stage)
        correction = shifted(x.corrections, j * x.n_all)
        copied(correction, x.y_stage, x.n_all)
        x.n_corrections = j + 1
        outcome = closed(x, x.t - (1.0 - place) * x.h_past, most_moved_within(c))
        if outcome == OPEN:
            return
        for k in range(x.n_all):  # divided difference: earlier terms are in the state that was closed
            correction[k] = (x.y_stage[k] - correction[k]) / factor
        if outcome == AGREED and j + 1 >= c.stages:
            x.suffice = SUFFICE
            return


@compiled
def _close_prescribed(x, t, place, target):
    """Move the positions and velocities at a place that joints and drives prescribe onto these, by Newton corrections; others stay."""
    polynomial(x, place, x.n_all, x.y_stage)
    polynomial_rates(x, place, x.yp_stage)
    copied(target, x.y_stage, x.n)
    before = float("inf")
    for _ in range(POLISHING.most_corrections):
        residual(x, t, x.y_stage, x.yp_stage, x.b, x.misfit)
        for k in range(x.n):
            x.b[k] = -x.b[k] if x.weight[k] == 0.0 and x.algebraic[k] > 0.0 else 0.0
        solved_real(x)
        size = 0.0
        for i in range(x.n_positions):
            if x.prescribed[i]:
                k = x.position[i]
                x.y_stage[k] += x.x[k]
                part = x.x[k] * x.weight[k]
                size += part * part
                if x.velocity[i] >= 0:
                    x.y_stage[x.velocity[i]] += x.x[x.velocity[i]]
        if not size <= before:
            return
        copied(target, x.y_stage, x.n)
        if size <= x.newton * x.newton * x.n_tested:
            return
        before = size


@compiled
def dense_output(x, t, place, target):
    """Compute the state at a place of the last step; return False if it stays open."""
    if not (x.h_past > output_correction_view(x.output_correction).long and x.h_factored > 0.0 and place < 1.0):
        if x.apart > x.newton and x.h_factored > 0.0 and place < 1.0:
            _close_prescribed(x, t, place, target)
        else:
            polynomial(x, place, x.n, target)
        return True
    c = collocation_view(ints(x.methods[x.method_past]))
    if x.suffice == UNKNOWN:  # a polynomial of corrections costs less than a Newton iteration for each output
        _find_corrections(x, c)
    succeeded = True
    if x.suffice == SUFFICE:
        _corrected(x, c, place, x.n_corrections)
    else:
        succeeded = _closed_at(x, c, t, place)
    copied(target, x.y_stage, x.n)
    return succeeded
