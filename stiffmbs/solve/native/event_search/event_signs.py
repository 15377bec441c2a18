"""The event functions as IDA's search for roots is to see them: each positive where it is first looked at, so that none that is
zero at a start, or noise about zero, counts as a change."""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled


@compiled
def watched(values, signs, masked, g, count):
    """Fill g; an event function is left out for as many calls (IDA's steps) as it is masked, and while it is exactly zero after that.

    `signs` is +1 or -1 for the sign that an event function had when it was first looked at, and 0 before.
    """
    for k in range(count):
        if masked[k] > 0:
            masked[k] -= 1
        elif signs[k] == 0.0 and values[k] != 0.0:
            signs[k] = 1.0 if values[k] > 0.0 else -1.0
        g[k] = signs[k] * values[k] if signs[k] != 0.0 else 1.0
