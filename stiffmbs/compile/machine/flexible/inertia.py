"""Forces, mass matrix and energies of a flexible body in a floating frame (`stiffmbs.compile.machine.flexible.sums`)."""

from stiffmbs.compile.machine.flexible.elastic import add_coupling, elastic_forces, strain_rates, strains
from stiffmbs.compile.machine.flexible.sums import (
    AXIAL,
    AXIAL_RATE,
    AXIAL_RATE_OF_Z,
    DAMPING,
    FIRST,
    FIRST_RATE,
    STIFFNESS,
    along,
    by_coordinates,
    by_velocities,
    centrifugal,
    combine,
    elastic,
    modal_mass,
    moment_of_rotation,
    moments,
    moments_view,
    of_modes,
    rigid_momentum,
    width,
)
from stiffmbs.compile.machine.native.access import compiled, room, shifted
from stiffmbs.compile.machine.native.vectors import clear, cross, dot, times, transposed_times


@compiled
def add_forces(n, number, gravity, index, A, u, work, f):
    """Compute the quadratic velocity terms, elastic and damping forces, and the weight of the first moment."""
    w, m, rate = shifted(u, int(index[1]) + 3), moments_view(moments(n, work)), elastic(n, work, 1)
    s, g, x, y, z = room(3), room(3), room(3), room(3), room(3)
    transposed_times(A, gravity, g)
    for i in range(3):
        s[i] = 2.0 * m.rate[i]
    rigid_momentum(w, m.d, s, x)
    cross(w, x, y)
    times(m.I, w, x)
    cross(w, x, z)
    moment_of_rotation(m.symmetric, w, x)
    cross(m.d, g, s)
    for i in range(3):
        y[i] += along(n, by_velocities(n, work, FIRST_RATE + i), rate)
        of_W = along(n, by_velocities(n, work, AXIAL_RATE + i), rate)  # the sum of the axial vectors of Z is zero
        f[3 + i] = s[i] - z[i] - 2.0 * x[i] - of_W
    times(A, y, f)
    for i in range(3):
        f[i] = -f[i]
    opposite = elastic_forces(n, number, work)
    add_modal_inertia(n, w, g, work, opposite)
    for k in range(n):
        f[6 + k] = -opposite[k]


@compiled
def add_modal_inertia(n, w, g, work, to):
    """Add the centrifugal and Coriolis terms of the modes, and their weight, with opposite signs."""
    c, weight, twice = room(6), room(3), room(3)
    centrifugal(w, c)
    for i in range(6):
        c[i] = -c[i]
    for i in range(3):
        weight[i], twice[i] = -g[i], 2.0 * w[i]
    combine(n, 6, c, 1, by_coordinates(n, work, 0), to)
    combine(n, 3, weight, 1, by_coordinates(n, work, FIRST), to)
    combine(n, 3, twice, 1, by_velocities(n, work, AXIAL_RATE_OF_Z), to)


@compiled
def add_inertia(n, number, A, work, m):
    """Compute the entries of the mass matrix besides its diagonal part, in the order of `FlexibleInertia.compiled_terms`."""
    of_body, x, y = moments_view(moments(n, work)), room(3), room(3)
    for c in range(3):
        for i in range(3):
            x[i] = 1.0 if i == c else 0.0
        cross(x, of_body.d, y)
        times(A, y, x)
        for i in range(3):
            m[3 * c + i] = x[i]
            m[9 + 3 * c + i] = x[i]
    for i in range(9):
        m[18 + i] = of_body.I[i]
    to = shifted(m, 27)
    D, N = by_coordinates(n, work, FIRST), by_coordinates(n, work, AXIAL)
    for i in range(3):
        along_x, along_y, along_z = A[3 * i], A[3 * i + 1], A[3 * i + 2]
        for k in range(n):
            along_i = along_x * D[k] + along_y * D[width(n) + k] + along_z * D[2 * width(n) + k]
            to[n * i + k] = along_i
            to[n * (6 + i) + k] = along_i
        for k in range(n):
            to[n * (3 + i) + k] = N[width(n) * i + k]
            to[n * (9 + i) + k] = N[width(n) * i + k]
    for l in range(n):
        row = modal_mass(n, number, l)
        for k in range(n):
            to[n * (12 + l) + k] = row[k]


@compiled
def kinetic_energy(n, number, index, A, u, work):
    """Return the kinetic energy of this part of the mass matrix."""
    v, w = shifted(u, int(index[1])), shifted(u, int(index[1]) + 3)
    m, rate, x, y, to = moments_view(moments(n, work)), elastic(n, work, 1), room(3), room(3), elastic(n, work, 2)
    rigid_momentum(w, m.d, m.rate, x)
    times(A, x, y)
    times(m.I, w, x)
    clear(width(n), to)
    combine(n, n, rate, 1, modal_mass(n, number, 0), to)
    return dot(v, y) + 0.5 * dot(w, x) + dot(w, m.axial) + 0.5 * along(n, rate, to)


@compiled
def potential_energy(n, number, gravity, A, work):
    """Return the strain energy, and the potential energy of the first moment of mass."""
    x, p, e, stiffness = room(3), elastic(n, work, 2), elastic(n, work, 4), of_modes(n, number, STIFFNESS)
    times(A, moments_view(moments(n, work)).d, x)
    strains(n, number, work)
    for k in range(width(n)):
        e[k] = stiffness[k] * p[k]
    add_coupling(n, number, p, 0, e)
    return 0.5 * along(n, p, e) - dot(gravity, x)


@compiled
def dissipated_power(n, number, work):
    """Return the power of modal damping."""
    rates, e, damping = elastic(n, work, 3), elastic(n, work, 4), of_modes(n, number, DAMPING)
    strains(n, number, work)
    strain_rates(n, number, work)
    for k in range(width(n)):
        e[k] = damping[k] * rates[k]
    add_coupling(n, number, rates, 1, e)
    return -along(n, rates, e)
