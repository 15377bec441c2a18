"""Linearly implicit Euler steps, with extrapolation: one evaluation, one factorisation and one solution each."""

from math import fabs, isfinite

from stiffmbs.compile.machine.native.access import compiled, equations_view, shifted, state_view
from stiffmbs.compile.machine.native.calls import call_int, int32
from stiffmbs.compile.machine.native.evaluate import MOTION, add_condensed, add_entries, add_products, evaluate
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.compile.machine.native.orientation import move, take_unit_length
from stiffmbs.compile.machine.native.statuses import FAILED, NO_MEMORY, NOT_FINITE, OK, SINGULAR
from stiffmbs.solve.explicit.native.parameters import LINEARLY_IMPLICIT_STEPS
from stiffmbs.solve.explicit.native.stages import linear_view, load_state


@compiled
def _is_unresolved(p, s, e):
    """Return True if forces drive a motion that grows faster than a step resolves.

    With the matrix A = M/h - f_u - h f_q Z of the velocities, du A du = du f - lam b is then negative. States that forces depend on
    hide that.
    """
    if s.n_q > s.n_pose:
        return False
    work, size = 0.0, 0.0
    for k in range(e.n):
        part = p.x[k] * p.b[k]
        work += part if k < s.n_u else -part
        size += fabs(part)
    return work < -LINEARLY_IMPLICIT_STEPS.noise * size


@compiled
def _euler(p, s, e, t, h):
    """Take a step of length h from time t, linearised at the positions of constant velocities; 0 or a negative status."""
    end = t + h
    move(s, s.u, h)
    tangent = evaluate(s, e.matrix_set, end)
    add_entries(e, tangent, 1.0 / h, p.entries)
    add_condensed(s, e, tangent, h, p.entries)
    outcome = call_int(p.setup, (p.solver, 0))
    if outcome != OK:
        return NO_MEMORY if outcome == FAILED else SINGULAR
    copied(p.x, s.u, s.n_u)  # the velocities at the start, of which counters have their rates
    add_products(e, evaluate(s, MOTION, end), p.x, p.x, p.b)
    call_int(p.solve, (p.solver, 0, p.x, p.b, 0.0))
    for k in range(e.n):
        if not isfinite(p.x[k]):
            return NOT_FINITE
    if p.unresolved != p.unresolved and _is_unresolved(p, s, e):  # NaN: no step before
        p.unresolved = t
    for k in range(s.n_u):
        s.u[k] += p.x[k]
    for k in range(s.n_q - s.n_pose):
        s.q[s.n_pose + k] += p.x[s.n_u + k]
    move(s, p.x, h)
    return 0


@compiled
def _extrapolated(p, s, e, t, h):
    """Take one step, then two of half the length, whose doubled result less that of the first has order 2."""
    copied(p.start, s.q, s.n_q)
    copied(shifted(p.start, s.n_q), s.u, s.n_u)
    status = _euler(p, s, e, t, h)
    if status < 0:
        return status
    copied(p.whole, s.q, s.n_q)
    copied(shifted(p.whole, s.n_q), s.u, s.n_u)
    load_state(s, p.start)
    for half in range(2):
        status = _euler(p, s, e, t + 0.5 * half * h, 0.5 * h)
        if status < 0:
            return status
    for k in range(s.n_q):
        s.q[k] += s.q[k] - p.whole[k]
    for k in range(s.n_u):
        s.u[k] += s.u[k] - p.whole[s.n_q + k]
    take_unit_length(s)
    return 0


def linear_step(t, h, linear):
    """Take a step of length h from time t and the current state, without projection; 0 or a negative status."""
    p = linear_view(linear)
    s, e = state_view(p.state), equations_view(p.equations)
    if p.columns == 2:
        return int32(_extrapolated(p, s, e, t, h))
    return int32(_euler(p, s, e, t, h))


def array_of(vector):
    """Return the address of an array, which stands for a vector of SUNDIALS."""
    return vector
