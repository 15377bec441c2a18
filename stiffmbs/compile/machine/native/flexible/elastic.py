"""Elastic and damping forces of a flexible body with the stretch of second order.

The strain energy is U = 1/2 sum stiffness_k p_k^2 with p = y + sum_i b_i y^T Gamma_i y / 2 by modal coordinates y
(`stiffmbs.flexible_bodies.second_order`). The damping forces act on p'. The array `work`
has the vectors y, y', p, p', the forces, two columns, then all Gamma_i y and Gamma_i y'.
"""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled, shifted
from stiffmbs.compile.machine.native.flexible.sums import (
    add_row,
    body_view,
    clear,
    coordinate,
    mode,
    mode_view,
    pair,
    velocity,
)
from stiffmbs.elements.spatial.flexible.layout import COUPLING


@compiled
def shape(n, number, i):
    """Return b_i of the stretch of second order; Gamma_i follows by rows."""
    return shifted(pair(n, number, n, 0), COUPLING * n * n + i * (n + n * n))


@compiled
def along(n, b, x):
    """Return b . x of vectors of n numbers."""
    total = 0.0
    for k in range(n):
        total += b[k] * x[k]
    return total


@compiled
def stretched(n, number, x, v):
    """Compute v_i = Gamma_i x for all i."""
    for i in range(int(body_view(number).stretch[0])):
        stretch, to = shifted(shape(n, number, i), n), shifted(v, n * i)
        clear(n, to)
        for l in range(n):
            add_row(n, x[l], shifted(stretch, n * l), to)


@compiled
def strains(n, number, index, q, work):
    """Compute y, p and Gamma_i y."""
    y, p, v = work, shifted(work, 2 * n), shifted(work, 7 * n)
    for k in range(n):
        y[k] = q[coordinate(index, k)]
        p[k] = y[k]
    stretched(n, number, y, v)
    for i in range(int(body_view(number).stretch[0])):
        add_row(n, 0.5 * along(n, shifted(v, n * i), y), shape(n, number, i), p)


@compiled
def strain_rates(n, number, index, u, work):
    """Compute y' and p' after `strains`."""
    rate, dp, v = shifted(work, n), shifted(work, 3 * n), shifted(work, 7 * n)
    for k in range(n):
        rate[k] = u[velocity(index, k)]
        dp[k] = rate[k]
    for i in range(int(body_view(number).stretch[0])):
        add_row(n, along(n, shifted(v, n * i), rate), shape(n, number, i), dp)


@compiled
def pulled(n, number, v, e, x):
    """Compute x = P^T e with P = dp/dy, for another vector x."""
    for l in range(n):
        x[l] = e[l]
    for i in range(int(body_view(number).stretch[0])):
        add_row(n, along(n, shape(n, number, i), e), shifted(v, n * i), x)


@compiled
def add_coupling(n, number, x, place, e):
    """Add the product of the couplings of modes by stiffness (place 0) or damping (place 1) and x to e."""
    first = pair(n, number, n, 0)
    for k in range(int(body_view(number).coupled[0])):
        row = shifted(first, COUPLING * n * k)
        for l in range(n):
            e[k] += row[COUPLING * l + place] * x[l]


@compiled
def elastic_forces(n, number, index, q, u, work):
    """Compute elastic and damping forces by mode with opposite sign; return them."""
    p, dp, e, x = shifted(work, 2 * n), shifted(work, 3 * n), shifted(work, 4 * n), shifted(work, 5 * n)
    strains(n, number, index, q, work)
    strain_rates(n, number, index, u, work)
    for k in range(n):
        of_mode = mode_view(mode(number, k))
        e[k] = of_mode.stiffness[0] * p[k] + of_mode.damping[0] * dp[k]
    add_coupling(n, number, p, 0, e)
    add_coupling(n, number, dp, 1, e)
    pulled(n, number, shifted(work, 7 * n), e, x)
    return x


@compiled
def add_elastic_slopes(n, number, index, q, u, work, f_q, f_u):
    """Add the derivatives of the elastic and damping forces by modal coordinates and their velocities."""
    e, w, z = shifted(work, 4 * n), shifted(work, 5 * n), shifted(work, 6 * n)
    dz, dw = shifted(work, 2 * n), shifted(work, 3 * n)
    v, dv = shifted(work, 7 * n), shifted(work, 7 * n + n * n)
    rank = int(body_view(number).stretch[0])
    elastic_forces(n, number, index, q, u, work)
    stretched(n, number, shifted(work, n), dv)
    for i in range(rank):
        b = shape(n, number, i)
        much, stretch = along(n, b, e), shifted(b, n)
        for l in range(n):
            for j in range(n):
                f_q[(4 + n) * (6 + l) + 4 + j] -= much * stretch[n * l + j]
    for j in range(n):
        for k in range(n):
            dw[k] = 0.0
            dz[k] = 1.0 if k == j else 0.0
        for i in range(rank):
            b = shape(n, number, i)
            add_row(n, dv[n * i + j], b, dw)
            add_row(n, v[n * i + j], b, dz)
        for k in range(n):
            of_mode = mode_view(mode(number, k))
            w[k] = of_mode.stiffness[0] * dz[k] + of_mode.damping[0] * dw[k]
            z[k] = of_mode.damping[0] * dz[k]
        add_coupling(n, number, dz, 0, w)
        add_coupling(n, number, dw, 1, w)
        add_coupling(n, number, dz, 1, z)
        for l in range(n):
            f_q[(4 + n) * (6 + l) + 4 + j] -= w[l]
            f_u[(3 + n) * (6 + l) + 3 + j] -= z[l]
        for i in range(rank):
            b = shape(n, number, i)
            by_q, by_u = along(n, b, w), along(n, b, z)
            for l in range(n):
                f_q[(4 + n) * (6 + l) + 4 + j] -= v[n * i + l] * by_q
                f_u[(3 + n) * (6 + l) + 3 + j] -= v[n * i + l] * by_u
