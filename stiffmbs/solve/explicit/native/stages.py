"""Stages of an explicit Runge-Kutta step: rates at weighted sums of earlier ones."""

from stiffmbs.compile.machine.native.access import compiled, factors_view, floats, shifted, view_of
from stiffmbs.compile.machine.native.evaluate import ACCELERATION, evaluate
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.compile.machine.native.orientation import add_rates
from stiffmbs.dynamics.elimination.native.eliminated import eliminated_accelerations
from stiffmbs.dynamics.native.block_systems import to_accelerations
from stiffmbs.dynamics.native.views import eliminated_view
from stiffmbs.solve.explicit.native.layouts import EXPLICIT, LINEARLY_IMPLICIT, SCHEME

explicit_view = view_of("Explicit", EXPLICIT)
scheme_view = view_of("Scheme", SCHEME)
linear_view = view_of("LinearlyImplicit", LINEARLY_IMPLICIT)


@compiled
def add_stages(x, target, weights, count, factor):
    """Compute target += factor * sum of weights_j k_j over the first `count` stages."""
    for j in range(count):
        weight = factor * weights[j]
        if weight != 0.0:
            k = shifted(x.k, j * x.n)
            for i in range(x.n):
                target[i] += weight * k[i]


@compiled
def weighted(x, c, target, row, h):
    """Compute target = y_before + h * sum of a_row,j k_j, the state of stage `row`."""
    copied(target, x.y_before, x.n)
    add_stages(x, target, shifted(c.a, row * c.extended), row, h)


@compiled
def load_state(s, y):
    """Load the state (q, u) for the kernels."""
    copied(s.q, y, s.n_q)
    copied(s.u, shifted(y, s.n_q), s.n_u)


@compiled
def accelerated(eliminates, eliminated, s, m, t, target):
    """Compute target = u' at the current state, by elimination if possible; 0 or a negative status."""
    if eliminates:
        r = eliminated_view(eliminated)
        if eliminated_accelerations(r, s, t):
            copied(target, r.a, s.n_u)
            if m.by_reactions:
                evaluate(s, ACCELERATION, t)
            return 0
    status = to_accelerations(s, m, t)
    copied(target, factors_view(m.acceleration_factors).b, s.n_u)
    return status


@compiled
def add_trailing_rates(s, m, factor, target):
    """Add factor * the rates of revolution counters and states, after accelerations at the current state."""
    values = floats(s.values[ACCELERATION])
    for k in range(m.n_trailing):
        target[m.trailing_row[k]] += factor * values[m.trailing_source[k]]


@compiled
def keep_algebraic(s, m, y):
    """Copy the current algebraic states into a state y = (q, u)."""
    for k in range(m.n_algebraic):
        y[m.algebraic[k]] = s.q[m.algebraic[k]]


@compiled
def rates(x, s, m, stage, t):
    """Compute k_stage = (q', u') at the current state; 0 or a negative status."""
    k = shifted(x.k, stage * x.n)
    for i in range(s.n_q):
        k[i] = 0.0
    add_rates(s, s.u, 1.0, k)
    x.accelerations += 1
    status = accelerated(x.eliminates, x.eliminated, s, m, t, shifted(k, s.n_q))
    add_trailing_rates(s, m, 1.0, k)
    return status


@compiled
def take_stage(x, c, s, m, row, h):
    """Compute stage `row` of the step of length h from t_before; 0 or a negative status."""
    weighted(x, c, x.y_stage, row, h)
    load_state(s, x.y_stage)
    return rates(x, s, m, row, x.t_before + c.c[row] * h)
