"""Simplified Newton iteration for the stages of a Radau step.

The stages Z_i solve r(t + c_i h, y + Z_i, (1/h) sum_j D_ij Z_j) = 0 with the residual r(t, y, y') = M y' - f(t, y).
With D = T Lambda T^-1, the corrections delta = T^-1 dZ solve one real system (gamma/h M - f_y) delta_1 = -(T^-1 r)_1 and
complex ones with (alpha + i beta)/h.

References
----------
Hairer and Wanner, Solving Ordinary Differential Equations II (2nd ed. 1996), ch. IV.8: transformation, starting values,
end of the iteration.
"""

from math import isfinite, sqrt

from stiffmbs.compile.machine.native.access import compiled, equations_view, floats, ints, shifted, state_view
from stiffmbs.compile.machine.native.calls import call_int
from stiffmbs.compile.machine.native.evaluate import (
    EFFORT,
    EFFORT_TANGENT,
    add_entries,
    add_products,
    call_kernels,
    evaluate,
    load,
)
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.compile.machine.native.statuses import OK
from stiffmbs.solve.error_control.native.parameters import NEWTON
from stiffmbs.solve.events.native.parameters import INDISTINCT
from stiffmbs.solve.explicit.native.parameters import FIRST_STEP
from stiffmbs.solve.ida.native.output_correction import output_correction_view
from stiffmbs.solve.radau.native.memory import basis, collocation_view

MOST_ITERATIONS = 7
"""Largest number of iterations with three stages; each further stage adds two and a half."""
DIVERGING, SHORTER, MOST_LEFT = 0.99, 0.8, 20.0
"""As in RADAU5: ratio of corrections that ends the iteration; factor of a step whose iteration is too slow, and most
that counts of what it would leave."""
LATER = 5.0
"""Factor of the allowed remainder for corrections after the second, whose rate is better known."""
CONVERGED, SLOW, DIVERGED, NOT_FINITE_STAGE = range(4)


@compiled
def residual(x, t, y, yp, target, misfit):
    """Compute r(t, y, y') with the stored efforts of stiff forces, which follow the unknowns in y.

    Their misfit, F(q, u) - F, is part of the linearised equations; its levers are those of the matrix.
    """
    s = state_view(x.state)
    e = equations_view(x.equations)
    load(s, e, y, yp)
    add_products(e, evaluate(s, e.residual_set, t), y, yp, target)
    x.residuals += 1
    if x.acting > 0:
        # With stored efforts the residual is r + lever (F(q, u) - F).  The elimination of their changes,
        # dF = misfit + slope dy, takes the misfit times the lever of the matrix off again: a difference of levers is left.
        values = call_kernels(s, EFFORT, t)
        store_misfit(x, values, y, misfit)
        for k in range(x.n_levers):
            changed = x.lever_factor[k] * values[x.lever_source[k]] - x.lever[k]
            target[x.lever_unknown[k]] += changed * misfit[x.lever_effort[k]]


@compiled
def store_misfit(x, values, y, misfit):
    """Compute F(q, u) - F from the values of the efforts and those stored in y."""
    for k in range(x.n_efforts):
        misfit[k] = values[x.effort_source[k]] - y[x.n + k]


@compiled
def store_efforts(x, t):
    """Store the efforts of the state."""
    if x.acting > 0:
        s = state_view(x.state)
        load(s, equations_view(x.equations), x.y, x.yp)
        values = evaluate(s, EFFORT, t)
        for k in range(x.n_efforts):
            x.y[x.n + k] = values[x.effort_source[k]]


@compiled
def _store_slopes(x, s, t):
    """Store the levers and slopes of efforts at the state of the matrix."""
    values = evaluate(s, EFFORT, t)
    for k in range(x.n_levers):
        x.lever[k] = x.lever_factor[k] * values[x.lever_source[k]]
    values = evaluate(s, EFFORT_TANGENT, t)
    for k in range(x.n_slopes):
        x.slope[k] = x.slope_factor[k] * values[x.slope_source[k]]


@compiled
def add_efforts(x, change, misfit):
    """Compute the changes of efforts with those of the unknowns in `change`."""
    efforts = shifted(change, x.n)
    if x.acting == 0:
        for k in range(x.n_efforts):
            efforts[k] = 0.0
        return
    for k in range(x.n_efforts):
        efforts[k] = misfit[k]
    for k in range(x.n_slopes):
        efforts[x.slope_effort[k]] += x.slope[k] * change[x.slope_unknown[k]]


@compiled
def size_in_tolerances(x, values):
    """Return the RMS of a vector in tolerances."""
    total = 0.0
    for k in range(x.n):
        part = values[k] * x.weight[k]
        total += part * part
    return sqrt(total / x.n_tested)


@compiled
def _set_up(x, number):
    """Factor a filled matrix; return True unless it is singular."""
    x.factorizations += 1
    return call_int(x.setup, (x.solver[number], x.matrix[number])) == OK


