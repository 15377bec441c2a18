"""Directional derivatives of the terms of a flexible body (`stiffmbs.compile.directional`).

Derivatives by state and gravity are central differences of fourth order (`stiffmbs.compile.machine.native.beams.along`),
which are exact for the terms without elasticity, apart from rotation. The terms are linear in the numbers of the body,
apart from the stretch of second order: the terms of the derivatives of the numbers, without stretch, are their
derivatives. `add_elastic_change` adds the rest.
"""

from __future__ import annotations

from math import sqrt

from stiffmbs.compile.machine.native.access import compiled, shifted
from stiffmbs.compile.machine.native.beams.along import STEP
from stiffmbs.compile.machine.native.flexible.elastic import along, elastic_forces, shape
from stiffmbs.compile.machine.native.flexible.sums import body_view, coordinate, mode, mode_view, pair, velocity
from stiffmbs.elements.spatial.flexible.layout import COUPLING


@compiled
def step_size(n, number, index, u, gravity_d, q_d, u_d):
    """Return the step of the state along a direction, with relative changes of at most `STEP`; 0 if nothing changes.

    Modal coordinates are relative to a radius of gyration.
    """
    b, largest, fastest, weight = body_view(number), 0.0, 1.0, 1.0
    length = sqrt((b.moments[0] + b.moments[1] + b.moments[2]) / b.modal_mass[0])
    for i in range(3):
        weight = max(weight, abs(b.gravity[i]))
        fastest = max(fastest, abs(u[index[1] + 3 + i]))
    for k in range(n):
        fastest = max(fastest, abs(u[velocity(index, k)]))
    for i in range(3):
        largest = max(largest, max(abs(gravity_d[i]) / weight, abs(u_d[index[1] + 3 + i]) / fastest))
    for i in range(4):
        largest = max(largest, abs(q_d[index[0] + 3 + i]))
    for k in range(n):
        largest = max(largest, abs(q_d[coordinate(index, k)]) / length)
        largest = max(largest, abs(u_d[velocity(index, k)]) / fastest)
    return STEP / largest if largest > 0.0 else 0.0


@compiled
def coupled(n, number_d, x, place, k):
    """Return row k of the derivative of the stiffness (place 0) or damping matrix (place 1) times x."""
    of_mode = mode_view(mode(number_d, k))
    total = of_mode.stiffness[0] * x[k] if place == 0 else of_mode.damping[0] * x[k]
    row = shifted(pair(n, number_d, n, 0), COUPLING * n * k)
    for l in range(n):
        total += row[COUPLING * l + place] * x[l]
    return total


@compiled
def strain_changes(n, number, number_d, work, to):
    """Compute the derivatives of p and p' by the numbers, and of the modal forces e, after `elastic_forces`.

    `to` has three vectors of n numbers: p_d, p'_d and e_d.
    """
    y, rate, p, dp, v = work, shifted(work, n), shifted(work, 2 * n), shifted(work, 3 * n), shifted(work, 7 * n)
    p_d, dp_d, e_d = to, shifted(to, n), shifted(to, 2 * n)
    for k in range(n):
        p_d[k] = 0.0
        dp_d[k] = 0.0
    for i in range(int(body_view(number).stretch[0])):
        b, b_d = shape(n, number, i), shape(n, number_d, i)
        much, quick, much_d, quick_d = 0.5 * along(n, shifted(v, n * i), y), along(n, shifted(v, n * i), rate), 0.0, 0.0
        for k in range(n):
            stretched = along(n, shifted(b_d, n + n * k), y)
            much_d += 0.5 * y[k] * stretched
            quick_d += rate[k] * stretched
        for k in range(n):
            p_d[k] += b_d[k] * much + b[k] * much_d
            dp_d[k] += b_d[k] * quick + b[k] * quick_d
    for k in range(n):
        of_mode = mode_view(mode(number, k))
        e_d[k] = of_mode.stiffness[0] * p_d[k] + of_mode.damping[0] * dp_d[k]
        e_d[k] += coupled(n, number_d, p, 0, k) + coupled(n, number_d, dp, 1, k)


@compiled
def linear(n, number_d, x, place):
    """Return the sum of the derivatives of the stiffness (place 0) or damping (place 1) of the modes times squares of x."""
    total = 0.0
    for k in range(n):
        of_mode = mode_view(mode(number_d, k))
        total += (of_mode.stiffness[0] if place == 0 else of_mode.damping[0]) * x[k] * x[k]
    return total


@compiled
def add_elastic_change(n, number, number_d, index, q, u, work, to, f):
    """Add the part of the derivative of the elastic forces by the numbers that is not linear in these."""
    elastic_forces(n, number, index, q, u, work)
    strain_changes(n, number, number_d, work, to)
    e, e_d, v = shifted(work, 4 * n), shifted(to, 2 * n), shifted(work, 7 * n)
    for l in range(n):
        of_mode = mode_view(mode(number_d, l))
        f[6 + l] -= e_d[l] - of_mode.stiffness[0] * work[l] - of_mode.damping[0] * work[n + l]
    for i in range(int(body_view(number).stretch[0])):
        b, b_d = shape(n, number, i), shape(n, number_d, i)
        much, much_d = along(n, b, e), along(n, b, e_d) + along(n, b_d, e)
        for l in range(n):
            f[6 + l] -= v[n * i + l] * much_d + along(n, shifted(b_d, n + n * l), work) * much


@compiled
def energy_change(n, number, number_d, index, q, u, work, to):
    """Return the part of the derivative of the strain energy by the numbers that is not linear in these."""
    elastic_forces(n, number, index, q, u, work)
    strain_changes(n, number, number_d, work, to)
    p, total = shifted(work, 2 * n), -0.5 * linear(n, number_d, work, 0)
    for k in range(n):
        total += p[k] * (mode_view(mode(number, k)).stiffness[0] * to[k] + 0.5 * coupled(n, number_d, p, 0, k))
    return total


@compiled
def power_change(n, number, number_d, index, q, u, work, to):
    """Return the part of the derivative of the power of damping by the numbers that is not linear in these."""
    elastic_forces(n, number, index, q, u, work)
    strain_changes(n, number, number_d, work, to)
    dp, total = shifted(work, 3 * n), linear(n, number_d, shifted(work, n), 1)
    for k in range(n):
        of_mode = mode_view(mode(number, k))
        total -= dp[k] * (2.0 * of_mode.damping[0] * to[n + k] + coupled(n, number_d, dp, 1, k))
    return total
