"""Step of given length: stages, and projection of its end onto the constraints."""

from math import isfinite

from stiffmbs.compile.machine.native.access import compiled, shifted
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.compile.machine.native.statuses import NOT_FINITE
from stiffmbs.dynamics.native.projection import back_to_constraints
from stiffmbs.dynamics.native.views import eliminated_view
from stiffmbs.solve.events.native.parameters import EPSILON
from stiffmbs.solve.explicit.native.parameters import ENDS
from stiffmbs.solve.explicit.native.stages import keep_algebraic, load_state, rates, take_stage, weighted


@compiled
def arrive(x, c, s, m, t):
    """Project the new state y onto the constraints, and compute the rates there, the first stage of the next step.

    Rates that the error estimate has computed are kept, because the projection is smaller than the error.
    """
    load_state(s, x.y)
    if x.project:
        status = back_to_constraints(x, s, m, t)
        if status < 0:
            return status
        copied(x.y, s.q, s.n_q)
        copied(shifted(x.y, s.n_q), s.u, s.n_u)
    if not c.error_needs_end:
        status = rates(x, s, m, c.stages, t)
        if status < 0:
            return status
        keep_algebraic(s, m, x.y)
    for i in range(x.n):
        if not isfinite(x.y[i]):
            return NOT_FINITE
    return 0


@compiled
def attempt(x, c, s, m, h):
    """Compute all stages of a step from y_before, and the new state y; 0 or a negative status."""
    for row in range(1, c.stages):
        status = take_stage(x, c, s, m, row, h)
        if status < 0:
            return status
    weighted(x, c, x.y, c.stages, h)
    if c.error_needs_end:
        load_state(s, x.y)
        status = rates(x, s, m, c.stages, x.t_before + h)
        keep_algebraic(s, m, x.y)
        return status
    return 0


@compiled
def retaken(x, c, s, m, h):
    """Repeat the step with another length; 0 or a negative status."""
    status = attempt(x, c, s, m, h)
    if status < 0:
        return status
    x.span = h
    x.t = x.t_before + h
    x.dense_ready = 0
    return arrive(x, c, s, m, x.t)


@compiled
def distance_of_end(x):
    """Return the relative distance from a singular pose at the end of a step, the last evaluated state.

    It is infinite where it is not small. The scales of pivots are those of such ends: stages of rejected steps may be far away.
    """
    if not (x.pivots_tell and x.eliminates):
        return float("inf")
    r = eliminated_view(x.eliminated)
    copied(r.largest_scale, r.pivot_scale, r.n_scales)
    if r.kept > ENDS.close * r.most_kept:
        return float("inf")
    return (max(r.kept, 0.0) / r.most_kept) ** 0.5


@compiled
def across(x, distance):
    """Return the step from a distance that ends as far beyond a singular pose; infinite if none is approached.

    The stages of dopri5 and dop853, at up to 0.33 and from 0.6 of the step on, then keep away from the pose.
    """
    approach = x.distance - distance
    return 2.0 * x.span * distance / approach if isfinite(approach) and approach > 0.0 else float("inf")


@compiled
def uncertain_end(x, c, h, distance):
    """Return True if rounding of positions changes velocities in the next step by more than `harmful` tolerances."""
    if not isfinite(distance):
        return False
    if not distance > 0.0:
        return True
    rates = shifted(x.k, c.stages * x.n)
    total = 0.0
    for i in range(x.n_q, x.n):
        change = h * rates[i] * EPSILON / distance**3 * x.weight[i]
        total += change * change
    return total > ENDS.harmful * ENDS.harmful * x.n
