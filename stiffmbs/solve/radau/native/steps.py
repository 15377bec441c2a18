"""Steps of Radau methods with error control; predictive control of Gustafsson."""

from math import isfinite
from typing import Final

from stiffmbs.compile.machine.native.access import compiled, ints, shifted
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.solve.error_control.native.parameters import EXCLUDED
from stiffmbs.solve.events.native.parameters import INDISTINCT
from stiffmbs.solve.events.native.step_bound import STRETCHED, distance_to_bend, step_bound_view
from stiffmbs.solve.explicit.native.parameters import CONTROL, FIRST_STEP
from stiffmbs.solve.ida.native.output_correction import output_correction_view
from stiffmbs.solve.radau.native.between_steps import CLOSED, MOST_MOVED, UNKNOWN, close_end, closed
from stiffmbs.solve.radau.native.error_estimate import LEAST_ESTIMATE, error_of_step, estimate_below
from stiffmbs.solve.radau.native.memory import collocation_view
from stiffmbs.solve.radau.native.newton import (
    CONVERGED,
    DIVERGED,
    SLOW,
    extrapolated,
    factored,
    iterated,
    most_iterations,
    predicted,
    size_in_tolerances,
    stage_time,
    store_efforts,
)

ERROR_TEST_FAILED: Final = -3
NO_CONVERGENCE: Final = -4
"""Flags of IDA: IDA_ERR_FAIL, IDA_CONV_FAIL."""
SMALLEST = 4 * INDISTINCT
"""Least step, relative to the time."""
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
def first_step(x):
    """Return a first step by the rates of the state, the longest of Hairer, Norsett, Wanner I, ch. II.4.

    A state below its tolerance counts as one tolerance: that of a motion that has just begun is rounding.
    """
    if x.first > 0.0:
        return x.first
    of_state = size_in_tolerances(x, x.y)
    of_rates = size_in_tolerances(x, x.yp)
    if min(of_state, of_rates) <= FIRST_STEP.small:
        return FIRST_STEP.short
    order = collocation_view(ints(x.methods[0])).stages
    return min(max(of_state, 1.0) / of_rates, (FIRST_STEP.part / of_rates) ** (1.0 / (1.0 + order)))


@compiled
def _bounded(x, factor):
    """Return the ratio of successive steps within its bounds; the first step, a trial, may be far too short."""
    largest = x.largest_factor if x.h_accepted > 0.0 else max(x.largest_factor, 1.0 / FIRST_STEP.part)
    return min(largest, max(x.least_factor, factor))


@compiled
def _cost_rate(x, c, h, error, longest):
    """Return the cost per time of steps of a method that has an error estimate in tolerances in a step of length h."""
    following = min(h * _bounded(x, CONTROL.safety * max(error, LEAST_ESTIMATE) ** (-1.0 / (c.stages + 1.0))), longest)
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
    below = max(estimate_below(x, c, lower, x.t - x.h_past, x.h_past), 1e-300)
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
    x.attempts = 0
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
        bend = distance_to_bend(step_bound_view(x.step_bound), x.t, h, SMALLEST * abs(x.t))
        at_bend = bend < (1.0 if at_stop else STRETCHED) * h
        if at_bend:
            h = bend
            at_stop = False
        untested = h > x.keep_high * tested
        if not h > SMALLEST * abs(x.t):
            return ERROR_TEST_FAILED if x.rejected else NO_CONVERGENCE
        x.attempts += 1
        if not x.ahead or predicted(x, h):  # without a prediction, a step goes on from the iterates that failed
            extrapolated(x, c, h)
        if not _has_matrices(x, c, h):
            x.step_failures += 1
            h *= x.after_failure
            continue
        outcome = iterated(x, c, x.t, h)
        if outcome != CONVERGED:
            h = _after_failed_iteration(x, outcome, h)
            continue
        error = error_of_step(x, c, h, untested)
        if not isfinite(error):
            x.step_failures += 1
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
        shorter = h * (x.least_factor if first and x.attempts == 1 else _growth(x, c, error))
        h = max(shorter, tested) if untested else shorter
        x.renewed = 1 if not x.current and x.rate_kept == 0 else 0
    x.error_size = error
    _choose_next(x, c, h, x.h, at_stop or at_bend)
    _accept(x, c, x.t, h)
    if at_stop:
        x.t = x.stop
    x.current = 0
    _choose_method(x, c, h if at_stop or at_bend else float("inf"))
    return 0