@compiled
def exchange_terms(x):
    """Exchange the terms of the matrices, with levers and slopes of efforts, for those aside."""
    aside = x.terms_aside
    for k in range(x.n_terms):
        x.terms[k], aside[k] = aside[k], x.terms[k]
    aside = shifted(aside, x.n_terms)
    for k in range(x.n_levers):
        x.lever[k], aside[k] = aside[k], x.lever[k]
    aside = shifted(aside, x.n_levers)
    for k in range(x.n_slopes):
        x.slope[k], aside[k] = aside[k], x.slope[k]


@compiled
def factored(x, c, h, t, y, yp, renewed):
    """Factor the matrices of a step of length h; their terms are those at (t, y, y') if `renewed`, or the last ones."""
    s = state_view(x.state)
    e = equations_view(x.equations)
    x.h_factored = 0.0
    if renewed:
        load(s, e, y, yp)
        copied(x.terms, evaluate(s, e.matrix_set, t), x.n_terms)
        x.jacobians += 1
        if x.acting > 0:
            _store_slopes(x, s, t)
    values = x.terms
    a = x.entries
    add_entries(e, values, c.gamma / h, a)
    into = floats(x.values[0])
    total = 0.0
    for k in range(x.n_slots):
        into[k] = a[k]
        total += 0.0 * a[k]  # NaN as soon as an entry is not finite
    if total != 0.0 or not _set_up(x, 0):
        return False
    # A complex entry p + iq is the real block [[p, -q], [q, p]].  It starts as the real matrix; where y' enters, the
    # factor gamma/h is replaced by (alpha + i beta)/h.
    for pair in range(c.pairs):
        into = floats(x.values[pair + 1])
        for k in range(x.n_slots):
            into[x.re_re[k]] = a[k]
            into[x.im_im[k]] = a[k]
        for k in range(x.n_imaginary):
            into[x.im_re[k]] = 0.0
            into[x.re_im[k]] = 0.0
        for k in range(e.n_constant, e.n_entries):
            if e.m_cj[k] != 0.0:
                slot = e.m_slot[k]
                at = x.imaginary_of[slot]
                part = values[e.m_source[k]] * e.m_cj[k] / h
                into[x.re_re[slot]] += (c.alpha[pair] - c.gamma) * part
                into[x.im_im[slot]] += (c.alpha[pair] - c.gamma) * part
                into[x.im_re[at]] += c.beta[pair] * part
                into[x.re_im[at]] -= c.beta[pair] * part
        if not _set_up(x, pair + 1):
            return False
    x.h_factored = h
    x.stages_factored = c.stages
    output_correction_view(x.output_correction).current = c.gamma / h  # as cj of bdf: outputs share these factors
    return True


@compiled
def solved_real(x):
    """Solve the real system for the vectors of the table."""
    call_int(x.solve, (x.solver[0], x.matrix[0], x.at_x, x.at_b, 0.0))


@compiled
def predicted(x, h):
    """Return True if the polynomial of the last step predicts a step of length h.

    There is none after a start. That of a step much shorter, cut off before an event, magnifies rounding: its degree is the
    number of stages.
    """
    return h <= x.h_past * (1.0 / FIRST_STEP.part)


@compiled
def extrapolated(x, c, h):
    """Fill the stages from the polynomial of the last step, continued.

    Without one that predicts them, they are zero, as rates may belong to motions that decay at once; or follow from the
    rates if a step of known length is taken.
    """
    n = x.n_all
    if not predicted(x, h):
        predicts = x.first > 0.0 and x.acting == 0
        for i in range(c.stages):
            z = shifted(x.z, i * n)
            for k in range(x.n):
                z[k] = h * c.nodes[i] * x.yp[k] if predicts else 0.0
            for k in range(x.n, n):
                z[k] = 0.0
        return
    p = collocation_view(ints(x.methods[x.method_past]))
    for i in range(c.stages):
        place = 1.0 + c.nodes[i] * h / x.h_past  # the last step is from 0 to 1
        z = shifted(x.z, i * n)
        for k in range(n):
            z[k] = x.y_past[k] - x.y[k]
        for j in range(p.stages):
            factor = basis(p, j, place)
            past = shifted(x.past, j * n)
            for k in range(n):
                z[k] += factor * past[k]


@compiled
def stage_time(x, t):
    """Return the time of a stage, before the stop time, where laws may change."""
    return min(t, x.stop - INDISTINCT * abs(x.stop)) if x.stops else t


@compiled
def _stage_residual(x, c, t, h, i, target):
    """Compute r(t + c_i h, y + Z_i, (1/h) sum_j D_ij Z_j) and the misfit of the efforts of stage i."""
    z = shifted(x.z, i * x.n_all)
    for k in range(x.n_all):
        x.y_stage[k] = x.y[k] + z[k]
    for k in range(x.n):
        x.yp_stage[k] = 0.0
    for j in range(c.stages):
        factor = c.derivative[i * c.stages + j] / h
        other = shifted(x.z, j * x.n_all)
        for k in range(x.n):
            x.yp_stage[k] += factor * other[k]
    residual(x, stage_time(x, t + c.nodes[i] * h), x.y_stage, x.yp_stage, target, shifted(x.misfit, i * x.n_efforts))


