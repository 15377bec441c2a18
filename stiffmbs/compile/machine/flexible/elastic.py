"""Elastic and damping forces of a flexible body with the stretch of second order.

The strain energy is U = 1/2 sum stiffness_k p_k^2 with p = y + sum_i b_i y^T Gamma_i y / 2 by modal coordinates y
(`stiffmbs.flexible_bodies.second_order`). The damping forces act on p'. The rows of `elastic` are y, y', p, p', the
forces, two more, and two of factors of the stretches.
"""

from stiffmbs.compile.machine.flexible.sums import (
    DAMPING,
    STIFFNESS,
    add_rows,
    along,
    body_view,
    combine,
    coupling,
    elastic,
    of_modes,
    shape,
    stretched,
    stretches,
    width,
)
from stiffmbs.compile.machine.native.access import compiled, has_derivative, shifted
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.compile.machine.native.vectors import clear


@compiled
def rank(number):
    """Return the number of stretches."""
    return int(body_view(number).stretch[0])


@compiled
def stretch(n, number, x, to):
    """Compute Gamma_i x for all i."""
    count, stride = rank(number) * width(n), int(body_view(number).known[0]) * width(n)
    clear(count, to)
    for l in range(0, n, 3):
        add_rows(shifted(x, l), stretches(n, number, l), stride, count, to)


@compiled
def strains(n, number, work):
    """Compute p and Gamma_i y."""
    y, p, factors = elastic(n, work, 0), elastic(n, work, 2), elastic(n, work, 7)
    stretch(n, number, y, stretched(n, work, 0))
    copied(p, y, width(n))
    for i in range(rank(number)):
        factors[i] = 0.5 * along(n, stretched(n, work, i), y)
    combine(n, rank(number), factors, 1, shape(n, number, 0), p)


@compiled
def strain_rates(n, number, work):
    """Compute p' after `strains`."""
    rate, dp, factors = elastic(n, work, 1), elastic(n, work, 3), elastic(n, work, 7)
    copied(dp, rate, width(n))
    for i in range(rank(number)):
        factors[i] = along(n, stretched(n, work, i), rate)
    combine(n, rank(number), factors, 1, shape(n, number, 0), dp)


@compiled
def add_coupling(n, number, x, place, e):
    """Add the product of the couplings of modes by stiffness (place 0) or damping (place 1) and x to e.

    Couplings that are zero may have derivatives by parameters.
    """
    for k in range(n if has_derivative(number) else int(body_view(number).coupled[0])):
        e[k] += along(n, coupling(n, number, place, k), x)


@compiled
def pull(n, number, x, work):
    """Compute P^T x in place of x, with P = dp/dy."""
    factors = elastic(n, work, 7)
    for i in range(rank(number)):
        factors[i] = along(n, shape(n, number, i), x)
    combine(n, rank(number), factors, 1, stretched(n, work, 0), x)


@compiled
def elastic_forces(n, number, work):
    """Compute elastic and damping forces by mode with opposite sign; return them."""
    p, dp, e, x = elastic(n, work, 2), elastic(n, work, 3), elastic(n, work, 4), elastic(n, work, 5)
    stiffness, damping = of_modes(n, number, STIFFNESS), of_modes(n, number, DAMPING)
    strains(n, number, work)
    strain_rates(n, number, work)
    for k in range(width(n)):
        e[k] = stiffness[k] * p[k] + damping[k] * dp[k]
    add_coupling(n, number, p, 0, e)
    add_coupling(n, number, dp, 1, e)
    copied(x, e, width(n))
    pull(n, number, x, work)
    return x


@compiled
def add_elastic_slopes(n, number, work, f_q, f_u):
    """Add the derivatives of the elastic and damping forces by modal coordinates and their velocities."""
    e, w, z, dz, dw = (
        elastic(n, work, 4), elastic(n, work, 5), elastic(n, work, 6), elastic(n, work, 2), elastic(n, work, 3)
    )  # fmt: skip
    stiffness, damping, r = of_modes(n, number, STIFFNESS), of_modes(n, number, DAMPING), rank(number)
    of_e = elastic(n, work, 8)
    elastic_forces(n, number, work)
    stretch(n, number, elastic(n, work, 1), stretched(n, work, n))
    for i in range(r):
        of_e[i] = along(n, shape(n, number, i), e)
    for j in range(n):
        clear(2 * width(n), dz)
        dz[j] = 1.0
        combine(n, r, shifted(stretched(n, work, 0), j), width(n), shape(n, number, 0), dz)
        combine(n, r, shifted(stretched(n, work, n), j), width(n), shape(n, number, 0), dw)
        for k in range(width(n)):
            w[k] = stiffness[k] * dz[k] + damping[k] * dw[k]
            z[k] = damping[k] * dz[k]
        add_coupling(n, number, dz, 0, w)
        add_coupling(n, number, dw, 1, w)
        add_coupling(n, number, dz, 1, z)
        pull(n, number, w, work)
        pull(n, number, z, work)
        combine(n, r, of_e, 1, stretches(n, number, j), w)
        for l in range(n):
            f_q[(4 + n) * (6 + l) + 4 + j] -= w[l]
            f_u[(3 + n) * (6 + l) + 3 + j] -= z[l]
