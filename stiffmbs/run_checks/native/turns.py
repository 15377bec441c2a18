"""Distances of angles from the counters of their turns."""

from stiffmbs.compile.machine.native.access import shifted, state_view
from stiffmbs.compile.machine.native.evaluate import POSITION, evaluate


def apart_from_counters(count, n_q, t, q, n_counters, source, row, apart, state):
    """Write the distances of angles (position terms) from their counters to `apart`, for `count` coordinate rows."""
    s = state_view(state)
    for k in range(count):
        pose = shifted(q, k * n_q)
        for i in range(n_q):
            s.q[i] = pose[i]
        values = evaluate(s, POSITION, t[k])
        for i in range(n_counters):
            apart[k * n_counters + i] = abs(values[source[i]] - pose[row[i]])
