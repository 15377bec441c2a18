"""Ends of steps near a bifurcation pose, where rounding determines the accelerations.

Let d be the distance from such a pose, relative to the mechanism's size.  A rounding e of positions causes errors of
e/d in positions, e/d^2 in velocities and e/d^3 in accelerations.  A step across the pose is not affected.  A step that
ends near it transfers errors that shorter steps do not reduce, because they end nearer to the pose.
"""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled, shifted
from stiffmbs.dynamics.native.views import eliminated_view
from stiffmbs.solve.events.native.parameters import EPSILON
from stiffmbs.solve.explicit.native.parameters import ENDS


@compiled
def uncertain_end(x, c, h):
    """Return True if rounding of positions changes velocities in the next step by more than `harmful` tolerances."""
    if not x.pivots_tell:
        return False
    r = eliminated_view(x.eliminated)
    kept = r.kept
    if kept > ENDS.close * r.most_kept:
        return False
    if not kept > 0.0:
        return True
    distance = (kept / r.most_kept) ** 0.5
    rates = shifted(x.k, c.stages * x.n)
    total = 0.0
    for i in range(x.n_q, x.n):
        change = h * rates[i] * EPSILON / distance**3 * x.weight[i]
        total += change * change
    return total > ENDS.harmful * ENDS.harmful * x.n
