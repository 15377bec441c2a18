"""States within the last Runge-Kutta step, for output times between its ends.

y(theta) = y_before + theta (p_0 + (1 - theta) (p_1 + theta (p_2 + (1 - theta) (p_3 + ...)))).  The first three
polynomials follow from states and rates at both ends (Hermite), the others are sums of stages; Hairer, Norsett,
Wanner, Solving Ordinary Differential Equations I (1993), eq. II.6.15 and the codes DOPRI5 and DOP853.
"""

from math import isfinite

from stiffmbs.compile.machine.native.access import compiled, shifted
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.compile.machine.native.statuses import NOT_FINITE_WITHIN
from stiffmbs.solve.explicit.native.parameters import CONTROL
from stiffmbs.solve.explicit.native.stages import add_stages, take_stage, weighted


@compiled
def prepare(x, c, s, m):
    """Compute the coefficients p_k of the last step; 0 or a negative status."""
    n = x.n
    h = x.span
    free = c.n_free > 0 and _free_serves(x, c, h)
    if not free:
        for row in range(c.stages + 1, c.extended):
            status = take_stage(x, c, s, m, row, h)
            if status < 0:
                return status
    p = x.polynomial
    before, after = x.k, shifted(x.k, c.stages * n)
    for i in range(n):
        p[i] = x.y[i] - x.y_before[i]
        p[n + i] = h * before[i] - p[i]
        p[2 * n + i] = 2.0 * p[i] - h * (after[i] + before[i])
    rows = c.n_free if free else c.n_dense
    for row in range(rows):
        target = shifted(p, (3 + row) * n)
        for i in range(n):
            target[i] = 0.0
        add_stages(x, target, shifted(c.free if free else c.dense, row * c.extended), c.extended, h)
    sound = _sound(x, 3 + rows)
    if sound == 0:
        return NOT_FINITE_WITHIN
    x.dense_ready = sound
    return 0


@compiled
def _free_serves(x, c, h):
    """Return True if the stages of the step suffice: the error is small, or additional stages would not reduce it."""
    for i in range(x.n):
        x.difference[i] = 0.0
    add_stages(x, x.difference, c.free_error, c.stages + 1, h)
    total = 0.0
    for i in range(x.n):
        ratio = x.difference[i] * x.weight[i]
        total += ratio * ratio
    return total <= CONTROL.hardly_off**2 * x.n or _is_fast(x, c, h)


@compiled
def _is_fast(x, c, h):
    """Return True if h |lambda|, by two stages at the step's end, exceeds one: its powers then grow with the order."""
    last = c.stages - 1
    weighted(x, c, x.difference, last, h)
    k_end = shifted(x.k, c.stages * x.n)
    k_last = shifted(x.k, last * x.n)
    rate = 0.0
    move = 0.0
    for i in range(x.n):
        rate += (k_end[i] - k_last[i]) ** 2
        move += (x.y[i] - x.difference[i]) ** 2
    return h * h * rate > move


@compiled
def _sound(x, count):
    """Return the number of valid polynomials: all, those of ends and rates, or that of the ends; 0 if not finite.

    A stage is not finite if a Python function fails, or the domain of a law ends near the motion.  At rest, steps may
    be far longer than stability allows: stages, most of all those of the interpolant, then amplify rounding.
    """
    p = x.polynomial
    ends = 0.0
    by_rates = 0.0
    by_stages = 0.0
    for i in range(x.n):
        weight = x.weight[i] * x.weight[i]
        of_stages = 0.0
        for k in range(3, count):
            of_stages += p[k * x.n + i] * p[k * x.n + i]
        ends += p[i] * p[i] * weight
        by_rates += (p[x.n + i] * p[x.n + i] + p[2 * x.n + i] * p[2 * x.n + i]) * weight
        by_stages += of_stages * weight
    if not isfinite(ends + by_rates + by_stages):
        return 0
    if by_stages <= max(x.n, CONTROL.astray**2 * (ends + by_rates)):
        return count
    return 3 if by_rates <= max(x.n, CONTROL.astray**2 * ends) else 1


@compiled
def interpolated(x, c, theta, target):
    """Compute the state at a fraction theta of the last step; the increment is summed first, to reduce rounding."""
    n = x.n
    first = x.polynomial
    for i in range(n):
        target[i] = theta * first[i]
    factor = theta
    for k in range(1, x.dense_ready):
        factor *= theta if k % 2 == 0 else 1.0 - theta
        p = shifted(first, k * n)
        for i in range(n):
            target[i] += factor * p[i]
    for i in range(n):
        target[i] += x.y_before[i]


@compiled
def store_rows(x, c, s, m):
    """Store the states at all output times so far; 1 if complete, 0 if the memory is full, or a negative status."""
    while x.next_time < x.n_times and x.times[x.next_time] <= x.t:
        if x.rows == x.capacity:
            return 0
        time = x.times[x.next_time]
        target = shifted(x.row_y, x.rows * x.n)
        if time == x.t:
            copied(target, x.y, x.n)
        else:
            if not x.dense_ready:
                status = prepare(x, c, s, m)
                if status < 0:
                    return status
            interpolated(x, c, (time - x.t_before) / x.span, target)
        x.row_t[x.rows] = time
        x.rows += 1
        x.next_time += 1
    return 1


@compiled
def store_step(x):
    """Store the state after a step."""
    x.row_t[x.rows] = x.t
    copied(shifted(x.row_y, x.rows * x.n), x.y, x.n)
    x.rows += 1
