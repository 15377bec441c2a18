"""Sides of event functions that are exactly zero where a step begins: those to which the motion takes them first."""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled

SHORTEST, LONGEST, LONGER = 2.2e-16, 1e-3, 4.0
"""Parts of a step from which and up to which the motion is followed from its start, and the factor from one part to the next."""
HELD = 3
"""Parts in succession in which a function must have the same sign: a single one may be rounding."""
JUST_BEYOND = 1e-300
"""Value of a function that is zero where the step begins, with the sign that it takes."""


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
    """Clear the signs seen so far, and how often in succession."""
    for k in range(count):
        seen[k] = 0.0
        held[k] = 0.0


@compiled
def note_sides(signs, values, seen, held, count):
    """Set the sign of each function that has kept it for `HELD` values; return the number of functions still without."""
    open_ones = 0
    for k in range(count):
        if signs[k] != 0.0:
            continue
        side = float(values[k] > 0.0) - float(values[k] < 0.0)
        held[k] = held[k] + 1.0 if side != 0.0 and side == seen[k] else float(side != 0.0)
        seen[k] = side
        if held[k] >= HELD:
            signs[k] = JUST_BEYOND * side
        else:
            open_ones += 1
    return open_ones


@compiled
def keep_sides(signs, values, count):
    """Forget the sides found of functions that are zero, unless values are on all of them; return True if one was found and kept."""
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
    """Move values that are exactly zero to the side on which the motion goes on."""
    for k in range(count):
        if values[k] == 0.0:
            values[k] = signs[k]
