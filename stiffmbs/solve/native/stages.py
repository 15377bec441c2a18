"""The stages of an explicit Runge-Kutta step: rates of change at weighted sums of earlier ones."""

from __future__ import annotations

from stiffmbs.compile.native.access import compiled, eliminated_view, factors_view, shifted
from stiffmbs.solve.native.eliminated import eliminated_accelerations
from stiffmbs.solve.native.mechanics import to_accelerations


@compiled
def copied(target, source, count):
    """Copy numbers."""
    for i in range(count):
        target[i] = source[i]


@compiled
def add_stages(x, target, weights, count, factor):
    """target += factor * sum of weights_j k_j over the first `count` stages."""
    for j in range(count):
        weight = factor * weights[j]
        if weight != 0.0:
            k = shifted(x.k, j * x.n)
            for i in range(x.n):
                target[i] += weight * k[i]


@compiled
def weighted(x, c, target, row, h):
    """target = y_before + h * sum of a_row,j k_j: where stage `row` is taken."""
    copied(target, x.y_before, x.n)
    add_stages(x, target, shifted(c.a, row * c.extended), row, h)


@compiled
def load_state(s, y):
    """The state (q, u) for the kernels."""
    copied(s.q, y, s.n_q)
    copied(s.u, shifted(y, s.n_q), s.n_u)


@compiled
def rates(x, s, m, stage, t):
    """k_stage = (q', u') at the state at hand; 0 or a negative status."""
    k = shifted(x.k, stage * x.n)
    copied(k, s.u, s.n_q)
    x.accelerations[0] += 1
    if x.eliminates:
        r = eliminated_view(x.eliminated)
        if eliminated_accelerations(r, s, t):
            copied(shifted(k, s.n_q), r.a, s.n_u)
            return 0
    status = to_accelerations(s, m, t)
    copied(shifted(k, s.n_q), factors_view(m.acceleration_factors).b, s.n_u)
    return status


@compiled
def take_stage(x, c, s, m, row, h):
    """Stage `row` of the step of length h that starts at t_before; 0 or a negative status."""
    weighted(x, c, x.y_stage, row, h)
    load_state(s, x.y_stage)
    return rates(x, s, m, row, x.t_before[0] + c.c[row] * h)
