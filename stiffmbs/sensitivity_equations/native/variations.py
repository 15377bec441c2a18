"""Variational equations along a run: BDF with the steps, orders and iteration matrices of the run.

For s = dy/dp of r(t, y, y', p) = 0: r_y s + r_y' s' + r_p = 0.  The formulas are IDA's (Brenan, Campbell, Petzold 1996,
ch. 5).  The predictor of order k interpolates the last k + 1 points, and s' = s'_predicted + cj (s - s_predicted).  The
equation is linear: one solution with the step's matrix gives s (Caracotsios, Stewart, Comput. Chem. Eng. 9, 1985).

After an event whose time changes by dt_e/dp, s + y' dt_e/dp replaces s: the motion relative to the event.  Because of
r_y y' + r_y' y'' + r_t = 0, r_p + r_t dt_e/dp then replaces r_p.  The sum is smooth, while s itself is a large multiple
of y' between the events of neighbouring motions.
"""

from stiffmbs.compile.machine.native.access import compiled, equations_view, floats, ints, shifted, state_view, view_of
from stiffmbs.compile.machine.native.along import direction_view, evaluate_along
from stiffmbs.compile.machine.native.calls import call_int
from stiffmbs.compile.machine.native.evaluate import evaluate, load, share_one
from stiffmbs.sensitivity_equations.native.layouts import DEPTH, PART, VARIATIONS
from stiffmbs.sensitivity_equations.native.stages import take_parts

variations_view = view_of("Variations", VARIATIONS)
part_view = view_of("Part", PART)


@compiled
def _take_matrix(v, s, e, t, cj):
    """Compute and factor the parts of the matrix by y and y' at the current state; 0 or the linear solver's flag."""
    values = evaluate(s, e.matrix_set, t)
    for k in range(v.n_share):
        share_one(s, v.share[k])
    take_parts(e, values, v.n_slots, v.constant, v.rate)
    entries = floats(v.entries)
    for k in range(v.n_slots):
        entries[k] = v.constant[k] + cj * v.rate[k]
    v.cj = cj
    return call_int(v.setup, (v.solver, v.matrix))


@compiled
def _add_part(s, part, t, t_d, y, yp, r):
    """Add the change of the residual in one direction to r."""
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
    """Compute of_time = r_t if it is needed."""
    if v.shifted:
        for k in range(v.n):
            v.of_time[k] = 0.0
        _add_part(s, v.by_time, t, 1.0, y, yp, v.of_time)


@compiled
def _take_defect(v, s, direction, t, y, yp):
    """Compute defect = r_y s + r_y' s' + r_p for the current s and s', with their shift."""
    shift = v.shift[direction]
    for k in range(v.n):
        v.defect[k] = shift * v.of_time[k] if v.shifted else 0.0
    for k in range(v.n_slots):
        column = v.column[k]
        v.defect[v.row[k]] += v.constant[k] * v.s[column] + v.rate[k] * v.rates[column]
    _add_part(s, ints(v.parts[direction]), t, 0.0, y, yp, v.defect)


@compiled
def _take_formula(v, t, order):
    """Compute value and slope weights of the predictor at t by Lagrange interpolation; return cj."""
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
    """Compute s and s' of the predictor."""
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
    """Compute s of all directions at t in `out`; 0 or the linear solver's flag."""
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
    """Integrate along recorded steps (time, order, y, y'); return the number of completed steps."""
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
    """Compute s at a time within the step after the last one, with its order; 0 or the linear solver's flag."""
    v = variations_view(table)
    n = v.n
    s = state_view(v.state)
    e = equations_view(v.equations)
    return int(_stepped(v, s, e, row[0], int(row[1]), shifted(row, 2), shifted(row, 2 + n), out))


def defects(row, given, out, table):
    """Compute r_y s + r_y' s' + r_p of all directions for given s and s' = 0."""
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
