"""Ends of steps beside a pose at which two branches of the motion meet: rounding decides about accelerations there.

At a distance d from such a pose, relative to the mechanism's size, a rounding e of positions puts the mechanism by e/d
beside its branch, its velocities by e/d^2 and its accelerations by e/d^3.  A step over the pose sees nothing of that.  A
step that ends beside it hands errors on that no shorter step makes good: the shorter it is, the nearer it comes to the pose.
"""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled, shifted
from stiffmbs.solve.native.tables.views import eliminated_view

POSITION_ROUNDING = 2.2e-16
"""Of positions, relative to the size of the mechanism: that of a double."""
CLOSE = 1e-2
"""Part that the pivots of J M^-1 J^T keep, d^2, from which on an end is looked at."""
HARMFUL = 0.01
"""Change of a velocity by such accelerations over the step, relative to the tolerance, with which a step should not end."""
MOST_MOVED, SHORTER = 3, 0.55
"""How often the end of a step is moved back, and to which part of the step each time: the next step then takes no stage near the pose,
as the stages of dopri5 and dop853 stand at up to 0.33 of it and from 0.6 on."""


@compiled
def uncertain_end(x, c, h):
    """Whether rounding of positions changes the accelerations at the end of a step by more than the next step bears."""
    if not x.pivots_tell:
        return False
    r = eliminated_view(x.eliminated)
    kept = r.kept
    if kept > CLOSE * r.most_kept:
        return False
    if not kept > 0.0:
        return True
    distance = (kept / r.most_kept) ** 0.5
    rates = shifted(x.k, c.stages * x.n)
    total = 0.0
    for i in range(x.n_q, x.n):
        change = h * rates[i] * POSITION_ROUNDING / distance**3 * x.weight[i]
        total += change * change
    return total > HARMFUL * HARMFUL * x.n
