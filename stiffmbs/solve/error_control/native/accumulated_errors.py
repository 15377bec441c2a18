"""Local errors of velocities, accumulated along the motion.

With |u| = sqrt(u^T M u), a local error e of the velocities changes the speed by u^T M e / |u|.  Only damping reduces
the speed error P, at the rate -u^T (df/du) u / |u|^2; P displaces positions by P u / |u| per second.  |u| is bounded
below by its mean so far, because the direction of a mechanism at rest is rounding.
"""

from __future__ import annotations

from math import sqrt

from stiffmbs.compile.machine.native.access import compiled, view_of
from stiffmbs.solve.error_control.native.layouts import ACCUMULATED_ERRORS
from stiffmbs.solve.error_control.native.parameters import ACCUMULATION

accumulated_errors_view = view_of("AccumulatedErrors", ACCUMULATED_ERRORS)


@compiled
def is_due(a, h):
    """Count a step of length h; return True if positions are to be displaced."""
    a.since += 1
    a.span += h
    return a.since >= ACCUMULATION.steps_apart


@compiled
def _energy(a, y):
    """Return u^T M u; y has all unknowns."""
    energy = 0.0
    for k in range(a.n):
        u = y[a.place[k]]
        energy += a.mass[k] * u * u
    return energy


@compiled
def _power(a, y, error):
    power = 0.0
    for k in range(a.n):
        power += a.mass[k] * y[a.place[k]] * error[a.place[k]]
    return power


@compiled
def displace_by(a, y, error, values):
    """Displace positions by the local error of the last step, used for all steps since the last displacement.

    The derivatives of forces in `values` give the damping.
    """
    energy = _energy(a, y)
    if energy > 0.0:
        a.each = _power(a, y, error) / sqrt(energy)
        damped = 0.0
        for k in range(a.n_damped):
            damped -= a.damped_factor[k] * values[a.damped_source[k]] * y[a.damped_row[k]] * y[a.damped_column[k]]
        a.damping = damped / energy
    _displace(a, y, energy)


@compiled
def note_error(a, y, error):
    """Note the local error of a step that ends at y, used for each step until the next one is noted."""
    energy = _energy(a, y)
    a.each = _power(a, y, error) / sqrt(energy) if energy > 0.0 else 0.0


@compiled
def note_damping(a, y, rate, faster_rate, part):
    """Note the damping rate at y, from accelerations there and with velocities increased by the fraction `part`."""
    power = 0.0
    for k in range(a.n):
        j = a.place[k]
        power -= a.mass[k] * y[j] * (faster_rate[j] - rate[j])
    energy = part * _energy(a, y)
    a.damping = power / energy if energy > 0.0 else 0.0


@compiled
def displace(a, y, span):
    """Displace positions over one step that ends at y by the noted error."""
    a.since = 1
    a.span = span
    _displace(a, y, _energy(a, y))


@compiled
def _displace(a, y, energy):
    span = a.span
    gained = a.each * a.since
    a.since = 0
    a.span = 0.0
    speed = sqrt(energy)
    a.path += speed * span
    a.time += span
    if not a.path > 0.0:
        return
    a.speed_error = (a.speed_error + gained) / (1.0 + max(a.damping, 0.0) * span)
    moved = a.speed_error * span / max(speed, a.path / a.time)
    for k in range(a.n):
        a.displaced[k] += moved * y[a.place[k]]
        a.furthest[k] = max(a.furthest[k], abs(a.displaced[k]))
