"""Steps of Radau methods with error control; predictive control of Gustafsson."""

from math import isfinite, sqrt
from typing import Final

from stiffmbs.compile.machine.native.access import compiled, equations_view, floats, ints, shifted, state_view
from stiffmbs.compile.machine.native.evaluate import add_rate_terms
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.solve.error_control.native.parameters import EXCLUDED
from stiffmbs.solve.events.native.parameters import INDISTINCT, SEARCH
from stiffmbs.solve.events.native.step_bound import STRETCHED
from stiffmbs.solve.explicit.native.parameters import CONTROL, FIRST_STEP
from stiffmbs.solve.ida.native.error_norm import error_norm_view
from stiffmbs.solve.ida.native.output_correction import output_correction_view
from stiffmbs.solve.radau.native.between_steps import CLOSED, MOST_MOVED, UNKNOWN, close_end, closed
from stiffmbs.solve.radau.native.memory import basis, collocation_view
from stiffmbs.solve.radau.native.newton import (
    CONVERGED,
    DIVERGED,
    SLOW,
    add_efforts,
    extrapolated,
    factored,
    iterated,
    most_iterations,
    residual,
    size_in_tolerances,
    solved_real,
    stage_time,
    store_efforts,
)

ERROR_TEST_FAILED: Final = -3
NO_CONVERGENCE: Final = -4
"""Flags of IDA: IDA_ERR_FAIL, IDA_CONV_FAIL."""
SMALLEST = 4 * INDISTINCT
"""Least step, relative to the time."""
ROUNDING = 1e-10
"""Least estimated error."""
LEAST_ERROR = 1e-2
"""Least error in the predictive control."""
MOST_DECAYS = 4
"""Largest number of replacements of a start by a state without decaying motions."""


@compiled
def set_weights(x):
    """Compute the inverse tolerances at the state, times the step, if known, where the absolute one is negative."""
    for k in range(x.n):
        atol = x.atol[k]
        part = x.h if atol < 0.0 and x.h > 0.0 else 1.0
        x.weight[k] = part / (x.rtol * abs(x.y[k]) + abs(atol)) if atol < EXCLUDED else 0.0


@compiled
def _solved_defect(x, t, y):
    """Compute (gamma/h M - f_y)^-1 (f(t, y) - M y') for y' in `x.yp_stage`; return its size in tolerances."""
    residual(x, t, y, x.yp_stage, x.b, x.misfit)
    for k in range(x.n):
        x.b[k] = -x.b[k]
    solved_real(x)
    repeats = error_norm_view(x.error_norm).repeats  # periods of a law among which the tolerance is shared
    return repeats * size_in_tolerances(x, x.x)


@compiled
def _estimate(x, c, t, h, y):
    """Compute the error (gamma/h M - f_y)^-1 (f(t, y) + M sum d_i Z_i / h); return its size in tolerances."""
    for k in range(x.n):
        x.yp_stage[k] = 0.0
    for i in range(c.stages):
        factor = -c.error[i] / h
        z = shifted(x.z, i * x.n_all)
        for k in range(x.n):
            x.yp_stage[k] += factor * z[k]
    size = _solved_defect(x, t, y)
    copied(x.error, x.x, x.n)
    return max(ROUNDING, _size_of_estimate(x, c, size))


@compiled
def _size_of_estimate(x, c, size):
    """Return the size of the estimate in `x.x` in its tolerances; `size` is that in the requested ones."""
    return max(size / c.relaxed, _unresolved(x, c) if size > 1.0 else 0.0)


@compiled
def _filter(x, c, h, values):
    """Compute (gamma/h M - f_y)^-1 gamma/h M times a vector."""
    e = equations_view(x.equations)
    for k in range(x.n):
        x.yp_stage[k] = c.gamma / h * values[k]
        x.b[k] = 0.0
    add_rate_terms(e, floats(state_view(x.state).values[e.residual_set]), x.yp_stage, x.b)
    solved_real(x)


