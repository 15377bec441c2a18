"""IDA's callbacks with their C signatures, and the loop over its steps without Python."""

from typing import Final

from stiffmbs.compile.machine.native.access import address_of, compiled, equations_view, floats, shifted, state_view
from stiffmbs.compile.machine.native.calls import call_int, int32
from stiffmbs.compile.machine.native.evaluate import SWITCH, add_entries, add_products, evaluate, load
from stiffmbs.compile.machine.native.simd import plus_product, quad, spread, sum_of
from stiffmbs.compile.machine.native.statuses import OK, ONE_STEP, RECOVERABLE, ROOT_RETURN, STOP_RETURN
from stiffmbs.solve.events.native.bounds import bounded_by_feature, departed, event_search_view, repeats
from stiffmbs.solve.events.native.layouts import EVENT, NO_EVENT
from stiffmbs.solve.events.native.parameters import EPSILON, NEXT_STEP, SEARCH
from stiffmbs.solve.events.native.step_bound import STRETCHED, longest_step, next_row, step_bound_view, whole_steps_view
from stiffmbs.solve.events.native.values import unwrapped
from stiffmbs.solve.explicit.native.parameters import LOCATION
from stiffmbs.solve.ida.native.error_norm import error_norm_view
from stiffmbs.solve.ida.native.ida_memory import array_of, native_ida_view
from stiffmbs.solve.ida.native.iteration import MADE, iteration_view
from stiffmbs.solve.ida.native.layouts import STEP_WIDTH
from stiffmbs.solve.ida.native.output_correction import (
    corrected,
    corrected_at_event,
    count_failure,
    output_correction_view,
)
from stiffmbs.solve.ida.native.parameters import LOOP
from stiffmbs.solve.ida.native.start import follow_stiffness

STALLED: Final = -101
"""Flag for steps that have shrunk to the rounding of the time; none of ida.h."""


@compiled
def _finite(values, count):
    total, whole = spread(0.0), count - count % 4
    for k in range(0, whole, 4):
        total = plus_product(total, spread(0.0), quad(values, k))
    left = sum_of(total)
    for k in range(whole, count):
        left += 0.0 * values[k]
    return left == 0.0


def residual(t, yy, yp, rr, user_data):
    """Compute the residual r(t, y, y') (IDAResFn)."""
    c = native_ida_view(user_data)
    s = state_view(c.state)
    e = equations_view(c.equations)
    y, rates, r = array_of(c, yy), array_of(c, yp), array_of(c, rr)
    load(s, e, y, rates)
    add_products(e, evaluate(s, e.residual_set, t), y, rates, r)
    return int32(OK if _finite(r, e.n) else RECOVERABLE)


def jacobian(t, cj, yy, yp, rr, matrix, user_data, work1, work2, work3):
    """Compute the iteration matrix dr/dy + cj dr/dy' (IDALsJacFn)."""
    c = native_ida_view(user_data)
    s = state_view(c.state)
    e = equations_view(c.equations)
    load(s, e, array_of(c, yy), array_of(c, yp))
    a = floats(c.matrix)
    output_correction_view(c.output_correction).current = cj
    output_correction_view(c.output_correction).renewed = 1
    iteration_view(c.iteration).age = MADE
    add_entries(e, evaluate(s, e.matrix_set, t), cj, a)
    return int32(OK if _finite(a, e.n_slots) else RECOVERABLE)


@compiled
def _longest_to_see(c, bound, t):
    """Return the longest step from t that resolves inputs and periodic or just entered laws."""
    longest = longest_step(bound, t) if bound.n > 0 else float("inf")
    if c.look_at_start:
        w = event_search_view(c.watch)
        longest = min(longest, w.longest)
        if t < w.target:
            longest = min(longest, w.target - t)
        if t < w.passed:
            longest = min(longest, w.passage if c.size > 0.0 else w.first)
            if c.repeat:
                longest = min(longest, w.passed - t)
    return max(longest, LOOP.most_tiny**2 * EPSILON * abs(t))


@compiled
def _see_inputs(c, stop):
    """Set IDA's stop time to resolve a feature of an input or law; IDA continues from there with its history."""
    bound = step_bound_view(c.step_bound)
    if bound.n > 0 or c.look_at_start:
        t = c.internal
        longest = _longest_to_see(c, bound, t)
        if c.look_at_start and event_search_view(c.watch).n_turns > 0:
            w = event_search_view(c.watch)
            w.narrow += bounded_by_feature(w)
            shared = repeats(w, t, t < w.passed)
            if shared > 1.0 and not c.repeat:
                # changes of the step keep BDF at order 1 where a law rises, with errors of one sign in all steps
                shared *= NEXT_STEP.passage_steps
            error_norm_view(c.error_norm).repeats = shared
        if longest == float("inf") and c.stopping == stop:
            return
        call_int(c.next_step_of, (c.memory, address_of(c.next_size)))
        first = c.size == 0.0
        cut = (first or c.next_size > longest) and t + STRETCHED * longest < stop
        if cut or c.stopping != stop:
            c.stopping = t + longest if cut else stop
            call_int(c.stop_at, (c.memory, c.stopping))


