"""Derivatives of the forces and of inertia of a flexible body (`stiffmbs.compile.machine.native.flexible.inertia`).

Matrices are by rows: three of the frame's position, three of its rotation, and the modes. Derivatives by the pose have
4 + n columns, the quaternion and the modes; those by velocities 3 + n, the angular velocity and modal velocities.
"""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled, room, shifted
from stiffmbs.compile.machine.native.flexible.elastic import add_elastic_slopes
from stiffmbs.compile.machine.native.flexible.sums import (
    axial,
    body_view,
    centrifugal,
    cross,
    dot,
    first_moment,
    first_moment_of_mode,
    first_rate,
    inertia_by_mode,
    mode_with_rates,
    moment_of_rotation,
    moment_rate_of_mode,
    of_mode,
    pair,
    pair_view,
    rigid_momentum,
    second_moments,
    sum_of_mode,
    sums,
    take_acceleration_sums,
    times,
    trace,
    transposed_times,
    velocity,
)


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
def _by_rotation(n, number, turn, d, of_frame, field, sign, work, to):
    """Compute the derivatives by the quaternion of a rotated vector A `of_frame` and of moments by a field in ground axes."""
    x, y, z, turned, D = room(3), room(3), room(3), room(3), room(3)
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
            first_moment_of_mode(n, k, number, work, D)
            to[(4 + n) * (6 + k) + j] = dot(D, turned)


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
def _of_frame_by_mode(n, l, number, index, A, u, w, g, work, f_q, f_u):
    """Compute the derivatives of the forces on the frame by a modal coordinate and its velocity."""
    N, P, D, s, x, y, z, turned = room(9), room(9), room(3), room(3), room(3), room(3), room(3), room(3)
    first_moment_of_mode(n, l, number, work, D)
    rates = pair_view(of_mode(sums(n, work, 1), l))
    cross(w, D, x)
    for i in range(3):
        z[i] = x[i] + 2.0 * rates.T[i]
        s[i] = rates.T[i] + x[i]
    cross(w, z, y)
    times(A, y, z)
    times(A, s, turned)
    for i in range(3):
        f_q[(4 + n) * i + 4 + l] = -z[i]
        f_u[(3 + n) * i + 3 + l] = -2.0 * turned[i]
    sum_of_mode(n, l, number, work, N)
    inertia_by_mode(N, w, x)
    cross(w, x, y)
    cross(D, g, z)
    mode_with_rates(n, l, number, index, u, P)
    moment_of_rotation(P, w, x)
    moment_of_rotation(N, w, turned)
    moment_rate_of_mode(n, l, work, s)
    for i in range(3):
        f_q[(4 + n) * (3 + i) + 4 + l] = -y[i] - 2.0 * x[i] + z[i]
        f_u[(3 + n) * (3 + i) + 3 + l] = -2.0 * (turned[i] + s[i])


@compiled
def _of_mode(n, l, number, w, g, work, f_q, f_u):
    """Compute the derivatives of all modal inertial forces by a modal coordinate and its velocity, and of one by w."""
    N = room(9)
    sum_of_mode(n, l, number, work, N)
    x = pair_view(of_mode(sums(n, work, 1), l)).axial
    for i in range(3):
        total = 2.0 * w[i] * trace(N) - 2.0 * x[i]
        for j in range(3):
            total -= w[j] * (N[3 * i + j] + N[3 * j + i])
        f_u[(3 + n) * (6 + l) + i] = total
    for k in range(n):
        of_pair = pair_view(pair(n, number, l, k))
        f_q[(4 + n) * (6 + k) + 4 + l] = centrifugal(of_pair.ZW, w) + dot(of_pair.T, g)
        f_u[(3 + n) * (6 + k) + 3 + l] = -2.0 * dot(w, of_pair.axial)


@compiled
def add_force_slopes(n, number, index, q, turn, u, work, f_q, f_u):
    """Compute the derivatives of the forces by the pose and by velocities."""
    w, gravity = shifted(u, int(index[1]) + 3), body_view(number).gravity
    d, s, g, x, y, I, K = room(3), room(3), room(3), room(3), room(3), room(9), room(9)
    first_moment(n, number, index, q, work, d)
    first_rate(n, number, index, u, work, s)
    transposed_times(turn, gravity, g)
    second_moments(n, number, index, q, u, work, I, K)
    for i in range(3):
        s[i] *= 2.0
    rigid_momentum(w, d, s, x)
    cross(w, x, y)
    for k in range(n):
        T = pair_view(of_mode(sums(n, work, 1), k)).T
        for i in range(3):
            y[i] += u[velocity(index, k)] * T[i]
    _by_rotation(n, number, turn, d, y, gravity, -1.0, work, f_q)
    _by_angular_velocity(n, turn, w, d, s, I, K, f_u)
    for l in range(n):
        _of_frame_by_mode(n, l, number, index, turn, u, w, g, work, f_q, f_u)
        _of_mode(n, l, number, w, g, work, f_q, f_u)
    add_elastic_slopes(n, number, index, q, u, work, f_q, f_u)


@compiled
def add_inertia_slopes(n, number, index, q, turn, a, work, m_q):
    """Compute the derivatives by the pose of this mass matrix times accelerations."""
    v, w = shifted(a, int(index[1])), shifted(a, int(index[1]) + 3)
    d, s, b, x, y, z, N, P = room(3), room(3), room(3), room(3), room(3), room(3), room(9), room(9)
    take_acceleration_sums(n, number, index, a, work)
    first_moment(n, number, index, q, work, d)
    first_rate(n, number, index, a, work, s)
    transposed_times(turn, v, b)
    rigid_momentum(w, d, s, x)
    _by_rotation(n, number, turn, d, x, v, 1.0, work, m_q)
    D = room(3)
    for l in range(n):
        first_moment_of_mode(n, l, number, work, D)
        T = pair_view(of_mode(sums(n, work, 2), l)).T
        cross(w, D, x)
        for i in range(3):
            x[i] += T[i]
        times(turn, x, y)
        cross(D, b, z)
        sum_of_mode(n, l, number, work, N)
        inertia_by_mode(N, w, x)
        mode_with_rates(n, l, number, index, a, P)
        for k in range(n):
            of_pair = pair_view(pair(n, number, l, k))
            Z = of_pair.ZW
            by_q = w[0] * axial(Z, 0) + w[1] * axial(Z, 1) + w[2] * axial(Z, 2)
            m_q[(4 + n) * (6 + k) + 4 + l] = by_q + dot(of_pair.T, b)
        for i in range(3):
            m_q[(4 + n) * i + 4 + l] = y[i]
            m_q[(4 + n) * (3 + i) + 4 + l] = z[i] + x[i] + axial(P, i)
