"""Location of the first event within a step, common to all integrators.

An integrator gives functions of its record `x` that load a state for the kernels.  `straight(x, s, ahead)` loads the end
of its last step, moved along the rates there.  `within(x, s, ahead)` loads the state of the step a time after the start of
the search, or returns a negative status.  `roughly` may do so less accurately.
"""

from math import pi

from stiffmbs.compile.machine.native.access import compiled, shifted
from stiffmbs.compile.machine.native.evaluate import SWITCH, evaluate_some
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.solve.events.native.bounds import (
    LOOKED_AT,
    begin_bands,
    longest_by_turns,
    note_farthest,
    note_unresolved,
    noted_rates,
    shift_ends,
    suspicious,
    time_of_difference,
    turned_arguments,
)
from stiffmbs.solve.events.native.nearby import note_mean_rates, note_near
from stiffmbs.solve.events.native.outside import note_outside
from stiffmbs.solve.events.native.parameters import SEARCH
from stiffmbs.solve.events.native.values import switches, take_reactions, unwrapped
from stiffmbs.solve.events.native.within_step import first_event, keep_row

NONE, FAR = range(2, 4)
"""Results of `located` for no event in the step, and for no function near a breakpoint."""


@compiled
def note_values(w, s, t):
    """Note the values of all functions at a start, which is loaded."""
    keep_row(w, s, 0)
    copied(w.value_before, switches(w, s, t), w.n)
    begin_bands(w)


@compiled
def note_rates(x, w, s, t, ahead, straight):
    """Note the rates of all functions at a start, and begin the search there."""
    straight(x, s, ahead)
    noted_rates(w.rate_before, w.value_before, switches(w, s, t + ahead), ahead, w.n)
    w.longest = longest_by_turns(w, w.rate_before, SEARCH.turned)
    w.target = float("inf")
    w.begun = t
    w.begins = min(w.begins, t)


@compiled
def evaluate_near(w, s, t):
    """Evaluate the functions that may change within the step; all if arguments of sines limit the next step."""
    if w.n_turns > 0:
        return switches(w, s, t)
    take_reactions(w, s, t)
    return unwrapped(w, evaluate_some(s, SWITCH, t, w.near))


@compiled
def located(x, w, s, t, straight, roughly, within):
    """Return the place from 0 to 1 of the first event in a step to t; `NONE`, `FAR` or a negative status.

    The end of the step is loaded, and `value_after` has its values.
    """
    h = t - w.begun
    if not note_near(w, h, w.row, s.q):
        note_mean_rates(w, h)
        return FAR
    keep_row(w, s, w.n_nodes - 1)
    ahead = -time_of_difference(w, h, t)
    straight(x, s, ahead)
    noted_rates(w.rate_after, w.value_after, evaluate_near(w, s, t + ahead), ahead, w.n)
    note_mean_rates(w, h)
    status = roughly(x, s, LOOKED_AT * h)
    if status < 0:
        return float(status)
    copied(w.m, evaluate_near(w, s, w.begun + LOOKED_AT * h), w.n)
    note_farthest(w, w.m)
    if not suspicious(w, h, w.row, shifted(w.row, (w.n_nodes - 1) * (w.n_state + w.n_lam))):
        return NONE
    for node in range(w.n_nodes):
        status = within(x, s, w.node[node] * h)
        if status < 0:
            return float(status)
        take_reactions(w, s, w.begun + w.node[node] * h)
        keep_row(w, s, node)
    return first_event(w, s, w.begun, h)


@compiled
def go_on(w, s, t):
    """Make the end of the step, which is loaded, the start of the next, which arguments of sines limit."""
    w.longest = longest_by_turns(w, w.rate_after, SEARCH.turned)
    if w.longest == float("inf") and turned_arguments(w, w.value_before, w.value_after) > pi:
        note_unresolved(w, w.begun, w.value_before, w.value_after)
    note_outside(w, t)
    note_farthest(w, w.value_after)
    shift_ends(w)
    keep_row(w, s, 0)
    w.target = float("inf")
    w.begun = t
