"""Stages of variational equations by collocation, along points of recorded steps.

For s of r_y s + r_y' s' = r_y' d, the changes X_i = S_i - s solve A_i (s + X_i) + B_i (sum_j D_ij X_j / h - d_i) = 0, with A = r_y
and B = r_y' at each point.  As in Newton's iteration of a Radau step, mean matrices and D = T Lambda T^-1 give corrections
(`stiffmbs.solve.radau.native.newton`), by factors that serve for as many steps as they converge for.  The matrix of all stages
replaces them where they do not.
"""

from math import fabs, isfinite

from stiffmbs.compile.machine.native.access import (
    compiled,
    equations_view,
    factors_view,
    floats,
    shifted,
    state_view,
    view_of,
)
from stiffmbs.compile.machine.native.calls import call_int
from stiffmbs.compile.machine.native.evaluate import evaluate, load
from stiffmbs.compile.machine.native.factors import DONE, solve
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.compile.machine.native.statuses import OK
from stiffmbs.sensitivity_equations.native.layouts import STAGES
from stiffmbs.sensitivity_equations.native.parameters import ITERATION
from stiffmbs.solve.linear_solvers.native.sparse_lu import factored

stages_view = view_of("Stages", STAGES)


@compiled
def take_parts(e, values, n_slots, constant, rate):
    """Compute the parts of the matrix by y and y' from the values of its terms."""
    for k in range(n_slots):
        constant[k] = 0.0
        rate[k] = 0.0
    for k in range(e.n_entries):
        value = values[e.m_source[k]]
        constant[e.m_slot[k]] += value * e.m_constant[k]
        rate[e.m_slot[k]] += value * e.m_cj[k]


@compiled
def _take_points(c, points):
    """Compute the parts of the matrix at all points of a step."""
    state = state_view(c.state)
    e = equations_view(c.equations)
    for i in range(c.stages):
        row = shifted(points, i * (2 + 2 * c.n))
        load(state, e, shifted(row, 2), shifted(row, 2 + c.n))
        values = evaluate(state, e.matrix_set, row[0])
        take_parts(e, values, c.n_slots, shifted(c.constant, i * c.n_slots), shifted(c.rate, i * c.n_slots))


@compiled
def _factored_together(c, h):
    """Factor the matrix of all stages; return False if it is singular."""
    f = factors_view(c.whole)
    for k in range(f.a_start[f.n]):
        f.a[k] = 0.0
    for i in range(c.stages):
        for k in range(c.n_slots):
            f.a[c.own[i * c.n_slots + k]] += c.constant[i * c.n_slots + k]
        for j in range(c.stages):
            factor = c.derivative[i * c.stages + j] / h
            for k in range(c.n_coupled):
                f.a[c.coupling[(i * c.stages + j) * c.n_coupled + k]] += factor * c.rate[i * c.n_slots + c.coupled[k]]
    return factored(c.whole, c.whole_entries) == DONE


