"""Variational equations along a run: BDF over the run's own steps, with its own orders and iteration matrices.

For s = dy/dp of r(t, y, y', p) = 0: r_y s + r_y' s' + r_p = 0.  The formulas are IDA's (Brenan, Campbell, Petzold 1996, ch. 5): of
order k the predictor goes through the last k + 1 points, and s' = s'_predicted + cj (s - s_predicted).  The equation is linear,
so that one solution with the matrix of the step gives s (Caracotsios and Stewart, Comput. Chem. Eng. 9, 1985).

Behind an event whose instant moves by dt_e/dp, s + y' dt_e/dp is integrated in place of s: the motion seen from the event.  As
r_y y' + r_y' y'' + r_t = 0, that takes r_p + r_t dt_e/dp in place of r_p.  It is smooth where s itself, which compares a state in
a contact with one that has not come to it yet, is a large multiple of y'.
"""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled, equations_view, floats, ints, shifted, state_view, view_of
from stiffmbs.compile.machine.native.along import direction_view, evaluate_along, share_one
from stiffmbs.compile.machine.native.evaluate import evaluate, load
from stiffmbs.solve.native.calls import call_int, copy_bytes
from stiffmbs.solve.native.tables.variations import DEPTH, PART, VARIATIONS

variations_view = view_of("Variations", VARIATIONS)
part_view = view_of("Part", PART)


@compiled
def _take_matrix(v, s, e, t, cj):
    """The parts of the matrix by y and by y' at the state at hand, and its factors; 0 where they were found."""
    values = evaluate(s, e.matrix_set, t)
    for k in range(v.n_share):
        share_one(s, v.share[k])
    for k in range(v.n_slots):
        v.constant[k] = 0.0
        v.rate[k] = 0.0
    for k in range(e.n_entries):
        value = values[e.m_source[k]]
        v.constant[e.m_slot[k]] += value * e.m_constant[k]
        v.rate[e.m_slot[k]] += value * e.m_cj[k]
    call_int(v.clear, (v.matrix,))
    entries = floats(v.entries)
    for k in range(v.n_slots):
        entries[v.place[k]] = v.constant[k] + cj * v.rate[k]
    for k in range(0, 6, 3):
        copy_bytes(v.pattern[k], v.pattern[k + 1], v.pattern[k + 2])
    v.cj = cj
    return call_int(v.setup, (v.solver, v.matrix))


@compiled
def _add_part(s, part, t, t_d, y, yp, r):
    """r += the change of the residual in one direction."""
    p = part_view(part)
    d = direction_view(p.direction)
    evaluate_along(s, d, t, t_d)
    for k in range(p.n_plain):
        r[p.row[k]] += p.factor[k] * d.values[p.source[k]]
    for k in range(p.n_plain, p.n_with_y):
        r[p.row[k]] += p.factor[k] * d.values[p.source[k]] * y[p.operand[k]]
    for k in range(p.n_with_y, p.n_with_yp):
        r[p.row[k]] += p.factor[k] * d.values[p.source[k]] * yp[p.operand[k]]


@compiled
def _take_rate(v, s, t, y, yp):
    """of_time = r_t, where it is needed."""
    if v.shifted:
        for k in range(v.n):
            v.of_time[k] = 0.0
        _add_part(s, v.by_time, t, 1.0, y, yp, v.of_time)


@compiled
def _take_defect(v, s, direction, t, y, yp):
    """defect = r_y s + r_y' s' + r_p for the s and s' at hand, shifted as they are."""
    shift = v.shift[direction]
    for k in range(v.n):
        v.defect[k] = shift * v.of_time[k] if v.shifted else 0.0
    for k in range(v.n_slots):
        column = v.column[k]
        v.defect[v.row[k]] += v.constant[k] * v.s[column] + v.rate[k] * v.rates[column]
    _add_part(s, ints(v.parts[direction]), t, 0.0, y, yp, v.defect)


@compiled
def _take_formula(v, t, order):
    """Coefficients of the predictor's value and slope at t, by Lagrange's polynomials through the last order + 1 points; cj."""
    for i in range(order + 1):
        at = v.times[(v.newest - i + DEPTH) % DEPTH]
        value = 1.0
        slope = 0.0
        for j in range(order + 1):
            if j != i:
                other = v.times[(v.newest - j + DEPTH) % DEPTH]
                slope = (slope * (t - other) + value) / (at - other)
                value = value * (t - other) / (at - other)
        v.weight[i] = value
        v.slope[i] = slope
    total = 0.0
    for j in range(order):
        total += 1.0 / (j + 1.0)
    return total / (t - v.times[v.newest])


@compiled
def _predict(v, direction, order):
    """s and s' of the predictor."""
    n = v.n
    for k in range(n):
        v.s[k] = 0.0
        v.rates[k] = 0.0
    for i in range(order + 1):
        row = (v.newest - i + DEPTH) % DEPTH
        past = shifted(v.history, (row * v.n_directions + direction) * n)
        weight = v.weight[i]
        slope = v.slope[i]
        for k in range(n):
            v.s[k] += weight * past[k]
            v.rates[k] += slope * past[k]


@compiled
def _stepped(v, s, e, t, order, y, yp, out):
    """s of all directions at t, into `out`; 0, or the linear solver's flag."""
    load(s, e, y, yp)
    cj = _take_formula(v, t, order)
    flag = _take_matrix(v, s, e, t, cj)
    if flag != 0:
        return flag
    _take_rate(v, s, t, y, yp)
    for direction in range(v.n_directions):
        _predict(v, direction, order)
        _take_defect(v, s, direction, t, y, yp)
        call_int(v.solve, (v.solver, v.matrix, v.at_correction, v.at_defect, 0.0))
        for k in range(v.n):
            out[direction * v.n + k] = v.s[k] - v.correction[k]
    return flag


def advance(count, rows, table):
    """Steps along recorded ones (time, order, y, y'); how many could be made."""
    v = variations_view(table)
    s = state_view(v.state)
    e = equations_view(v.equations)
    n = v.n
    for k in range(count):
        row = shifted(rows, (2 + 2 * n) * k)
        new = (v.newest + 1) % DEPTH
        out = shifted(v.history, new * v.n_directions * n)
        if _stepped(v, s, e, row[0], int(row[1]), shifted(row, 2), shifted(row, 2 + n), out) != 0:
            return k
        v.times[new] = row[0]
        v.newest = new
    return count


def within(row, out, table):
    """s at a time within the step that follows the last one, whose order it has; 0, or the linear solver's flag."""
    v = variations_view(table)
    n = v.n
    s = state_view(v.state)
    e = equations_view(v.equations)
    return int(_stepped(v, s, e, row[0], int(row[1]), shifted(row, 2), shifted(row, 2 + n), out))


def defects(row, given, out, table):
    """r_y s + r_y' s' + r_p of all directions for given s, and s' = 0."""
    v = variations_view(table)
    n = v.n
    s = state_view(v.state)
    e = equations_view(v.equations)
    y, yp = shifted(row, 2), shifted(row, 2 + n)
    load(s, e, y, yp)
    flag = _take_matrix(v, s, e, row[0], 1.0)
    _take_rate(v, s, row[0], y, yp)
    for direction in range(v.n_directions):
        for k in range(n):
            v.s[k] = given[direction * n + k]
            v.rates[k] = 0.0
        _take_defect(v, s, direction, row[0], y, yp)
        for k in range(n):
            out[direction * n + k] = v.defect[k]
    return int(flag)