@compiled
def _filtered(x, c, h):
    """Return the size of the filtered estimate, in its tolerances.

    The estimate of a vibration has a phase, at which the tested velocities may be zero by chance.  The filter turns the
    phase by arctan(h omega/gamma), and reduces a decaying motion.
    """
    _filter(x, c, h, x.error)
    return _size_of_estimate(x, c, error_norm_view(x.error_norm).repeats * size_in_tolerances(x, x.x))


@compiled
def _vibrating(x, c, h):
    """Return the size of the estimate in unknowns that vibrate fast for the step, in its tolerances.

    Two filters turn the phase of a fast vibration by nearly half a turn, (1 - h lambda/gamma)^-2, so that its unknowns change
    their signs. They only reduce a decaying motion. The error of a slow motion, which may exceed what is left of a fast one,
    also passes a third filter.
    """
    _filter(x, c, h, x.error)
    _filter(x, c, h, x.x)
    copied(x.d, x.x, x.n)
    _filter(x, c, h, x.d)
    for k in range(x.n):
        fast = x.d[k] - x.x[k]
        x.d[k] = x.error[k] if x.error[k] * x.d[k] < 0.0 and abs(x.x[k]) < abs(fast) else 0.0
    return size_in_tolerances(x, x.d) / c.relaxed


@compiled
def _unresolved_degree(x, c, k):
    """Return the coefficient of degree s of the polynomial of an unknown, in powers, if it does not converge; else 0.

    Of its coefficients of degrees s, s - 1 and s - 2 in Chebyshev polynomials, the first is then not small.
    """
    highest = 0.0
    second = 0.0
    third = 0.0
    for j in range(c.stages):
        difference = c.weights[j + 1] * x.z[j * x.n_all + k]
        highest += difference
        second += c.nodes[j] * difference
        third += c.nodes[j] * (c.nodes[j] - 1.0) * difference
    return highest if abs(highest) > x.converging * max(4.0 * abs(second), 16.0 * abs(third)) else 0.0


@compiled
def _unresolved(x, c):
    """Return the size of the estimate in `x.x` in unknowns whose polynomial does not converge, in tolerances.

    The step is long for a vibration, which the method damps.
    """
    total = 0.0
    for k in range(x.n):
        if _unresolved_degree(x, c, k) != 0.0:
            part = x.x[k] * x.weight[k]
            total += part * part
    return sqrt(total / x.n_tested)


@compiled
def _wandering(x, c):
    """Return the size of the last Chebyshev terms of polynomials that do not converge, in tolerances of the estimate.

    Where drives prescribe the motion, the end of a step has no error, but its stages may lie on another branch of the joints.
    """
    total = 0.0
    for k in range(x.n):
        part = _unresolved_degree(x, c, k) * x.weight[k]
        total += part * part
    return sqrt(total / x.n_tested) / (2.0 ** (2 * c.stages - 1) * max(1.0, c.relaxed))


@compiled
def _turned_apart(x, c, h):
    """Return the largest difference of the rate of an angle's polynomial from its angular velocity at a stage, times the step.

    Both agree but for the error of the polynomial. Stages of an angle that joints and drives prescribe may differ by full
    turns, or lie on another branch of the joints.
    """
    largest = 0.0
    for i in range(c.stages):
        for k in range(x.n_angles):
            rate = 0.0
            for j in range(c.stages):
                rate += c.derivative[i * c.stages + j] * x.z[j * x.n_all + x.angle[k]]
            turned = h * (x.y[x.spin[k]] + x.z[i * x.n_all + x.spin[k]])
            largest = max(largest, abs(rate - turned))
    return largest


@compiled
def _estimate_below(x, c, lower, t, h):
    """Return the size that the estimate of a method of fewer stages would have, in tolerances.

    Its stages are taken from the polynomial of the accepted step. In (gamma/h M - f_y)^-1, gamma is that of the step.
    """
    for k in range(x.n):
        x.yp_stage[k] = 0.0
    for i in range(lower.stages):
        for j in range(c.stages):
            factor = -lower.error[i] / h * basis(c, j, lower.nodes[i])
            z = shifted(x.past, j * x.n_all)
            for k in range(x.n):
                x.yp_stage[k] += factor * z[k]
    return _solved_defect(x, t, x.y_past) * c.gamma / lower.gamma


