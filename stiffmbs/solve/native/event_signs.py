"""The event functions as IDA's search for roots is to see them: each positive where it is first looked at, so that none that is
zero at a start, or noise about zero, counts as a change."""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled


@compiled
def watched(values, sides, waits, g, count):
    """Fill g; an event function is left out for as many calls (IDA's steps) as it waits, and while it is exactly zero after that.

    `sides` is +1 or -1 for the sign that an event function had when it was first looked at, and 0 before.
    """
    for k in range(count):
        if waits[k] > 0:
            waits[k] -= 1
        elif sides[k] == 0.0 and values[k] != 0.0:
            sides[k] = 1.0 if values[k] > 0.0 else -1.0
        g[k] = sides[k] * values[k] if sides[k] != 0.0 else 1.0
