"""Local errors of velocities, accumulated along the motion of each group of velocities connected by constraints.

Constraints distribute errors among velocities; other velocities keep their own errors, which those of faster bodies must
not hide.  In each group, with |u| = sqrt(u^T M u), a local error e changes the speed by u^T M e / |u|.  Only damping
reduces the speed error P, at the rate -u^T (df/du) u / |u|^2; P displaces positions by P u / |u| per second.  |u| is
bounded below by its mean so far, because the direction of a mechanism at rest is rounding.
"""

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
def _energy(a, y, group):
    """Return u^T M u of a group; y has all unknowns."""
    energy = 0.0
    for k in range(a.first[group], a.first[group + 1]):
        u = y[a.place[k]]
        energy += a.mass[k] * u * u
    return energy


@compiled
def _power(a, y, error, group):
    power = 0.0
    for k in range(a.first[group], a.first[group + 1]):
        power += a.mass[k] * y[a.place[k]] * error[a.place[k]]
    return power


@compiled
def displace_by(a, y, error, values):
    """Displace positions by the local error of the last step, used for all steps since the last displacement.

    The derivatives of forces in `values` give the damping.
    """
    a.time += a.span
    for group in range(a.n_groups):
        energy = _energy(a, y, group)
        if energy > 0.0:
            a.each[group] = _power(a, y, error, group) / sqrt(energy)
            damped = 0.0
            for k in range(a.first_damped[group], a.first_damped[group + 1]):
                damped -= a.damped_factor[k] * values[a.damped_source[k]] * y[a.damped_row[k]] * y[a.damped_column[k]]
            a.damping[group] = damped / energy
        _displace(a, y, group, energy)
    a.since = 0
    a.span = 0.0


@compiled
def note_error(a, y, error):
    """Note the local error of a step that ends at y, used for each step until the next one is noted."""
    for group in range(a.n_groups):
        energy = _energy(a, y, group)
        a.each[group] = _power(a, y, error, group) / sqrt(energy) if energy > 0.0 else 0.0


@compiled
def note_damping(a, y, rate, faster_rate, part):
    """Note the damping rates at y, from accelerations there and with velocities increased by the fraction `part`."""
    for group in range(a.n_groups):
        power = 0.0
        for k in range(a.first[group], a.first[group + 1]):
            j = a.place[k]
            power -= a.mass[k] * y[j] * (faster_rate[j] - rate[j])
        energy = part * _energy(a, y, group)
        a.damping[group] = power / energy if energy > 0.0 else 0.0


@compiled
def displace(a, y, span):
    """Displace positions over one step that ends at y by the noted error."""
    a.since = 1
    a.span = span
    a.time += span
    for group in range(a.n_groups):
        _displace(a, y, group, _energy(a, y, group))


@compiled
def _displace(a, y, group, energy):
    span = a.span
    speed = sqrt(energy)
    a.path[group] += speed * span
    if not a.path[group] > 0.0:
        return
    gained = a.each[group] * a.since
    error = a.speed_error[group] + gained
    damping = a.damping[group]
    if damping > 0.0:
        error /= 1.0 + damping * span
    a.speed_error[group] = error
    moved = error * span / max(speed, a.path[group] / a.time)
    for k in range(a.first[group], a.first[group + 1]):
        a.displaced[k] += moved * y[a.place[k]]
        a.furthest[k] = max(a.furthest[k], abs(a.displaced[k]))