@compiled
def first_step(x):
    """Return a first step by the rates of the state, the longest of Hairer, Norsett, Wanner I, ch. II.4."""
    if x.first > 0.0:
        return x.first
    of_state = size_in_tolerances(x, x.y)
    of_rates = size_in_tolerances(x, x.yp)
    if min(of_state, of_rates) <= FIRST_STEP.small:
        return FIRST_STEP.short
    order = collocation_view(ints(x.methods[0])).stages
    return min(of_state / of_rates, (FIRST_STEP.part / of_rates) ** (1.0 / (1.0 + order)))


@compiled
def _bounded(x, factor):
    """Return the ratio of successive steps within its bounds; the first step, a trial, may be far too short."""
    largest = x.largest_factor if x.h_accepted > 0.0 else max(x.largest_factor, 1.0 / FIRST_STEP.part)
    return min(largest, max(x.least_factor, factor))


@compiled
def _cost_rate(x, c, h, error, longest):
    """Return the cost per time of steps of a method that has an error estimate in tolerances in a step of length h."""
    following = min(h * _bounded(x, CONTROL.safety * max(error, ROUNDING) ** (-1.0 / (c.stages + 1.0))), longest)
    return (c.setup_cost + x.iterations_taken * c.iteration_cost) / following


@compiled
def _choose_method(x, c, longest):
    """Choose the number of stages with the least cost per time.

    The error of two stages more is extrapolated as that of a geometric sequence.
    """
    x.since_change += 1
    if x.n_methods == 1 or x.since_change < x.stages_after:
        return
    x.since_change = 0
    number = x.method
    lower = collocation_view(ints(x.below[number]))
    error = x.error_size * c.relaxed
    below = max(_estimate_below(x, c, lower, x.t - x.h_past, x.h_past), 1e-300)
    cost = _cost_rate(x, c, x.h_past, x.error_size, longest)
    if number > 0 and _cost_rate(x, lower, x.h_past, below / lower.relaxed, longest) < x.gain * cost:
        x.method = number - 1
    elif number + 1 < x.n_methods and error < below:
        higher = collocation_view(ints(x.methods[number + 1]))
        if _cost_rate(x, higher, x.h_past, error * error / below / higher.relaxed, longest) < x.gain * cost:
            x.method = number + 1


@compiled
def _end_stays(x, c):
    """Return True if the end of the step is that with the first of the starts that `_removes_decay` has replaced."""
    last = shifted(x.z, (c.stages - 1) * x.n_all)
    for k in range(x.n):
        end = x.y[k] + last[k]
        if x.decaying == MOST_DECAYS:
            x.corrections[k] = end
        x.d[k] = end - x.corrections[k]
    return x.decaying == 0 or size_in_tolerances(x, x.d) <= MOST_MOVED


@compiled
def _removes_decay(x, c):
    """Replace the start of a first step by a state without the motions that decay within the step; True to repeat it.

    Efforts of the decaying motions belong to the start. The stages, and a polynomial through the start, would spread them
    over the step. The other efforts at the start are those of the polynomial of the stages alone.
    """
    if x.acting == 0 or x.decaying == 0:
        return False
    if x.decaying == MOST_DECAYS:
        copied(x.y_past, x.y, x.n_all)
    x.decaying -= 1
    if x.decaying == 0:
        return False
    copied(x.y_stage, x.y, x.n_all)
    copied(x.yp_stage, x.yp, x.n)
    for j in range(c.stages):
        factor = 1.0
        for i in range(c.stages):
            if i != j:
                factor *= c.nodes[i] / (c.nodes[i] - c.nodes[j])
        for k in range(x.n, x.n_all):
            x.y_stage[k] += factor * x.z[j * x.n_all + k]
    if closed(x, x.t, float("inf")) != CLOSED:
        return False
    copied(x.y, x.y_stage, x.n_all)
    return True