@compiled
def _toward(c, stop):
    """Return the time whose distance is a thousand times IDA's first step: a part of the way to the stop.

    It does not depend on output times, so that these change no step. Later steps go towards the stop itself: IDA returns
    a step that ends there as the stop only if it was to go so far.
    """
    way = LOOP.first_part * (stop - c.returned)
    return c.returned + way if c.size == 0.0 and way > LOOP.most_tiny * EPSILON * abs(stop) else stop


@compiled
def _attempt(c, stop):
    """Take one step, and return IDA's flag."""
    _see_inputs(c, stop)
    flag = call_int(c.solve, (c.memory, _toward(c, stop), address_of(c.returned), c.y, c.yp, int32(ONE_STEP)))
    if flag == STOP_RETURN and c.returned < stop:
        flag = int32(OK)
    call_int(c.time_of, (c.memory, address_of(c.internal)))
    call_int(c.step_of, (c.memory, address_of(c.size)))
    return flag


@compiled
def _seen(c, ida, flag):
    """Return the event within the last step, if there is one."""
    return call_int(c.look_within, (ida,)) if flag >= 0 and c.look_within else int32(NO_EVENT)


@compiled
def stepped(c, ida, stop):
    """Take one step; note its end, order and size in the history, and return IDA's flag.

    A one-step method may repeat the step up to an event or a passed law.
    """
    before = c.internal
    begun = c.returned
    if c.look_at_start:
        call_int(c.look_at_start, (_toward(c, stop), stop, ida))
    flag = _attempt(c, stop)
    seen = _seen(c, ida, flag)
    for _ in range(LOCATION.most_retaken):
        event = c.returned
        h = _repeated(c, begun, seen)
        if h == 0.0:
            break
        flag = _attempt(c, stop)
        seen = _seen(c, ida, flag)
        if seen == NO_EVENT:
            event_search_view(c.watch).target = event + (event - begun - h)
    if c.internal != before and flag >= 0:
        call_int(c.order_of, (c.memory, address_of(c.order)))
        row = shifted(c.history, STEP_WIDTH * c.recorded)
        row[0], row[1], row[2] = c.internal, float(c.order), c.size
        c.recorded += 1
        _sample(c)
    if flag >= 0 and _stalled(c):
        return STALLED
    if seen != NO_EVENT:
        flag = int32(ROOT_RETURN)
    if flag == ROOT_RETURN and _interpolates_stiffly(c):
        corrected_at_event(c.output_correction, c.state, c.equations, _before_event(c, begun), array_of(c, c.y))
    if flag >= 0:
        _keep_whole(c, begun)
    if flag >= 0 and c.trace:
        _keep_step(c, begun)
    return flag


@compiled
def _repeated(c, begun, seen):
    """Make a one-step method repeat its step with another length; return that, or 0 if the step stays.

    A step that has passed an interval of a law ends in it: no restart is needed. One whose error estimate is not valid
    over a jump ends shortly before the event, and the next one as shortly after it.
    """
    if seen == NO_EVENT or not c.repeat or (seen == EVENT and call_int(c.resolves, (c.memory,))):
        return 0.0
    ahead = c.returned - begun
    h = ahead / STRETCHED if seen == EVENT else (1.0 + SEARCH.difference) * ahead
    shortest = LOOP.most_tiny**2 * EPSILON * abs(begun)
    if not shortest < h < (1.0 - SEARCH.difference) * c.size:
        return 0.0
    call_int(c.repeat, (c.memory, begun, h))
    c.returned = begun
    c.internal = begun
    return h


@compiled
def _before_event(c, begun):
    """Return a time just before the event at the returned state, at which all laws are those at the start of the step."""
    w = event_search_view(c.watch)
    s = state_view(c.state)
    ahead = SEARCH.least_difference * c.size
    changed = 1
    while changed > 0 and SEARCH.longer * ahead < c.returned - begun:
        ahead *= SEARCH.longer
        call_int(c.interpolate, (c.memory, c.returned - ahead, int32(0), c.at_output))
        load(s, equations_view(c.equations), c.output, array_of(c, c.yp))
        values = unwrapped(w, evaluate(s, SWITCH, c.returned - ahead))
        changed = 0
        for k in range(w.n):
            changed += w.found[k] != 0 and departed(w, k, values[k])
    return c.returned - ahead


@compiled
def _interpolates_stiffly(c):
    """Return True if interpolation in the last step does not keep the balance of stiff forces."""
    follow_stiffness(c)
    b = output_correction_view(c.output_correction)
    return b.interpolate != 0 and c.size > b.long


@compiled
def _corrected_at(c, t):
    """Correct the state at a time of the last step in the memory of the correction; return False if it is to stay.

    At the end of a step, Newton's remainder is a force in stiff elements. That at an event has been corrected already.
    """
    if (t == c.returned and t != c.internal) or not _interpolates_stiffly(c):
        return False
    return corrected(c.output_correction, c.state, c.equations, t, c.size)


