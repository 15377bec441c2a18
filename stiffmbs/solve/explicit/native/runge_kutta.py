"""Explicit Runge-Kutta steps with error control and projection."""

from math import isfinite

from stiffmbs.compile.machine.native.access import compiled, shifted, state_view
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.compile.machine.native.statuses import (
    AT_END,
    AT_EVENT,
    NOT_FINITE,
    PAUSED,
    SINGULAR,
    STEP_TOO_SMALL,
    STIFF,
    UNSTABLE,
)
from stiffmbs.dynamics.native.views import dynamics_view
from stiffmbs.solve.events.native.bounds import event_search_view
from stiffmbs.solve.events.native.layouts import EVENT, NO_EVENT, RETRIED
from stiffmbs.solve.events.native.step_bound import STRETCHED, longest_step, next_row, step_bound_view, whole_steps_view
from stiffmbs.solve.explicit.native.attempt import across, arrive, attempt, distance_of_end, retaken, uncertain_end
from stiffmbs.solve.explicit.native.error_estimate import trusted_error
from stiffmbs.solve.explicit.native.explicit_events import begin_search, ended_at_event
from stiffmbs.solve.explicit.native.interpolant import interpolated, prepare, store_rows, store_step
from stiffmbs.solve.explicit.native.parameters import CONTROL, ENDS
from stiffmbs.solve.explicit.native.stages import explicit_view, scheme_view
from stiffmbs.solve.explicit.native.start import first_step, start_steps


@compiled
def _watch_stiffness(x, c, h):
    """Count steps limited by stability, or with h |lambda| beyond its limit by two stages at the step's end."""
    if 0.0 < x.stable < x.h:
        x.stiff_steps += 1
        return
    k_end = shifted(x.k, c.stages * x.n)
    k_last = shifted(x.k, (c.stages - 1) * x.n)
    rate = 0.0
    move = 0.0
    for i in range(x.n):
        rate += (k_end[i] - k_last[i]) ** 2
        move += (x.y[i] - x.y_stage[i]) ** 2
    limit = c.stability**2 * move
    if h * h * rate > limit and move > 0.0:
        x.stiff_steps += 1
        x.far_beyond += 1 if h * h * rate > CONTROL.far_beyond**2 * limit else 0


@compiled
def _is_hopeless(x, end):
    """Return True if stability limits the steps and too many remain."""
    return x.stiff_steps > CONTROL.stiff_part * x.steps and (end - x.t) * x.n > CONTROL.too_many_steps * x.h


@compiled
def _depart(x, c):
    """Make the end of the last step the start of the next."""
    x.t_before = x.t
    copied(x.y_before, x.y, x.n)
    copied(x.k, shifted(x.k, c.stages * x.n), x.n)
    x.dense_ready = 0


@compiled
def _factor(x, c, error):
    """Return the growth factor of the step (PI control; Hairer, Wanner II, ch. IV.2)."""
    if error == 0.0:
        return CONTROL.largest_factor
    exponent = c.exponent - 0.75 * c.memory
    return CONTROL.safety * error**-exponent * max(x.last_error, CONTROL.smallest_error) ** c.memory


