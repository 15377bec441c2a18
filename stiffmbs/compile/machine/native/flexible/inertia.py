"""Forces, mass matrix and energies of a flexible body in a floating frame (`stiffmbs.compile.machine.native.flexible.sums`)."""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled, room, shifted
from stiffmbs.compile.machine.native.flexible.elastic import add_coupling, along, elastic_forces, strain_rates, strains
from stiffmbs.compile.machine.native.flexible.sums import (
    axial,
    body_view,
    centrifugal,
    cross,
    dot,
    first_moment,
    first_moment_of_mode,
    first_rate,
    mode,
    mode_view,
    moment_of_rotation,
    moment_rate_of_mode,
    of_mode,
    pair,
    pair_view,
    rigid_momentum,
    second_moments,
    sum_of_mode,
    sums,
    times,
    transposed_times,
    velocity,
)


@compiled
def add_forces(n, number, gravity, index, q, A, u, work, f):
    """Compute the quadratic velocity terms, elastic and damping forces, and the weight of the first moment."""
    w = shifted(u, int(index[1]) + 3)
    d, s, g, x, y, z, I, K = room(3), room(3), room(3), room(3), room(3), room(3), room(9), room(9)
    first_moment(n, number, index, q, work, d)
    first_rate(n, number, index, u, work, s)
    transposed_times(A, gravity, g)
    second_moments(n, number, index, q, u, work, I, K)
    for i in range(3):
        s[i] *= 2.0
    rigid_momentum(w, d, s, x)
    cross(w, x, y)
    times(I, w, x)
    cross(w, x, z)
    moment_of_rotation(K, w, x)
    cross(d, g, s)
    for i in range(3):
        f[3 + i] = -z[i] - 2.0 * x[i] + s[i]
    N, D = room(9), room(3)
    elastic = elastic_forces(n, number, index, q, u, work)
    for k in range(n):
        rate = u[velocity(index, k)]
        sum_of_mode(n, k, number, work, N)
        rates = pair_view(of_mode(sums(n, work, 1), k))
        first_moment_of_mode(n, k, number, work, D)
        f[6 + k] = dot(D, g) + centrifugal(N, w) - elastic[k] - 2.0 * dot(w, rates.axial)
        moment_rate_of_mode(n, k, work, x)
        for i in range(3):
            y[i] += rate * rates.T[i]
            f[3 + i] -= rate * x[i]
    times(A, y, f)
    for i in range(3):
        f[i] = -f[i]


@compiled
def add_inertia(n, number, index, q, A, u, work, m):
    """Compute the entries of the mass matrix besides its diagonal part, in the order of `FlexibleInertia.compiled_terms`."""
    d, x, y, D, I, K, N = room(3), room(3), room(3), room(3), room(9), room(9), room(9)
    first_moment(n, number, index, q, work, d)
    for c in range(3):
        for i in range(3):
            x[i] = 1.0 if i == c else 0.0
        cross(x, d, y)
        times(A, y, x)
        for i in range(3):
            m[3 * c + i] = x[i]
            m[9 + 3 * c + i] = x[i]
    second_moments(n, number, index, q, u, work, I, K)
    for i in range(9):
        m[18 + i] = I[i]
    for k in range(n):
        sum_of_mode(n, k, number, work, N)
        first_moment_of_mode(n, k, number, work, D)
        times(A, D, x)
        to = shifted(m, 27 + 12 * k)
        for i in range(3):
            to[i] = x[i]
            to[3 + i] = x[i]
            to[6 + i] = axial(N, i)
            to[9 + i] = axial(N, i)
        for l in range(n):
            m[27 + 12 * n + n * k + l] = modal_mass(n, number, l, k)


@compiled
def modal_mass(n, number, l, k):
    """Return an entry of the modal mass matrix, less its diagonal part."""
    return pair_view(pair(n, number, l, k)).trace[0] - (body_view(number).modal_mass[0] if l == k else 0.0)


@compiled
def kinetic_energy(n, number, index, q, A, u, work):
    """Return the kinetic energy of this part of the mass matrix."""
    v, w = shifted(u, int(index[1])), shifted(u, int(index[1]) + 3)
    d, s, x, y, I, K = room(3), room(3), room(3), room(3), room(9), room(9)
    first_moment(n, number, index, q, work, d)
    first_rate(n, number, index, u, work, s)
    second_moments(n, number, index, q, u, work, I, K)
    rigid_momentum(w, d, s, x)
    times(A, x, y)
    times(I, w, x)
    total = 0.0
    for i in range(3):
        total += v[i] * y[i] + 0.5 * w[i] * x[i] + w[i] * axial(K, i)
    for k in range(n):
        for l in range(n):
            total += 0.5 * u[velocity(index, k)] * u[velocity(index, l)] * modal_mass(n, number, l, k)
    return total


@compiled
def potential_energy(n, number, gravity, index, q, A, work):
    """Return the strain energy, and the potential energy of the first moment of mass."""
    d, x = room(3), room(3)
    first_moment(n, number, index, q, work, d)
    times(A, d, x)
    total = -dot(gravity, x)
    strains(n, number, index, q, work)
    p, e = shifted(work, 2 * n), shifted(work, 4 * n)
    for k in range(n):
        e[k] = mode_view(mode(number, k)).stiffness[0] * p[k]
    add_coupling(n, number, p, 0, e)
    return total + 0.5 * along(n, p, e)


@compiled
def dissipated_power(n, number, index, q, u, work):
    """Return the power of modal damping."""
    strains(n, number, index, q, work)
    strain_rates(n, number, index, u, work)
    rates, e = shifted(work, 3 * n), shifted(work, 4 * n)
    for k in range(n):
        e[k] = mode_view(mode(number, k)).damping[0] * rates[k]
    add_coupling(n, number, rates, 1, e)
    return -along(n, rates, e)