@compiled
def _accept(x, c, t, h):
    """Make the end of the step the state; keep its polynomial."""
    n = x.n
    copied(x.y_past, x.y, x.n_all)
    copied(x.past, x.z, c.stages * x.n_all)
    last = shifted(x.z, (c.stages - 1) * x.n_all)
    for k in range(x.n_all):
        x.y[k] += last[k]
    for k in range(n):
        x.yp[k] = 0.0
    for j in range(c.stages):
        factor = c.derivative[(c.stages - 1) * c.stages + j] / h
        z = shifted(x.z, j * x.n_all)
        for k in range(n):
            x.yp[k] += factor * z[k]
    x.t = t + h
    x.h_past = h
    x.method_past = x.method
    x.suffice = UNKNOWN
    x.steps += 1


@compiled
def _choose_unknowns(x):
    """Make the efforts of stiff forces unknowns if the step is long for these forces."""
    acting = x.n_efforts if x.h > output_correction_view(x.output_correction).long else 0
    x.newton = max(x.remainder, x.part) if acting > 0 else x.part
    x.decaying = MOST_DECAYS if x.h_past == 0.0 else 0
    if acting > 0 and (x.acting == 0 or x.h_past == 0.0):
        x.acting = acting
        store_efforts(x, x.t)
        for k in range(x.n, x.n_all):
            x.y_past[k] = x.y[k]
        for j in range(collocation_view(ints(x.methods[x.method_past])).stages):
            z = shifted(x.past, j * x.n_all)
            for k in range(x.n, x.n_all):
                z[k] = 0.0
        x.h_factored = 0.0
    x.acting = acting


@compiled
def _begun(x):
    """Prepare a step; return its length without regard to the stop time."""
    set_weights(x)
    if x.h == 0.0:
        x.h = first_step(x)
        set_weights(x)
    _choose_unknowns(x)
    x.rejected = 0
    x.failures = 0
    x.ahead = 0
    x.renewed = 1 if x.h_factored == 0.0 or x.rate_kept == 0 else 0
    return min(x.h, x.longest) if x.longest > 0.0 else x.h


@compiled
def _has_matrices(x, c, h):
    """Provide factored matrices for a step of length h; return False if one is singular."""
    if x.renewed == 0 and h == x.h_factored and c.stages == x.stages_factored:
        return True
    copied(x.y_stage, x.y, x.n)
    if x.ahead:
        last = shifted(x.z, (c.stages - 1) * x.n_all)
        for k in range(x.n):
            x.y_stage[k] += last[k]
    if not factored(x, c, h, x.t, x.y_stage, x.yp, x.renewed):
        x.renewed = 1
        return False
    if x.renewed:
        x.current = 1
    x.renewed = 0
    return True


@compiled
def _after_failed_iteration(x, outcome, h):
    """Return the length of the next attempt: the same with a new matrix, if the last one was old, or a shorter one.

    The matrix at the beginning of a step that ends beyond a kink may diverge; that of the predicted end then converges. A
    first step may begin on a kink, where the matrix is that of either side, and its iteration may alternate.
    """
    x.newton_failures += 1
    if not x.current:
        x.renewed = 1
        return h * x.suggested if outcome == SLOW else h
    if x.has_kinks and (outcome == DIVERGED or x.ahead):
        x.renewed = 1
        x.ahead = 1 - x.ahead
        if x.ahead:
            return h
    x.step_failures += 1
    x.rejected = 1
    return h * x.suggested


@compiled
def _error(x, c, h, untested):
    """Return the error of the step in tolerances.

    After rejected steps, a failed estimate is repeated with f at the corrected state, without the motions that the step damps. In
    a first step, as on a stiff pad after an impact, these may be vibrations, which do not decay: it resolves them. The estimate
    of an untested step, which may be long for a vibration that earlier ones have not tested, is filtered too.
    """
    error = _estimate(x, c, x.t, h, x.y)
    x.damped = 0
    if error >= 1.0 and (untested or x.rejected) and _vibrating(x, c, h) < 1.0:
        copied(x.y_stage, x.error, x.n)
        add_efforts(x, x.y_stage, x.misfit)
        for k in range(x.n_all):
            x.y_stage[k] += x.y[k]
        error = _estimate(x, c, x.t, h, x.y_stage)
        x.damped = 1
    if untested and error < 1.0:
        error = max(error, _filtered(x, c, h))
    wandering = _wandering(x, c) if x.acting == 0 else 0.0  # efforts of decaying motions are removed or closed
    wandering = max(wandering, _turned_apart(x, c, h) / SEARCH.turned)
    return max(error, wandering) if wandering > 1.0 else error


