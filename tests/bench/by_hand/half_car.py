"""The half car by hand: 18 unknowns for IDA with a dense matrix, which are its minimal equations too (it has no joints)."""

from __future__ import annotations

from math import cos, pi, sin, sqrt

import numpy as np
from numba import cfunc

from .ida import Equations, Settings
from .loop import JACOBIAN, RESIDUAL, array, fast, matrix, numbers

V, N = 9, 18
"""Where the velocities begin, and the number of unknowns."""
MASS = (1200.0, 1200.0, 1800.0, 40.0, 40.0, 1.5, 40.0, 40.0, 1.5)
"""x, y and phi of chassis, front arm and rear arm."""
PLACES = (0.0, 0.60, 0.0, 1.45, 0.31, 0.0, -1.25, 0.31, 0.0)
G, SPEED = 9.81, 15.0
TURN, TURN_RATE = 1000.0, 10.0
"""Of a pair of bushings: N m/rad, N m s/rad."""
SPRING, DAMPER, LENGTH = 60e3, 5e3, 0.45
TYRE, TYRE_RATE, WHEELBASE = 200e3, 500.0, 2.7
CORNERS = (2 / SPEED, WHEELBASE / SPEED, (WHEELBASE + 2) / SPEED)
"""Where the wheels leave and meet the bump, s."""


@fast
def between(y, i, a, b, a0, b0):
    """Arms in ground axes of the points (a, b) of body i and (a0, b0) of the chassis, their distance d and its rate d'."""
    s, c, s0, c0 = sin(y[3 * i + 2]), cos(y[3 * i + 2]), sin(y[2]), cos(y[2])
    x, z, x0, z0 = a * c - b * s, a * s + b * c, a0 * c0 - b0 * s0, a0 * s0 + b0 * c0
    v, w, w0 = V + 3 * i, y[V + 3 * i + 2], y[V + 2]
    dx, dz = y[3 * i] + x - y[0] - x0, y[3 * i + 1] + z - y[1] - z0
    vx, vz = y[v] - z * w - y[V] + z0 * w0, y[v + 1] + x * w - y[V + 1] - x0 * w0
    return x, z, x0, z0, dx, dz, vx, vz


@fast
def pull_apart(f, first, sign, i, arms, fx, fz):
    """A force on body i and its opposite on the chassis."""
    x, z, x0, z0 = arms
    f[first + 3 * i] += sign * fx
    f[first + 3 * i + 1] += sign * fz
    f[first + 3 * i + 2] += sign * (x * fz - z * fx)
    f[first] -= sign * fx
    f[first + 1] -= sign * fz
    f[first + 2] -= sign * (x0 * fz - z0 * fx)


@fast
def spring(load, dx, dz, vx, vz):
    """Of a main spring: direction n, length L, L', and the force by which it pushes its ends apart."""
    length = sqrt(dx * dx + dz * dz)
    nx, nz = dx / length, dz / length
    rate = nx * vx + nz * vz
    return nx, nz, length, rate, load - SPRING * (length - LENGTH) - DAMPER * rate


@fast
def side(t, y, f, first, sign, i, seat, load, preload, tyre_load, behind, k, c):
    """Bushings, main spring and tyre of one arm."""
    x, z, x0, z0, dx, dz, vx, vz = between(y, i, 0.35, 0.04, seat + 0.30, -0.25)
    pull_apart(f, first, sign, i, (x, z, x0, z0), -k * dx - c * vx, preload - k * dz - c * vz)
    turn = -TURN * (y[3 * i + 2] - y[2]) - TURN_RATE * (y[V + 3 * i + 2] - y[V + 2])
    f[first + 3 * i + 2] += sign * turn
    f[first + 2] -= sign * turn
    x, z, x0, z0, dx, dz, vx, vz = between(y, i, 0.05, 0.04, seat, 0.20)
    nx, nz, _, _, force = spring(load, dx, dz, vx, vz)
    pull_apart(f, first, sign, i, (x, z, x0, z0), force * nx, force * nz)
    road = pi * min(max(SPEED * t - behind, 0.0), 2.0)
    s, c = sin(y[3 * i + 2]), cos(y[3 * i + 2])
    x, z = -0.10 * c + 0.01 * s, -0.10 * s - 0.01 * c
    rise, rising = y[3 * i + 1] + z - 0.30, y[V + 3 * i + 1] + x * y[V + 3 * i + 2]
    force = tyre_load + TYRE * (0.05 * (1 - cos(road)) - rise) + TYRE_RATE * (0.05 * pi * SPEED * sin(road) - rising)
    f[first + 3 * i + 1] += sign * force
    f[first + 3 * i + 2] += sign * x * force


