"""Derivatives of the forces and of inertia of a flexible body (`stiffmbs.compile.machine.flexible.inertia`).

Matrices are by rows: three of the frame's position, three of its rotation, and the modes. Derivatives by the pose have
4 + n columns, the quaternion and the modes; those by velocities 3 + n, the angular velocity and modal velocities.
"""

from stiffmbs.compile.machine.flexible.elastic import add_elastic_slopes
from stiffmbs.compile.machine.flexible.sums import (
    ACCELERATIONS,
    AXIAL,
    AXIAL_RATE,
    AXIAL_RATE_OF_Z,
    FIRST,
    FIRST_RATE,
    along,
    body_view,
    by_accelerations,
    by_coordinates,
    by_velocities,
    centrifugal,
    column,
    combine,
    elastic,
    inertia_by_mode,
    moment_of_rotation,
    moments,
    moments_view,
    pairs,
    rigid_momentum,
    take_acceleration_sums,
    width,
)
from stiffmbs.compile.machine.native.access import compiled, room, shifted
from stiffmbs.compile.machine.native.vectors import clear, cross, times, transposed_times


@compiled
def by_quaternion(turn, j, y):
    """Compute the small rotation about ground axes by a quaternion component, column j of E."""
    e0, e1, e2, e3 = turn[9], turn[10], turn[11], turn[12]
    if j == 0:
        y[0], y[1], y[2] = -e1, -e2, -e3
    elif j == 1:
        y[0], y[1], y[2] = e0, e3, -e2
    elif j == 2:
        y[0], y[1], y[2] = -e3, e0, e1
    else:
        y[0], y[1], y[2] = e2, -e1, e0


@compiled
def _by_rotation(n, turn, d, of_frame, field, sign, work, to):
    """Compute the derivatives by the quaternion of a rotated vector A `of_frame` and of moments by a field in ground axes."""
    x, y, z, turned, D = room(3), room(3), room(3), room(3), by_coordinates(n, work, FIRST)
    times(turn, of_frame, z)
    h = room(3)
    for i in range(3):
        h[i] = sign * z[i]
    for j in range(4):
        by_quaternion(turn, j, x)
        cross(x, h, y)
        cross(field, x, z)
        transposed_times(turn, z, turned)
        cross(d, turned, z)
        for i in range(3):
            to[(4 + n) * i + j] = y[i]
            to[(4 + n) * (3 + i) + j] = z[i]
        for k in range(n):
            along_D = D[k] * turned[0] + D[width(n) + k] * turned[1] + D[2 * width(n) + k] * turned[2]
            to[(4 + n) * (6 + k) + j] = along_D


@compiled
def _by_angular_velocity(n, A, w, d, s, I, K, f_u):
    """Compute the derivatives of the forces on the frame by the angular velocity; s is twice the rate of d."""
    x, y, z, turned = room(3), room(3), room(3), room(3)
    for c in range(3):
        for i in range(3):
            x[i] = 1.0 if i == c else 0.0
        rigid_momentum(w, d, s, y)
        cross(x, y, z)
        cross(x, d, y)
        cross(w, y, turned)
        for i in range(3):
            z[i] += turned[i]
        times(A, z, y)
        for i in range(3):
            f_u[(3 + n) * i + c] = -y[i]
        times(I, w, y)
        cross(x, y, z)
        times(I, x, y)
        cross(w, y, turned)
        moment_of_rotation(K, x, y)
        for i in range(3):
            f_u[(3 + n) * (3 + i) + c] = -z[i] - turned[i] - 2.0 * y[i]


@compiled
def _mode_with_rates(n, number, l, rates, P):
    """Compute the derivative of sum m r u'^T by a modal coordinate, from modal velocities or accelerations."""
    for i in range(9):
        P[i] = along(n, shifted(pairs(n, number, l), width(n) * i), rates)


@compiled
def _of_frame_by_mode(n, l, number, A, w, g, work, f_q, f_u):
    """Compute the derivatives of the forces on the frame by a modal coordinate and its velocity."""
    N, P, D, T, s, x, y, z, turned = (
        room(9), room(9), room(3), room(3), room(3), room(3), room(3), room(3), room(3)
    )  # fmt: skip
    column(n, 3, by_coordinates(n, work, FIRST), l, D)
    column(n, 3, by_velocities(n, work, FIRST_RATE), l, T)
    cross(w, D, x)
    for i in range(3):
        z[i] = x[i] + 2.0 * T[i]
        s[i] = T[i] + x[i]
    cross(w, z, y)
    times(A, y, z)
    times(A, s, turned)
    for i in range(3):
        f_q[(4 + n) * i + 4 + l] = -z[i]
        f_u[(3 + n) * i + 3 + l] = -2.0 * turned[i]
    column(n, 9, by_coordinates(n, work, 0), l, N)
    inertia_by_mode(N, w, x)
    cross(w, x, y)
    cross(D, g, z)
    _mode_with_rates(n, number, l, elastic(n, work, 1), P)
    moment_of_rotation(P, w, x)
    moment_of_rotation(N, w, turned)
    column(n, 3, by_velocities(n, work, AXIAL_RATE), l, s)
    column(n, 3, by_velocities(n, work, AXIAL_RATE_OF_Z), l, T)
    for i in range(3):
        f_q[(4 + n) * (3 + i) + 4 + l] = -y[i] - 2.0 * x[i] + z[i]
        f_u[(3 + n) * (3 + i) + 3 + l] = -2.0 * (turned[i] + s[i] - T[i])