@compiled
def _keep_row(c, t, y, yp):
    n = equations_view(c.equations).n
    row = floats(c.trace + 8 * (2 + 2 * n) * c.traced)
    row[0] = t
    row[1] = float(c.order)
    for k in range(n):
        row[2 + k] = y[k]
        row[2 + n + k] = yp[k]
    c.traced += 1


@compiled
def _closed_at_end(c):
    """Correct the state at the end of the step in the memory for stored steps; return False if it is to stay."""
    b = output_correction_view(c.output_correction)
    own = output_correction_view(c.closing)
    if own.interpolate == 0:
        return False
    own.current = b.current
    own.enough = b.enough
    own.balanced = b.balanced
    return corrected(c.closing, c.state, c.equations, c.returned, c.size)


@compiled
def _keep_step(c, begun):
    """Store the result of a step, and states within it, for the integration of variational equations."""
    places = floats(c.places)
    for k in range(c.n_places):
        t = begun + places[k] * (c.returned - begun)
        call_int(c.interpolate, (c.memory, t, int32(0), c.at_output))
        _keep_row(c, t, c.output, c.output)
    if c.returned == c.internal and _interpolates_stiffly(c) and _closed_at_end(c):
        b = output_correction_view(c.closing)
        _keep_row(c, c.returned, b.y, b.yp)
    else:
        _keep_row(c, c.returned, array_of(c, c.y), array_of(c, c.yp))


@compiled
def _report(c, values, row):
    for k in range(c.n_reported):
        row[k] = values[c.reported[k]]


@compiled
def _keep_whole(c, begun):
    """Store states within the last step if it is to be checked after the run."""
    w = whole_steps_view(c.whole_steps)
    h = c.returned - begun
    if w.count >= w.room:
        return
    row = next_row(w, begun, c.returned)
    for node in range(w.n_nodes):
        if call_int(c.interpolate, (c.memory, begun + w.node[node] * h, int32(0), c.at_output)) < 0:
            return
        _report(c, c.output, shifted(row, node * w.width))
    w.count += 1


@compiled
def _sample(c):
    c.since_sample += 1
    if c.since_sample == LOOP.steps_apart:
        k = c.next_sample
        row = shifted(c.samples, k * (c.n_reported + 1))
        row[0] = c.returned
        _report(c, array_of(c, c.y), shifted(row, 1))
        c.since_sample = 0
        c.next_sample = k + 1 if k + 1 < LOOP.samples else 0


@compiled
def _stalled(c):
    c.tiny = c.tiny + 1 if abs(c.size) < LOOP.most_tiny * EPSILON * abs(c.internal) else 0
    return c.tiny >= LOOP.most_tiny


@compiled
def _report_at(c, t, row):
    """Report the solution at a time within the last step."""
    if _corrected_at(c, t):
        _report(c, output_correction_view(c.output_correction).y, row)
        return int32(OK)
    if t == c.returned:
        _report(c, array_of(c, c.y), row)
        return int32(OK)
    flag = call_int(c.interpolate, (c.memory, t, int32(0), c.at_output))
    _report(c, c.output, row)
    if flag == RECOVERABLE:
        count_failure(output_correction_view(c.output_correction), t)
        return int32(OK)
    return flag


@compiled
def _served(c, times, count, y_out):
    """Report at the output times up to the returned time."""
    flag = int32(OK)
    while c.served < count and times[c.served] <= c.returned:
        k = c.served
        flag = _report_at(c, times[k], shifted(y_out, k * c.n_reported))
        if flag < 0:
            break
        c.served = k + 1
    return flag


@compiled
def advanced(c, ida, count, times, stop, most, y_out):
    """Take at most `most` steps towards `stop`, and report at output times; return IDA's last flag."""
    c.stopping = stop
    flag = _served(c, times, count, y_out)
    for _ in range(min(most, LOOP.most_steps)):
        if flag != OK:
            break
        flag = stepped(c, ida, stop)
        if flag >= 0:
            outcome = _served(c, times, count, y_out)
            flag = outcome if outcome < 0 else flag
    return int32(flag)


@compiled
def clear_call(c):
    """Reset the counters of the call."""
    c.served = 0
    c.recorded = 0
    c.traced = 0


def advance(count, times, stop, most, y_out, ida):
    """Call `advanced` from Python."""
    c = native_ida_view(ida)
    clear_call(c)
    return advanced(c, ida, count, times, stop, most, y_out)


def steps(most, stop, t_out, y_out, ida):
    """Take at most `most` steps towards `stop`, and report each; return IDA's last flag."""
    c = native_ida_view(ida)
    c.stopping = stop
    clear_call(c)
    flag = int32(OK)
    while flag == OK and c.served < min(most, LOOP.most_steps):
        flag = stepped(c, ida, stop)
        if flag >= 0:
            k = c.served
            t_out[k] = c.returned
            _report_at(c, c.returned, shifted(y_out, k * c.n_reported))
            c.served = k + 1
    return int32(flag)
