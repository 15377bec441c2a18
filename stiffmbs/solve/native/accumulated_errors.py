"""Local errors of velocities, added up along the motion.

An error of the velocities in the direction of the motion changes the speed, and nothing in a motion without damping makes that good: the
position is off by more with each step that follows.  With |u| = sqrt(u^T M u) the speed error is P = sum of u^T M e / |u|, and the
displacement from there on the sum of P h u / |u|.  Damping takes errors away as it does the motion, so |u| is not taken below its mean so
far: a mechanism at rest does not go on being displaced.
"""

from __future__ import annotations

from math import sqrt

from stiffmbs.compile.machine.native.access import compiled, view_of
from stiffmbs.solve.native.tables.steps import ACCUMULATED_ERRORS

accumulated_errors_view = view_of("AccumulatedErrors", ACCUMULATED_ERRORS)


@compiled
def accumulate(a, y, error, steps, span):
    """Add the error of a step that stands for `steps` steps of a length of `span`, s, in all; y and `error` have all unknowns."""
    energy = 0.0
    power = 0.0
    for k in range(a.n):
        u = y[a.place[k]]
        energy += a.mass[k] * u * u
        power += a.mass[k] * u * error[a.place[k]]
    speed = sqrt(energy)
    a.path += speed * span
    a.time += span
    if not speed > 0.0:
        return
    a.speed_error += steps * power / speed
    moved = a.speed_error * span / max(speed, a.path / a.time)
    for k in range(a.n):
        a.displaced[k] += moved * y[a.place[k]]
        a.furthest[k] = max(a.furthest[k], abs(a.displaced[k]))