@compiled
def _factored_apart(c, h):
    """Factor the real and complex mean matrices; return False if one is singular."""
    for k in range(c.n_slots):
        c.mean_constant[k] = 0.0
        c.mean_rate[k] = 0.0
        for i in range(c.stages):
            c.mean_constant[k] += c.constant[i * c.n_slots + k] / c.stages
            c.mean_rate[k] += c.rate[i * c.n_slots + k] / c.stages
    c.h = 0.0
    a = floats(c.values[0])
    for k in range(c.n_slots):
        a[k] = c.mean_constant[k] + c.real[0] / h * c.mean_rate[k]
    if call_int(c.setup, (c.solvers, 0)) != OK:
        return False
    for pair in range(1, c.stages // 2 + 1):
        a = floats(c.values[pair])
        for k in range(c.n_slots):
            part = c.mean_constant[k] + c.real[pair] / h * c.mean_rate[k]
            a[c.re_re[k]] = part
            a[c.im_im[k]] = part
        for k in range(c.n_coupled):
            part = c.imaginary[pair] / h * c.mean_rate[c.coupled[k]]
            a[c.im_re[k]] = part
            a[c.re_im[k]] = -part
        if call_int(c.setup, (shifted(c.solvers, pair), 0)) != OK:
            return False
    c.h = h
    return True


@compiled
def _take_residual(c, h, s, rates, x):
    """Compute B_i (d_i - sum_j D_ij X_j / h) - A_i (s + X_i)."""
    n = c.n
    for i in range(c.stages):
        target = shifted(c.residual, i * n)
        for k in range(n):
            target[k] = 0.0
            slope = rates[i * n + k]
            for j in range(c.stages):
                slope -= c.derivative[i * c.stages + j] / h * x[j * n + k]
            c.slope[k] = slope
            c.sum[k] = s[k] + x[i * n + k]
        for k in range(c.n_slots):
            at = i * c.n_slots + k
            target[c.row[k]] += c.rate[at] * c.slope[c.column[k]] - c.constant[at] * c.sum[c.column[k]]


@compiled
def _transformed(c, matrix, of, into):
    """Compute the products of a matrix of shape (stages, stages) with vectors of all stages."""
    for i in range(c.stages):
        for k in range(c.n):
            total = 0.0
            for j in range(c.stages):
                total += matrix[i * c.stages + j] * of[j * c.n + k]
            into[i * c.n + k] = total


@compiled
def _corrected_apart(c):
    """Compute the correction of the residual by the mean matrices."""
    n = c.n
    _transformed(c, c.inverse, c.residual, c.apart)
    copied(c.pair, c.apart, n)
    call_int(c.solve, (c.solvers, 0, c.apart, c.pair, 0.0))
    for pair in range(1, c.stages // 2 + 1):
        re = shifted(c.apart, (2 * pair - 1) * n)
        im = shifted(c.apart, 2 * pair * n)
        for k in range(n):
            c.pair[2 * k] = re[k]
            c.pair[2 * k + 1] = im[k]
        call_int(c.solve, (shifted(c.solvers, pair), 0, c.solution, c.pair, 0.0))
        for k in range(n):
            re[k] = c.solution[2 * k]
            im[k] = c.solution[2 * k + 1]
    _transformed(c, c.transform, c.apart, c.correction)


@compiled
def _corrected_together(c):
    """Compute the correction of the residual by the matrix of all stages."""
    for i in range(c.stages):
        for k in range(c.n):
            c.apart[k * c.stages + i] = c.residual[i * c.n + k]
    solve(factors_view(c.whole), c.apart)
    for i in range(c.stages):
        for k in range(c.n):
            c.correction[i * c.n + k] = c.apart[k * c.stages + i]


@compiled
def _largest(c, values, stages):
    """Return the largest of the weighted numbers of some stages."""
    size = 0.0
    for i in range(stages):
        for k in range(c.n):
            part = fabs(c.weight[k] * values[i * c.n + k])
            size = part if part > size or not isfinite(part) else size
    return size


@compiled
def _iterated(c, h, s, rates, x, tolerance, renewed):
    """Iterate from X = 0 with the present factors; return True if that converges."""
    n = c.n
    for k in range(n * c.stages):
        x[k] = 0.0
    earlier, before = 0.0, 0.0
    last = (c.stages - 1) * n
    for number in range(ITERATION.most_corrections):
        _take_residual(c, h, s, rates, x)
        _corrected_apart(c)
        for k in range(n * c.stages):
            x[k] += c.correction[k]
        size = _largest(c, c.correction, c.stages)
        if size == 0.0 or (number > 0 and size <= tolerance * _largest(c, shifted(x, last), 1)):
            return True
        if not isfinite(size) or (number > 1 and not renewed and size > ITERATION.fast * ITERATION.fast * earlier):
            return False
        earlier, before = before, size
    return False


@compiled
def _solved(c, h, s, rates, x, tolerance):
    """Solve the equations of a step; return False if their matrix is singular."""
    if c.h > 0.0 and _iterated(c, h, s, rates, x, tolerance, False):
        return True
    if _factored_apart(c, h) and _iterated(c, h, s, rates, x, tolerance, True):
        return True
    c.h = 0.0
    if not _factored_together(c, h):
        return False
    for k in range(c.n * c.stages):
        x[k] = 0.0
    _take_residual(c, h, s, rates, x)
    _corrected_together(c)
    for k in range(c.n * c.stages):
        x[k] = c.correction[k]
    return True


def advance(count, points, sizes, rates, s, changes, tolerance, table):
    """Integrate over steps with points (time, order, y, y') and rates d, from s, which becomes that at the end.

    Compute X at all points; return the number of completed steps.
    """
    c = stages_view(table)
    n = c.n
    for step in range(count):
        x = shifted(changes, step * c.stages * n)
        _take_points(c, shifted(points, step * c.stages * (2 + 2 * n)))
        if not _solved(c, sizes[step], s, shifted(rates, step * c.stages * n), x, tolerance):
            return step
        for k in range(n):
            s[k] += x[(c.stages - 1) * n + k]
    return count


def apart(count, points, sizes, rates, s, changes, tolerance, table):
    """Integrate over each of some steps from s; the rest as in `advance`."""
    c = stages_view(table)
    for step in range(count):
        x = shifted(changes, step * c.stages * c.n)
        _take_points(c, shifted(points, step * c.stages * (2 + 2 * c.n)))
        if not _solved(c, sizes[step], s, shifted(rates, step * c.stages * c.n), x, tolerance):
            return step
    return count