@fast
def forces(t, y, f, first, sign, k, c):
    """All forces, times a sign, added to f from a place on."""
    for i in (1, 4, 7):
        f[first + i] -= sign * MASS[i] * G
    side(t, y, f, first, sign, 1, 1.50, 9003.4, 3088.333333, 6307.466667, 0.0, k, c)
    side(t, y, f, first, sign, 2, -1.20, 8916.2, 3059.266667, 6249.333333, WHEELBASE, k, c)


@fast
def pull_apart_matrix(y, A, i, arms, fx, fz, by_d, by_v):
    """Partial derivatives of what a force adds to the residual; of the force by d and d', 2 x 2 row after row."""
    dxx, dxz, dzx, dzz = by_d
    vxx, vxz, vzx, vzz = by_v
    for own in range(2):
        x, z = arms[2 * own], arms[2 * own + 1]
        row, sign = V + 3 * i * (1 - own), 1.0 - 2.0 * own
        A[row + 2 + N * (row - V + 2)] += sign * (x * fx + z * fz)
        for other in range(2):
            ox, oz = arms[2 * other], arms[2 * other + 1]
            column, both = 3 * i * (1 - other), sign * (1.0 - 2.0 * other)
            w = y[V + column + 2]
            for j in range(3):
                # how d changes with this coordinate, and d' with it and with its velocity
                qx, qz = (1.0, 0.0) if j == 0 else (0.0, 1.0) if j == 1 else (-oz, ox)
                rx, rz = (-ox * w, -oz * w) if j == 2 else (0.0, 0.0)
                gx = dxx * qx + dxz * qz + vxx * rx + vxz * rz
                gz = dzx * qx + dzz * qz + vzx * rx + vzz * rz
                hx, hz = vxx * qx + vxz * qz, vzx * qx + vzz * qz
                k, l = row + N * (column + j), row + N * (V + column + j)
                A[k] -= both * gx
                A[k + 1] -= both * gz
                A[k + 2] -= both * (x * gz - z * gx)
                A[l] -= both * hx
                A[l + 1] -= both * hz
                A[l + 2] -= both * (x * hz - z * hx)


@fast
def side_matrix(t, y, A, i, seat, load, preload, tyre_load, behind, k, c):
    """Partial derivatives of what one arm's forces add to the residual."""
    x, z, x0, z0, dx, dz, vx, vz = between(y, i, 0.35, 0.04, seat + 0.30, -0.25)
    fx, fz = -k * dx - c * vx, preload - k * dz - c * vz
    pull_apart_matrix(y, A, i, (x, z, x0, z0), fx, fz, (-k, 0.0, 0.0, -k), (-c, 0.0, 0.0, -c))
    for row, column, sign in ((i, i, 1.0), (i, 0, -1.0), (0, i, -1.0), (0, 0, 1.0)):
        A[V + 3 * row + 2 + N * (3 * column + 2)] += sign * TURN
        A[V + 3 * row + 2 + N * (V + 3 * column + 2)] += sign * TURN_RATE
    x, z, x0, z0, dx, dz, vx, vz = between(y, i, 0.05, 0.04, seat, 0.20)
    nx, nz, length, rate, force = spring(load, dx, dz, vx, vz)
    across, gx = force / length, -SPRING * nx - DAMPER * (vx - rate * nx) / length
    gz = -SPRING * nz - DAMPER * (vz - rate * nz) / length
    by_d = across * (1 - nx * nx) + nx * gx, -across * nx * nz + nx * gz, -across * nx * nz + nz * gx, across * (1 - nz * nz) + nz * gz  # fmt: skip
    by_v = (-DAMPER * nx * nx, -DAMPER * nx * nz, -DAMPER * nx * nz, -DAMPER * nz * nz)
    pull_apart_matrix(y, A, i, (x, z, x0, z0), force * nx, force * nz, by_d, by_v)
    road = pi * min(max(SPEED * t - behind, 0.0), 2.0)
    s, c = sin(y[3 * i + 2]), cos(y[3 * i + 2])
    x, z, w = -0.10 * c + 0.01 * s, -0.10 * s - 0.01 * c, y[V + 3 * i + 2]
    rise, rising = y[3 * i + 1] + z - 0.30, y[V + 3 * i + 1] + x * w
    force = tyre_load + TYRE * (0.05 * (1 - cos(road)) - rise) + TYRE_RATE * (0.05 * pi * SPEED * sin(road) - rising)
    by_phi = TYRE * x - TYRE_RATE * z * w
    row = V + 3 * i + 1
    for column, by in ((3 * i + 1, TYRE), (3 * i + 2, by_phi), (V + 3 * i + 1, TYRE_RATE), (V + 3 * i + 2, TYRE_RATE * x)):  # fmt: skip
        A[row + N * column] += by
        A[row + 1 + N * column] += x * by
    A[row + 1 + N * (3 * i + 2)] += z * force


