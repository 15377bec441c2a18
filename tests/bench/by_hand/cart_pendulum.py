"""The cart-pendulum by hand: SI2 with 20 unknowns, and its two minimal equations."""

from __future__ import annotations

from math import cos, pi, radians, sin

import numpy as np
from numba import cfunc

from .ida import Equations, Settings, at_rest
from .loop import JACOBIAN, RESIDUAL, array, fast, matrix, numbers

M, I, m, a, g = 10.0, 1.0, 1.0, 0.3, 9.81
J = m * (2 * a) ** 2 / 12
STIFFNESS = 270.0
START = radians(20)
N = 20


@cfunc(RESIDUAL, cache=True, error_model="numpy")
def residual(t, yy, yp, rr, user):
    """y = (x1 y1 phi1 x2 y2 phi2, their velocities, mu, lambda)."""
    y, d, r, k = array(user, yy), array(user, yp), array(user, rr), numbers(user)[0]
    s, c = a * sin(y[5]), a * cos(y[5])
    r[0] = d[0] - y[6] + y[14]
    r[1] = d[1] - y[7] + y[12] + y[15]
    r[2] = d[2] - y[8] + y[13]
    r[3] = d[3] - y[9] - y[14]
    r[4] = d[4] - y[10] - y[15]
    r[5] = d[5] - y[11] - s * y[14] + c * y[15]
    r[6] = M * d[6] + k * y[0] + y[18]
    r[7] = M * d[7] + M * g + y[16] + y[19]
    r[8] = I * d[8] + y[17]
    r[9] = m * d[9] - y[18]
    r[10] = m * d[10] + m * g - y[19]
    r[11] = J * d[11] - s * y[18] + c * y[19]
    r[12] = y[1]
    r[13] = y[2]
    r[14] = y[0] - y[3] + c
    r[15] = y[1] - y[4] + s
    r[16] = y[7]
    r[17] = y[8]
    r[18] = y[6] - y[9] - s * y[11]
    r[19] = y[7] - y[10] + c * y[11]
    return 0


@cfunc(JACOBIAN, cache=True, error_model="numpy")
def jacobian(t, cj, yy, yp, rr, jac, user, work1, work2, work3):
    """dr/dy + cj dr/dy', column after column."""
    y, A = array(user, yy), matrix(user)
    s, c, w = a * sin(y[5]), a * cos(y[5]), y[11]
    for i in range(6):
        A[i + N * i] = cj
        A[i + N * (6 + i)] = -1.0
    A[6 + N * 6] = A[7 + N * 7] = cj * M
    A[8 + N * 8] = cj * I
    A[9 + N * 9] = A[10 + N * 10] = cj * m
    A[11 + N * 11] = cj * J
    for row, column in ((0, 12), (6, 16)):
        A[row + N * (column + 2)] = 1.0
        A[row + 1 + N * column] = A[row + 1 + N * (column + 3)] = 1.0
        A[row + 2 + N * (column + 1)] = 1.0
        A[row + 3 + N * (column + 2)] = A[row + 4 + N * (column + 3)] = -1.0
        A[row + 5 + N * (column + 2)] = -s
        A[row + 5 + N * (column + 3)] = c
    A[5 + N * 5] = cj - c * y[14] - s * y[15]
    A[11 + N * 5] = -c * y[18] - s * y[19]
    A[6] = numbers(user)[0]
    for row, column in ((12, 0), (16, 6)):
        A[row + N * (column + 1)] = A[row + 1 + N * (column + 2)] = 1.0
        A[row + 2 + N * column] = A[row + 3 + N * (column + 1)] = 1.0
        A[row + 2 + N * (column + 3)] = A[row + 3 + N * (column + 4)] = -1.0
        A[row + 2 + N * (column + 5)] = -s
        A[row + 3 + N * (column + 5)] = c
    A[18 + N * 5] = -c * w
    A[19 + N * 5] = -s * w
    return 0


def si2(stiffness: float = STIFFNESS) -> Equations:
    """The equations and their start: at rest, the bar at 20 degrees from hanging."""
    y, yp = np.zeros(N), np.zeros(N)
    y[3:6] = a * sin(START), -a * cos(START), START - pi / 2
    numbers = np.array([stiffness])
    equations = Equations(
        residual, jacobian, y, yp, np.arange(6), np.arange(6, 12), numbers=numbers,
        settings=Settings(newton=0.03, renewal=0.05),
    )  # fmt: skip
    return at_rest(equations, np.arange(16, N))


@fast
def pushed(t, y, k, push):
    """Rates of the cart's place x, the bar's angle from hanging, and their velocities, with a force on the cart."""
    x, theta, v, w = y
    s, c = sin(theta), cos(theta)
    force = m * a * w * w * s - k * x + push
    inertia = J + m * a * a
    determinant = (M + m) * inertia - (m * a * c) ** 2
    return np.array(
        [
            v,
            w,
            (inertia * force + m * a * c * m * g * a * s) / determinant,
            (-(M + m) * m * g * a * s - m * a * c * force) / determinant,
        ]
    )


@fast
def minimal(t, y, k):
    """The same without a force."""
    return pushed(t, y, k, 0.0)


def minimal_start() -> np.ndarray:
    """x, theta and their velocities at the start."""
    return np.array([0.0, START, 0.0, 0.0])


def places(y: np.ndarray) -> np.ndarray:
    """Coordinates of cart and bar, rows of (x1 y1 phi1 x2 y2 phi2), from rows of minimal ones."""
    x, theta, zero = y[:, 0], y[:, 1], np.zeros(len(y))
    return np.stack([x, zero, zero, x + a * np.sin(theta), -a * np.cos(theta), theta - pi / 2], axis=1)
