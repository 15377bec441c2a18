"""Which kernels have an event function that may come to an edge within a step: the others need no look at rates, nor inside it."""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled
from stiffmbs.solve.native.event_search.bounds import edge, turned, zone

CLEAR = 4.0
"""Times that a function must be further from the edges of its zone than it has changed in the step, and than its rate at the
start brings it, to be far from them."""
HARDLY_TURNED = 0.3
"""rad, by which a body may turn in such a step: values at the ends tell nothing of whole turns."""


@compiled
def note_zones(w):
    """Keep the edges about the values at the start of the step."""
    for k in range(w.n):
        value = w.value_before[k]
        if w.zone_low[k] < value <= w.zone_high[k]:
            continue
        number = zone(w, k, value)
        endless = w.period[k] > 0.0
        w.zone_low[k] = edge(w, k, number - 1) if endless or number > 0 else -float("inf")
        w.zone_high[k] = (
            edge(w, k, number) if endless or number < w.first_edge[k + 1] - w.first_edge[k] else float("inf")
        )


@compiled
def note_near(w, h, q_before, q_after):
    """Note which kernels have a function near the edges of its zone, by the values at both ends of a step of length h; whether any has."""
    note_zones(w)
    nearby = turned(w, q_before, q_after, HARDLY_TURNED)
    for call in range(w.n_calls):
        w.near[call] = 1 if nearby else 0
    for k in range(w.n):
        if _is_near(w, h, k):
            w.near[w.call[k]] = 1
            nearby = True
    return nearby


@compiled
def _is_near(w, h, k):
    """Return True if a function comes near an edge of its zone, by its values at both ends of a step and its rate at the start."""
    start, end = w.value_before[k], w.value_after[k]
    apart = min(min(start, end) - w.zone_low[k], w.zone_high[k] - max(start, end))
    return not apart > CLEAR * (abs(end - start) + h * abs(w.rate_before[k]))


@compiled
def near_an_event(w, h, q_before, q_after):
    """Return True if an event function comes near an edge of its zone, by the bound of `note_near`."""
    nearby = turned(w, q_before, q_after, HARDLY_TURNED)
    for k in range(w.n_event_functions):
        nearby = nearby or _is_near(w, h, k)
    return nearby


@compiled
def note_mean_rates(w, h):
    """For functions that are far from all edges, the rate at the end of a step is that between its ends."""
    for k in range(w.n):
        if not w.near[w.call[k]]:
            w.rate_after[k] = (w.value_after[k] - w.value_before[k]) / h