@compiled
def _growth(x, c, error):
    """Return the ratio of the next step to this one by its error."""
    most = most_iterations(c)
    margin = min(CONTROL.safety, CONTROL.safety * (1.0 + 2.0 * most) / (x.iterations_taken + 2.0 * most))
    return _bounded(x, margin * error ** (-1.0 / (c.stages + 1.0)))


@compiled
def _predicted_growth(x, c, h, error):
    """Return the same by the errors of two steps (Gustafsson; Hairer, Wanner II, eq. IV.8.25)."""
    growth = _growth(x, c, error)
    if x.h_accepted == 0.0:
        return growth
    predicted = CONTROL.safety * h / x.h_accepted * (x.last_error / (error * error)) ** (1.0 / (c.stages + 1.0))
    return min(growth, _bounded(x, predicted))


@compiled
def _choose_next(x, c, h, planned, at_stop):
    """Choose the next step; it stays if that saves new factors, and is not shortened by a stop time."""
    following = h * _predicted_growth(x, c, h, x.error_size)
    if x.contraction > 0.0:  # the rate of convergence is proportional to the step
        following = min(following, h * x.slowest / x.contraction)
    if x.rejected:
        following = min(following, h)
    first = x.h_accepted == 0.0
    x.h_accepted = h
    x.last_error = max(LEAST_ERROR, x.error_size)
    x.rate_kept = 1 if x.contraction <= c.keep else 0
    if x.rate_kept and h <= following <= x.keep_high * h:
        following = h
    x.h = max(following, planned) if at_stop and not (first or x.rejected) else following


@compiled
def step(x):
    """Take one step that passes the error test, not beyond the stop time.

    Returns 0 or a negative flag of IDA.
    """
    h = _begun(x)
    first = x.h_past == 0.0
    c = collocation_view(ints(x.methods[x.method]))
    # a vibration of as many radians per stage has been tested
    tested = x.h_past * c.stages / collocation_view(ints(x.methods[x.method_past])).stages
    repeated = 0.0
    while True:
        if repeated > 0.0 and h != repeated:  # a shorter step may resolve what decays within this one
            copied(x.y, x.y_past, x.n_all)
            x.decaying = MOST_DECAYS
            repeated = 0.0
        at_stop = x.stops and x.t + (1.0 if first else STRETCHED) * h >= x.stop
        if at_stop:
            h = x.stop - x.t
        untested = h > x.keep_high * tested
        if not h > SMALLEST * abs(x.t):
            return ERROR_TEST_FAILED if x.rejected else NO_CONVERGENCE
        x.failures += 1
        if not x.ahead or x.h_past > 0.0:  # a first step goes on from the iterates that failed
            extrapolated(x, c, h)
        if not _has_matrices(x, c, h):
            h *= x.after_failure
            continue
        outcome = iterated(x, c, x.t, h)
        if outcome != CONVERGED:
            h = _after_failed_iteration(x, outcome, h)
            continue
        error = _error(x, c, h, untested)
        if not isfinite(error):
            h *= x.after_failure
            continue
        if error < 1.0:
            if x.acting == 0 or (close_end(x, c, stage_time(x, x.t + h), h) and _end_stays(x, c)):
                if not _removes_decay(x, c):
                    break
                repeated = h
                continue
            h = _after_failed_iteration(x, DIVERGED, h)
            continue
        x.rejected = 1
        x.error_failures += 1
        shorter = h * (x.least_factor if first and x.failures == 1 else _growth(x, c, error))
        h = max(shorter, tested) if untested else shorter
        x.renewed = 1 if not x.current and x.rate_kept == 0 else 0
    x.error_size = error
    _choose_next(x, c, h, x.h, at_stop)
    _accept(x, c, x.t, h)
    if at_stop:
        x.t = x.stop
    x.current = 0
    _choose_method(x, c, h if at_stop else float("inf"))
    return 0
