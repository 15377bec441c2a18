"""Selection of kernels with event functions that may reach a breakpoint within a step; others are not searched."""

from stiffmbs.compile.machine.native.access import compiled
from stiffmbs.solve.events.native.bounds import breakpoint_of, interval, turned
from stiffmbs.solve.events.native.parameters import SEARCH


@compiled
def note_intervals(w):
    """Store the breakpoints around the values at the start of the step."""
    for k in range(w.n):
        value = w.value_before[k]
        if w.interval_low[k] < value <= w.interval_high[k]:
            continue
        number = interval(w, k, value)
        endless = w.period[k] > 0.0
        w.interval_low[k] = breakpoint_of(w, k, number - 1) if endless or number > 0 else -float("inf")
        w.interval_high[k] = (
            breakpoint_of(w, k, number)
            if endless or number < w.first_breakpoint[k + 1] - w.first_breakpoint[k]
            else float("inf")
        )


@compiled
def note_near(w, h, q_before, q_after):
    """Mark the kernels with a function near a breakpoint, by values at both ends of a step; True if any is."""
    note_intervals(w)
    nearby = turned(w, q_before, q_after, SEARCH.hardly_turned)
    for call in range(w.n_calls):
        w.near[call] = 1 if nearby else 0
    for k in range(w.n):
        if _is_near(w, h, k):
            w.near[w.call[k]] = 1
            nearby = True
    return nearby


@compiled
def _is_near(w, h, k):
    """Return True if a function comes near a breakpoint, by values at both ends of a step and the initial rate."""
    start, end = w.value_before[k], w.value_after[k]
    apart = min(min(start, end) - w.interval_low[k], w.interval_high[k] - max(start, end))
    return not apart > SEARCH.clear * (abs(end - start) + h * abs(w.rate_before[k]))


@compiled
def near_an_event(w, h, q_before, q_after):
    """Return True if an event function comes near a breakpoint, by the bound of `note_near`."""
    nearby = turned(w, q_before, q_after, SEARCH.hardly_turned)
    for k in range(w.n_event_functions):
        nearby = nearby or _is_near(w, h, k)
    return nearby


@compiled
def note_mean_rates(w, h):
    """Set the rates at the end of a step to mean rates for functions that are far from all breakpoints."""
    for k in range(w.n):
        if not w.near[w.call[k]]:
            w.rate_after[k] = (w.value_after[k] - w.value_before[k]) / h
