"""Signs of event functions that are exactly zero at the start of a step: those that the motion gives them first."""

from sys import float_info

from stiffmbs.compile.machine.native.access import compiled
from stiffmbs.solve.events.native.parameters import SEARCH
from stiffmbs.solve.events.native.values import switches

JUST_BEYOND = float_info.min
"""Value of a function that is zero at the start of a step, with the sign that it takes."""


@compiled
def at_zero(values, count):
    """Return the number of functions that are exactly zero."""
    found = 0
    for k in range(count):
        found += values[k] == 0.0
    return found


@compiled
def note_signs(signs, values, seen, held, count):
    """Set the sign of each function that has kept it for enough values; return the number of functions without."""
    open_ones = 0
    for k in range(count):
        if signs[k] != 0.0:
            continue
        side = float(values[k] > 0.0) - float(values[k] < 0.0)
        held[k] = held[k] + 1.0 if side != 0.0 and side == seen[k] else float(side != 0.0)
        seen[k] = side
        if held[k] >= SEARCH.held:
            signs[k] = JUST_BEYOND * side
        else:
            open_ones += 1
    return open_ones


@compiled
def find_signs(x, w, s, t, ahead, most, go_ahead):
    """Find the signs of functions that are zero at t; return the last time up to `most` at which the motion was looked at.

    `go_ahead(x, s, ahead)` loads the state that the motion reaches.
    """
    count = w.n_event_functions
    undecided = at_zero(w.value_before, count)
    for k in range(count):
        w.m[k] = 0.0
        w.m2[k] = 0.0
    while undecided > 0 and 0.0 < ahead <= most:
        go_ahead(x, s, ahead)
        undecided = note_signs(w.value_before, switches(w, s, t + ahead), w.m, w.m2, count)
        ahead *= SEARCH.longer
    return ahead / SEARCH.longer


@compiled
def keep_signs(signs, values, count):
    """Clear the signs of functions that were zero unless values confirm all; return True if they are kept."""
    lost = 0
    for k in range(count):
        if abs(signs[k]) == JUST_BEYOND:
            lost += (signs[k] > 0.0 and values[k] <= 0.0) or (signs[k] < 0.0 and values[k] >= 0.0)
    for k in range(count):
        if lost > 0 and abs(signs[k]) == JUST_BEYOND:
            signs[k] = 0.0
    return lost == 0
