"""Ends of steps near a bifurcation pose, where rounding determines the accelerations.

Let d be the distance from such a pose, relative to the mechanism's size.  A rounding e of positions causes errors of
e/d in positions, e/d^2 in velocities and e/d^3 in accelerations.  A step across the pose is not affected.  A step that
ends near it transfers errors that shorter steps do not reduce, because they end nearer to the pose.
"""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled, shifted
from stiffmbs.solve.native.tables.views import eliminated_view

POSITION_ROUNDING = 2.2e-16
"""Rounding of positions relative to the size of the mechanism: that of a double."""
CLOSE = 1e-2
"""Relative size d^2 of the pivots of J M^-1 J^T below which an end is checked."""
HARMFUL = 0.01
"""Velocity change by such acceleration errors in a step, in tolerances, above which a step should not end there."""
MOST_MOVED, SHORTER = 3, 0.55
"""Number of times that the end of a step is moved back, and factor of the step: the stages of the next step then avoid
the pose, because those of dopri5 and dop853 are at up to 0.33 and from 0.6 of a step on."""


@compiled
def uncertain_end(x, c, h):
    """Return True if rounding of positions changes velocities in the next step by more than `HARMFUL`."""
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