@compiled
def _step(x, c, s, m, end):
    """Take one step that passes the error test; 0, or a negative status with the state unchanged.

    `span` is the length of the step, or that of the last attempt in case of a negative status.
    """
    _depart(x, c)
    distance = x.distance_of_end
    crossing = across(x, distance)
    x.distance = distance
    x.span = 0.0
    t = x.t
    h = min(x.h, x.longest)
    if x.stable > 0.0:
        h = min(h, x.stable)
    bound = step_bound_view(x.step_bound)
    if bound.n > 0:
        h = min(h, longest_step(bound, t))
    most = CONTROL.largest_factor
    moved = 0
    while True:
        if t + STRETCHED * h >= end:
            h = end - t
        if t + h == t:
            copied(x.y, x.y_before, x.n)
            return STEP_TOO_SMALL
        status = attempt(x, c, s, m, h)
        x.span = h
        error = x.repeats * trusted_error(x, c, h) if status == 0 else 0.0
        if not isfinite(error):
            status = NOT_FINITE
        if status == 0 and error <= 1.0:
            t_new = end if h == end - t else t + h
            status = arrive(x, c, s, m, t_new)
            x.distance_of_end = distance_of_end(x)
            uncertain = status == 0 and uncertain_end(x, c, h, x.distance_of_end)
            turns = status == 0 and x.distance_of_end < ENDS.turning
            if (turns or (uncertain and not x.uncertain)) and t_new < end and moved < 2:
                h = h / ENDS.shorter if moved else h * ENDS.shorter  # back to the whole step if that does not help
                moved += 1
                continue
            if turns:
                copied(x.y, x.y_before, x.n)
                return SINGULAR
            if status == 0:
                x.uncertain = 1 if uncertain or moved else 0  # two in succession would approach a locking pose
                x.t = t_new
                x.span = t_new - t
                x.h = h * min(most, max(CONTROL.least_factor, _factor(x, c, error)))
                x.last_error = error
                _watch_stiffness(x, c, h)
                return 0
        x.rejected += 1
        most = 1.0
        shorter = CONTROL.least_factor if status < 0 else max(CONTROL.least_factor, CONTROL.safety * error**-c.exponent)
        if crossing < h:
            h, crossing = crossing, float("inf")
        else:
            h *= shorter
        if h < x.shortest:
            copied(x.y, x.y_before, x.n)
            return status if status < 0 else STEP_TOO_SMALL


@compiled
def _keep_whole(x, c, s, m):
    """Store states within the last step if it is to be checked after the run."""
    w = whole_steps_view(x.whole_steps)
    if w.count >= w.room:
        return
    if x.dense_ready or prepare(x, c, s, m) == 0:
        row = next_row(w, x.t_before, x.t_before + x.span)
        for node in range(w.n_nodes):
            interpolated(x, c, w.node[node], shifted(row, node * w.width))
        w.count += 1


def advance(end, steps, held, own_steps, explicit):
    """Integrate towards `end` by at most `steps` steps, until stability has limited `held` of them or memory is full.

    Rows of all output times so far are stored unless memory is full.

    Returns AT_END, AT_EVENT (a force has changed its law), PAUSED (call again), or a negative status.  After UNSTABLE
    (a step far beyond the stability limit), call again with that limit.
    """
    x = explicit_view(explicit)
    c = scheme_view(x.scheme)
    m = dynamics_view(x.dynamics)
    s = state_view(m.state)
    searches = event_search_view(x.watch).n > 0
    if not x.started:
        start_steps(x, c, s, m)
        x.h = first_step(x, c, s, m, end)
        if searches:
            begin_search(x, s)
    held += x.stiff_steps
    stored = store_rows(x, c, s, m)
    for _ in range(steps):
        if stored < 1:
            return stored
        if x.stiff_steps >= held or (own_steps and x.rows >= x.capacity):
            return PAUSED
        if x.t >= end:
            return AT_END
        if x.at_event:
            return AT_EVENT
        far_beyond = x.far_beyond
        status = _step(x, c, s, m, end)
        # a step across a jump has an error of its length times the jump: no accepted step may be short enough to reach it
        across_jump = searches and status == STEP_TOO_SMALL and x.span > 0.0
        if across_jump:
            status = retaken(x, c, s, m, x.span)
        if searches and status >= 0:
            status = ended_at_event(x, c, s, m)
        if across_jump and status <= NO_EVENT:
            copied(x.y, x.y_before, x.n)
            x.t = x.t_before
            status = status if status < 0 else STEP_TOO_SMALL
        if status < 0:
            return status
        if status == RETRIED:
            continue
        x.at_event = status == EVENT
        x.ends[x.steps % x.capacity] = x.t
        x.steps += 1
        _keep_whole(x, c, s, m)
        if own_steps:
            store_step(x)
        stored = store_rows(x, c, s, m)
        if x.stable == 0.0 and x.far_beyond > far_beyond:
            return UNSTABLE
        if x.steps >= CONTROL.enough_steps and _is_hopeless(x, end):
            return STIFF
    return PAUSED
