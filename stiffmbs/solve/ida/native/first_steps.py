"""First steps after a restart of IDA: they resolve a passage, the short time until the motion leaves a law.

The error estimate of a step of order 1 compares the forces at its ends.  If these agree, as before and after a short
interval of another law, the step is accepted without the forces in between.  A one-step method begins with long steps,
whose stages may all be after such an interval.
"""

from stiffmbs.compile.machine.native.access import address_of, compiled, equations_view, shifted
from stiffmbs.compile.machine.native.calls import call_int
from stiffmbs.compile.machine.native.evaluate import add_products, evaluate, load
from stiffmbs.compile.machine.native.orientation import add_rates
from stiffmbs.solve.events.native.bounds import interval
from stiffmbs.solve.events.native.parameters import NEXT_STEP, SEARCH
from stiffmbs.solve.events.native.values import switches
from stiffmbs.solve.ida.native.ida_memory import array_of


@compiled
def bound_first_steps(c, w, s, toward, stop):
    """Limit steps until the motion extrapolated by initial accelerations leaves a law.

    The first step is limited if the forces of the passage change an unknown by more than its tolerance.  Every step of
    a passage is limited for periodic laws, because smaller changes add up over their periods.  The same holds at the
    beginning of a run, where closed contacts open and close by rounding.
    """
    if c.repeat:
        call_int(c.next_step_of, (c.memory, address_of(c.next_size)))
    w.passage, w.first = float("inf"), float("inf")
    of_every_law = w.n_turns > 0 or c.repeat
    ahead = _passage(c, w, s, toward, stop, w.n if of_every_law else w.n_event_functions)
    each_step = ahead > 0.0 and (w.n_turns > 0 or not w.under_way)
    if ahead == 0.0 and not of_every_law:
        ahead = _passage(c, w, s, toward, stop, w.n)
    if ahead > 0.0:
        w.passed = c.returned + ahead
        if each_step:  # stages of a step resolve a part of the passage each
            w.passage = NEXT_STEP.inside * ahead if c.repeat else ahead / NEXT_STEP.passage_steps
            w.first = NEXT_STEP.first_part * w.passage
        elif _matters(c, w, s, ahead):
            w.first = NEXT_STEP.inside * ahead
    if w.under_way == 0 and c.returned > w.begins + NEXT_STEP.lifted * w.duration:
        w.under_way = 1


@compiled
def _passage(c, w, s, toward, stop, count):
    """Return the time after which the motion leaves a law of the first `count` functions; 0 if it does not soon."""
    ahead = SEARCH.least_difference * (toward - c.returned)
    most = stop - c.returned if w.n_turns > 0 else NEXT_STEP.soon * (toward - c.returned)
    if c.repeat:
        most = min(max(most, c.next_size), stop - c.returned)
    while ahead < most and not _another_side(c, w, s, ahead, count):
        ahead *= 2.0
    if not ahead < most:
        return 0.0
    low = 0.5 * ahead
    while ahead - low > NEXT_STEP.first_part / NEXT_STEP.passage_steps * ahead:  # the first step
        middle = 0.5 * (low + ahead)
        if _another_side(c, w, s, middle, count):
            ahead = middle
        else:
            low = middle
    return ahead


@compiled
def _another_side(c, w, s, ahead, count):
    """Return True if one of the first `count` functions changes its sign in a time, or its law the interval."""
    go_ahead(c, s, ahead)
    values = switches(w, s, c.returned + ahead)
    others = 0
    for k in range(count):
        others += interval(w, k, values[k]) != interval(w, k, w.value_before[k])
    return others > 0


@compiled
def _matters(c, w, s, ahead):
    """Return True if the forces within a passage change an unknown by more than its tolerance.

    The residual with the initial rates is the change of force; the mass is the coefficient of an unknown's own rate.
    """
    e, y, rates = equations_view(c.equations), array_of(c, c.y), array_of(c, c.yp)
    inside = c.returned + NEXT_STEP.inside * ahead
    go_ahead(c, s, NEXT_STEP.inside * ahead)
    values, residual, own = evaluate(s, e.residual_set, inside), c.residual, shifted(c.residual, e.n)
    add_products(e, values, c.probe, rates, residual)
    for i in range(e.n):
        own[i] = 0.0
    for k in range(e.n_with_y, e.n_with_yp):
        if e.r_row[k] == e.r_operand[k]:
            own[e.r_row[k]] += e.r_factor[k] * values[e.r_source[k]]
    largest = 0.0
    for i in range(e.n):
        change = ahead * abs(residual[i]) / (c.rtol * abs(y[i]) + c.atol[i])
        if change > largest * abs(own[i]) and own[i] != 0.0:
            largest = change / abs(own[i])
    return largest > 1.0


@compiled
def go_straight(c, s, ahead):
    """Load the state in c.y, extrapolated linearly by a time that may be negative."""
    y, yp = array_of(c, c.y), array_of(c, c.yp)
    e = equations_view(c.equations)
    for k in range(e.n):
        c.probe[k] = y[k] + ahead * yp[k]
    load(s, e, c.probe, yp)


@compiled
def go_ahead(c, s, ahead):
    """Load the state in c.y, extrapolated with its accelerations."""
    for k in range(s.n_u):
        s.a[k] = 0.0  # constant coordinates are not loaded
    go_straight(c, s, ahead)
    add_rates(s, s.a, 0.5 * ahead * ahead, s.q)
