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
def add_error(a, y, error, steps):
    """Add the local error of a step that stands for so many; y and `error` have all unknowns."""
    energy = 0.0
    power = 0.0
    for k in range(a.n):
        u = y[a.place[k]]
        energy += a.mass[k] * u * u
        power += a.mass[k] * u * error[a.place[k]]
    if energy > 0.0:
        a.speed_error += steps * power / sqrt(energy)


@compiled
def displace(a, y, span):
    """Displace positions by the error of the speed over a time, s."""
    energy = 0.0
    for k in range(a.n):
        u = y[a.place[k]]
        energy += a.mass[k] * u * u
    speed = sqrt(energy)
    a.speed_error /= 1.0 + max(a.damping, 0.0) * span
    a.path += speed * span
    a.time += span
    if not a.path > 0.0:
        return
    moved = a.speed_error * span / max(speed, a.path / a.time)
    for k in range(a.n):
        a.displaced[k] += moved * y[a.place[k]]
        a.furthest[k] = max(a.furthest[k], abs(a.displaced[k]))


@compiled
def note_damping(a, y, values):
    """Note the rate at which forces damp the motion at y, 1/s, by derivatives of forces by velocities."""
    energy = 0.0
    for k in range(a.n):
        u = y[a.place[k]]
        energy += a.mass[k] * u * u
    power = 0.0
    for k in range(a.n_damped):
        power -= a.damped_factor[k] * values[a.damped_source[k]] * y[a.damped_row[k]] * y[a.damped_column[k]]
    a.damping = power / energy if energy > 0.0 else 0.0


@compiled
def note_damping_by_difference(a, y, rate, faster_rate, part):
    """Note the rate at which forces damp the motion at y, 1/s, by the accelerations there and with velocities greater by a part of them."""
    energy = 0.0
    power = 0.0
    for k in range(a.n):
        j = a.place[k]
        energy += a.mass[k] * y[j] * y[j]
        power -= a.mass[k] * y[j] * (faster_rate[j] - rate[j])
    a.damping = power / (part * energy) if energy > 0.0 else 0.0
