"""Directional derivatives of the terms of a flexible body (`stiffmbs.compile.directional`).

Derivatives by state and gravity are central differences of fourth order (`stiffmbs.compile.machine.native.beams.along`),
which are exact for the terms without elasticity, apart from rotation. The terms are linear in the numbers of the body,
apart from the stretch of second order: the terms of the derivatives of the numbers, without stretch, are their
derivatives. `add_elastic_change` adds the rest.
"""

from math import sqrt

from stiffmbs.compile.machine.native.access import compiled, shifted
from stiffmbs.compile.machine.native.beams.along import STEP
from stiffmbs.compile.machine.native.flexible.elastic import elastic_forces, rank
from stiffmbs.compile.machine.native.flexible.sums import (
    DAMPING,
    STIFFNESS,
    along,
    body_view,
    combine,
    coordinate,
    coupling,
    elastic,
    of_modes,
    shape,
    stretched,
    velocity,
    width,
)
from stiffmbs.compile.machine.native.vectors import clear


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
    return of_modes(n, number_d, STIFFNESS + place)[k] * x[k] + along(n, coupling(n, number_d, place, k), x)


@compiled
def strain_changes(n, number, number_d, work, to):
    """Compute the derivatives of p and p' by the numbers, and of the modal forces e, after `elastic_forces`.

    `to` has four rows: p_d, p'_d and e_d, and one for Gamma_i y by the derivative of Gamma_i.
    """
    y, rate, p, dp = elastic(n, work, 0), elastic(n, work, 1), elastic(n, work, 2), elastic(n, work, 3)
    p_d, dp_d, e_d, of_y, row = to, elastic(n, to, 1), elastic(n, to, 2), elastic(n, to, 3), width(n)
    stiffness, damping = of_modes(n, number, STIFFNESS), of_modes(n, number, DAMPING)
    clear(3 * row, p_d)
    for i in range(rank(number)):
        b, b_d, v = shape(n, number, i), shape(n, number_d, i), stretched(n, work, i)
        changed_stretch(n, number, number_d, i, y, of_y)
        much, quick, much_d, quick_d = (
            0.5 * along(n, v, y),
            along(n, v, rate),
            0.5 * along(n, of_y, y),
            along(n, of_y, rate),
        )
        for k in range(row):
            p_d[k] += b_d[k] * much + b[k] * much_d
            dp_d[k] += b_d[k] * quick + b[k] * quick_d
    for k in range(n):
        e_d[k] = stiffness[k] * p_d[k] + damping[k] * dp_d[k]
        e_d[k] += coupled(n, number_d, p, 0, k) + coupled(n, number_d, dp, 1, k)


@compiled
def changed_stretch(n, number, number_d, i, y, to):
    """Compute the product of the derivative of Gamma_i and y."""
    known = int(body_view(number).known[0])
    clear(width(n), to)
    for l in range(n):
        row = shifted(shape(n, number_d, known), width(n) * (known * l + i))
        combine(n, 1, shifted(y, l), 1, row, to)


@compiled
def linear(n, number_d, x, place):
    """Return the sum of the derivatives of the stiffness (place 0) or damping (place 1) of the modes times squares of x."""
    total, of_mode = 0.0, of_modes(n, number_d, STIFFNESS + place)
    for k in range(n):
        total += of_mode[k] * x[k] * x[k]
    return total


@compiled
def add_elastic_change(n, number, number_d, work, to, f):
    """Add the part of the derivative of the elastic forces by the numbers that is not linear in these."""
    elastic_forces(n, number, work)
    strain_changes(n, number, number_d, work, to)
    y, rate, e, e_d, of_y = (
        elastic(n, work, 0),
        elastic(n, work, 1),
        elastic(n, work, 4),
        elastic(n, to, 2),
        elastic(n, to, 3),
    )
    stiffness_d, damping_d = of_modes(n, number_d, STIFFNESS), of_modes(n, number_d, DAMPING)
    for l in range(n):
        f[6 + l] -= e_d[l] - stiffness_d[l] * y[l] - damping_d[l] * rate[l]
    for i in range(rank(number)):
        b, b_d, v = shape(n, number, i), shape(n, number_d, i), stretched(n, work, i)
        much, much_d = along(n, b, e), along(n, b, e_d) + along(n, b_d, e)
        changed_stretch(n, number, number_d, i, y, of_y)
        for l in range(n):
            f[6 + l] -= v[l] * much_d + of_y[l] * much


@compiled
def energy_change(n, number, number_d, work, to):
    """Return the part of the derivative of the strain energy by the numbers that is not linear in these."""
    elastic_forces(n, number, work)
    strain_changes(n, number, number_d, work, to)
    p, total, stiffness = elastic(n, work, 2), -0.5 * linear(n, number_d, work, 0), of_modes(n, number, STIFFNESS)
    for k in range(n):
        total += p[k] * (stiffness[k] * to[k] + 0.5 * coupled(n, number_d, p, 0, k))
    return total


@compiled
def power_change(n, number, number_d, work, to):
    """Return the part of the derivative of the power of damping by the numbers that is not linear in these."""
    elastic_forces(n, number, work)
    strain_changes(n, number, number_d, work, to)
    dp, dp_d, total, damping = (
        elastic(n, work, 3), elastic(n, to, 1), linear(n, number_d, elastic(n, work, 1), 1), of_modes(n, number, DAMPING)
    )  # fmt: skip
    for k in range(n):
        total -= dp[k] * (2.0 * damping[k] * dp_d[k] + coupled(n, number_d, dp, 1, k))
    return total