@cfunc(RESIDUAL, cache=True, error_model="numpy")
def residual(t, yy, yp, rr, user):
    """y = (x y phi of chassis, front and rear arm, their velocities)."""
    y, d, r, p = array(user, yy), array(user, yp), array(user, rr), numbers(user)
    for i in range(V):
        r[i] = d[i] - y[V + i]
        r[V + i] = MASS[i] * d[V + i]
    forces(t, y, r, V, -1.0, p[0], p[1])
    return 0


@cfunc(JACOBIAN, cache=True, error_model="numpy")
def jacobian(t, cj, yy, yp, rr, jac, user, work1, work2, work3):
    """dr/dy + cj dr/dy', column after column."""
    y, A, p = array(user, yy), matrix(user), numbers(user)
    for i in range(V):
        A[i + N * i] = cj
        A[i + N * (V + i)] = -1.0
        A[(N + 1) * (V + i)] = MASS[i] * cj
    side_matrix(t, y, A, 1, 1.50, 9003.4, 3088.333333, 6307.466667, 0.0, p[0], p[1])
    side_matrix(t, y, A, 2, -1.20, 8916.2, 3059.266667, 6249.333333, WHEELBASE, p[0], p[1])
    return 0


def numbers_of(k_b: float, zeta: float) -> np.ndarray:
    """Stiffness and damping of a pair of bushings."""
    return np.array([2 * k_b, 2 * zeta * sqrt(2 * k_b * 40)])


def si2(k_b: float, zeta: float) -> Equations:
    """The equations and their start: at rest in equilibrium."""
    start, k = minimal_start(), numbers_of(k_b, zeta)
    return Equations(
        residual, jacobian, start, minimal(0.0, start, *k), np.arange(V), np.arange(V, N), numbers=k, breakpoints=CORNERS,
        settings=Settings(renewal=0.05),
    )  # fmt: skip


@fast
def minimal(t, y, k, c):
    """Rates of the coordinates and velocities."""
    rates = np.zeros(N)
    rates[:V] = y[V:]
    forces(t, y, rates, V, 1.0, k, c)
    for i in range(V):
        rates[V + i] /= MASS[i]
    return rates


@fast
def minimal_jacobian(t, y, k, c):
    """Partial derivatives of those rates."""
    A = np.zeros(N * N)
    side_matrix(t, y, A, 1, 1.50, 9003.4, 3088.333333, 6307.466667, 0.0, k, c)
    side_matrix(t, y, A, 2, -1.20, 8916.2, 3059.266667, 6249.333333, WHEELBASE, k, c)
    derivatives = -A.reshape((N, N)).T.copy()
    for i in range(V):
        derivatives[i, V + i] = 1.0
        derivatives[V + i] /= MASS[i]
    return derivatives


def minimal_start() -> np.ndarray:
    """At rest in equilibrium."""
    return np.array([*PLACES, *np.zeros(V)])