@compiled
def _of_mode(n, l, number, w, g, work, f_q, f_u):
    """Compute the derivatives of all modal inertial forces by a modal coordinate and its velocity, and of one by w."""
    N, x, axial, c, twice, row = room(9), room(3), room(3), room(6), room(3), elastic(n, work, 2)
    column(n, 9, by_coordinates(n, work, 0), l, N)
    inertia_by_mode(N, w, x)
    column(n, 3, by_velocities(n, work, AXIAL_RATE_OF_Z), l, axial)
    for i in range(3):
        f_u[(3 + n) * (6 + l) + i] = x[i] - 2.0 * axial[i]
        twice[i] = -2.0 * w[i]
    centrifugal(w, c)
    of_pairs = pairs(n, number, l)
    clear(2 * width(n), row)
    combine(n, 6, c, 1, of_pairs, row)
    combine(n, 3, g, 1, shifted(of_pairs, FIRST * width(n)), row)
    combine(n, 3, twice, 1, shifted(of_pairs, (FIRST + 3) * width(n)), shifted(row, width(n)))
    for k in range(n):
        f_q[(4 + n) * (6 + k) + 4 + l] = row[k]
        f_u[(3 + n) * (6 + k) + 3 + l] = row[width(n) + k]


@compiled
def add_force_slopes(n, number, index, turn, u, work, f_q, f_u):
    """Compute the derivatives of the forces by the pose and by velocities."""
    w, gravity, m = shifted(u, int(index[1]) + 3), body_view(number).gravity, moments_view(moments(n, work))
    s, g, x, y = room(3), room(3), room(3), room(3)
    transposed_times(turn, gravity, g)
    for i in range(3):
        s[i] = 2.0 * m.rate[i]
    rigid_momentum(w, m.d, s, x)
    cross(w, x, y)
    for i in range(3):
        y[i] += along(n, by_velocities(n, work, FIRST_RATE + i), elastic(n, work, 1))
    _by_rotation(n, turn, m.d, y, gravity, -1.0, work, f_q)
    _by_angular_velocity(n, turn, w, m.d, s, m.I, m.symmetric, f_u)
    for l in range(n):
        _of_frame_by_mode(n, l, number, turn, w, g, work, f_q, f_u)
        _of_mode(n, l, number, w, g, work, f_q, f_u)
    add_elastic_slopes(n, number, work, f_q, f_u)


@compiled
def add_inertia_slopes(n, number, index, turn, a, work, m_q):
    """Compute the derivatives by the pose of this mass matrix times accelerations."""
    v, w, m = shifted(a, int(index[1])), shifted(a, int(index[1]) + 3), moments_view(moments(n, work))
    s, b, x, y, z, N, P, D, T = room(3), room(3), room(3), room(3), room(3), room(9), room(9), room(3), room(3)
    take_acceleration_sums(n, number, index, a, work)
    rates, row = elastic(n, work, ACCELERATIONS), elastic(n, work, 2)
    for i in range(3):
        s[i] = along(n, by_coordinates(n, work, FIRST + i), rates)
    transposed_times(turn, v, b)
    rigid_momentum(w, m.d, s, x)
    _by_rotation(n, turn, m.d, x, v, 1.0, work, m_q)
    for l in range(n):
        column(n, 3, by_coordinates(n, work, FIRST), l, D)
        column(n, 3, by_accelerations(n, work), l, T)
        cross(w, D, x)
        for i in range(3):
            x[i] += T[i]
        times(turn, x, y)
        cross(D, b, z)
        column(n, 9, by_coordinates(n, work, 0), l, N)
        inertia_by_mode(N, w, x)
        _mode_with_rates(n, number, l, rates, P)
        of_pairs = pairs(n, number, l)
        clear(width(n), row)
        combine(n, 3, w, 1, shifted(of_pairs, AXIAL * width(n)), row)
        combine(n, 3, b, 1, shifted(of_pairs, FIRST * width(n)), row)
        for k in range(n):
            m_q[(4 + n) * (6 + k) + 4 + l] = row[k]
        for i in range(3):
            m_q[(4 + n) * i + 4 + l] = y[i]
            m_q[(4 + n) * (3 + i) + 4 + l] = z[i] + x[i] + P[AXIAL + i]