@compiled
def _residuals(x, c, t, h):
    """Compute the residuals of all stages; return True if they are finite."""
    total = 0.0
    for i in range(c.stages):
        r = shifted(x.r, i * x.n)
        _stage_residual(x, c, t, h, i, r)
        for k in range(x.n):
            total += 0.0 * r[k]
    return total == 0.0


@compiled
def _confirmed(x, c, t, h, size, allowed):
    """Return True if the residual at the end of the step is small after a correction of a given size.

    A matrix that is too stiff for a motion hides it: its corrections are small and do not decrease. Large corrections
    of other motions conceal that in their ratio.
    """
    _stage_residual(x, c, t, h, c.stages - 1, x.b)
    for k in range(x.n):
        x.b[k] = -x.b[k]
    solved_real(x)
    # The next correction is known, hence the rate q = following / size and the remainder following q / (1 - q).
    following = size_in_tolerances(x, x.x)
    return following * following <= allowed * (size - following)


@compiled
def _transformed(x, c, row, target, stride):
    """Compute row `row` of -T^-1 r, with a stride."""
    n = x.n
    for k in range(n):
        target[stride * k] = 0.0
    for i in range(c.stages):
        factor = c.inverse[row * c.stages + i]
        r = shifted(x.r, i * n)
        for k in range(n):
            target[stride * k] -= factor * r[k]


@compiled
def _add_back(x, c, column, source, stride):
    """Add column `column` of T times a correction to the corrections of the stages, in the place of the residuals."""
    n = x.n
    for i in range(c.stages):
        factor = c.transform[i * c.stages + column]
        d = shifted(x.d, i * x.n_all)
        for k in range(n):
            d[k] += factor * source[stride * k]


@compiled
def _corrected(x, c):
    """Correct all stages; return the RMS of the corrections in tolerances."""
    n = x.n
    for k in range(c.stages * x.n_all):
        x.d[k] = 0.0
    # T decouples the stages: one real and (s - 1)/2 complex systems of n unknowns in place of one of s n.
    _transformed(x, c, 0, x.b, 1)
    solved_real(x)
    _add_back(x, c, 0, x.x, 1)
    for pair in range(c.pairs):
        for half in range(2):
            _transformed(x, c, 1 + 2 * pair + half, shifted(x.pair_b, half), 2)
        call_int(x.solve, (x.solver[pair + 1], x.matrix[pair + 1], x.at_pair_x, x.at_pair_b, 0.0))
        for half in range(2):
            _add_back(x, c, 1 + 2 * pair + half, shifted(x.pair_x, half), 2)
    total = 0.0
    for i in range(c.stages):
        d = shifted(x.d, i * x.n_all)
        z = shifted(x.z, i * x.n_all)
        if x.acting > 0:
            add_efforts(x, d, shifted(x.misfit, i * x.n_efforts))
        for k in range(n):
            part = d[k] * x.weight[k]
            total += part * part
        for k in range(x.n_all):
            z[k] += d[k]
    return sqrt(total / (c.stages * x.n_tested))


@compiled
def most_iterations(c):
    """Return the largest number of iterations."""
    return MOST_ITERATIONS + 5 * (c.stages - 3) // 2


@compiled
def iterated(x, c, t, h):
    """Solve the stages of a step; CONVERGED, or a reason with the suggested factor of the step in `x.suggested`."""
    most = most_iterations(c)
    negligible = min(x.newton, max(NEWTON.negligible, NEWTON.precision / x.rtol))
    before = 0.0
    ratio_before = 0.0
    x.suggested = x.after_failure
    x.contraction = 0.0
    for count in range(1, most + 1):
        if not _residuals(x, c, t, h):
            return NOT_FINITE_STAGE
        size = _corrected(x, c)
        x.iterations += 1
        x.iterations_taken = count
        if not isfinite(size):
            return NOT_FINITE_STAGE
        if count > 1:
            ratio = size / before if before > 0.0 else 0.0
            x.contraction = ratio if count <= 3 else sqrt(ratio * ratio_before)  # as in RADAU5
            ratio_before = ratio
        if count > 2:  # the first correction has the errors of extrapolated multipliers, which are in no norm
            if not x.contraction < DIVERGING:
                return DIVERGED
            # The remainder is q / (1 - q) times the last correction, with the rate q; `left` is that after `most` iterations.
            left = x.contraction / (1.0 - x.contraction) * size * x.contraction ** (most - 1 - count) / x.newton
            if left >= 1.0 and count < most:
                x.suggested = SHORTER * min(MOST_LEFT, left) ** (-1.0 / (3.0 + most - count))
                return SLOW
        before = max(size, 1e-300)
        x.left = size
        if size <= negligible:
            return CONVERGED
        if count > 1 and x.contraction < DIVERGING:
            x.left = x.contraction / (1.0 - x.contraction) * size
            doubtful = count == 2 or (x.acting > 0 and x.current)
            allowed = x.newton if count == 2 else LATER * x.newton
            if x.left <= x.newton and not (doubtful and not _confirmed(x, c, t, h, size, allowed)):
                return CONVERGED
    return SLOW
