"""Signs of event functions that are exactly zero at the start of a step: those that the motion gives them first."""

from sys import float_info

from stiffmbs.compile.machine.native.access import compiled
from stiffmbs.solve.events.native.parameters import SEARCH

JUST_BEYOND = float_info.min
"""Value of a function that is zero at the start of a step, with the sign that it takes."""


@compiled
def leaves_zero(signs, values, count):
    """Return True if a function of unknown sign has a value other than zero."""
    found = 0
    for k in range(count):
        found += signs[k] == 0.0 and values[k] != 0.0
    return found > 0


@compiled
def at_zero(values, count):
    """Return the number of functions that are exactly zero."""
    found = 0
    for k in range(count):
        found += values[k] == 0.0
    return found


@compiled
def begin_sides(seen, held, count):
    """Clear the signs found so far, and their numbers of repetition."""
    for k in range(count):
        seen[k] = 0.0
        held[k] = 0.0


@compiled
def note_sides(signs, values, seen, held, count):
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
def keep_sides(signs, values, count):
    """Clear the signs of functions that were zero unless values confirm all; return True if any was found and kept."""
    found, lost = 0, 0
    for k in range(count):
        if abs(signs[k]) == JUST_BEYOND:
            found += 1
            lost += (signs[k] > 0.0 and values[k] <= 0.0) or (signs[k] < 0.0 and values[k] >= 0.0)
    for k in range(count):
        if lost > 0 and abs(signs[k]) == JUST_BEYOND:
            signs[k] = 0.0
    return found > 0 and lost == 0


@compiled
def leave_zero(values, signs, count):
    """Give values that are exactly zero the sign of the subsequent motion."""
    for k in range(count):
        if values[k] == 0.0:
            values[k] = signs[k]
