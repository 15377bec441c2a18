"""The cart-pendulum over 10 s with 1001 output points, against residual and Jacobian written by hand."""

from __future__ import annotations

from functools import partial
from math import cos, pi, radians, sin
from typing import Any

import numpy as np
from numba import njit

from ...describe.model import ModelData
from ...describe.scene import read_scene
from ...show.run import prepare
from ..measure import Contestant

SCENE = """
name: Cart-pendulum
gravity: [0, -9.81]
bodies:
  cart: {mass: 10, inertia: 1}
  bar: {mass: 1, inertia: 0.03, position: [0.3*sin(20 deg), -0.3*cos(20 deg)], angle: -70 deg}
joints:
  rail: {type: prismatic, i: cart, j: ground}
  hinge: {type: revolute, i: cart, j: {body: bar, point: [-0.3, 0]}}
forces:
  spring: {type: spring_damper, i: cart, j: {body: ground, point: [-1, 0]}, stiffness: 270, free_length: 1}
run: {duration: 10, points: 1001}
"""
X_AT_END, THETA_AT_END = 0.005385525470510, 0.298328485255
M, I, m, a, k, g = 10.0, 1.0, 1.0, 0.3, 270.0, 9.81
J = m * (2 * a) ** 2 / 12


@njit(error_model="numpy")
def residual(t, y, yp, r):
    """SI2 of the cart-pendulum by hand: y = (x1 y1 phi1 x2 y2 phi2, velocities, mu, lambda)."""
    s, c = a * sin(y[5]), a * cos(y[5])
    r[0] = yp[0] - y[6] + y[14]
    r[1] = yp[1] - y[7] + y[12] + y[15]
    r[2] = yp[2] - y[8] + y[13]
    r[3] = yp[3] - y[9] - y[14]
    r[4] = yp[4] - y[10] - y[15]
    r[5] = yp[5] - y[11] - s * y[14] + c * y[15]
    r[6] = M * yp[6] + k * y[0] + y[18]
    r[7] = M * yp[7] + M * g + y[16] + y[19]
    r[8] = I * yp[8] + y[17]
    r[9] = m * yp[9] - y[18]
    r[10] = m * yp[10] + m * g - y[19]
    r[11] = J * yp[11] - s * y[18] + c * y[19]
    r[12], r[13], r[14], r[15] = y[1], y[2], y[0] - y[3] + c, y[1] - y[4] + s
    r[16], r[17] = y[7], y[8]
    r[18], r[19] = y[6] - y[9] - s * y[11], y[7] - y[10] + c * y[11]


@njit(error_model="numpy")
def jacobian(t, y, yp, r, cj, A):
    """Its iteration matrix."""
    s, c, w = a * sin(y[5]), a * cos(y[5]), y[11]
    for i in range(6):
        A[i, i] = cj
        A[i, 6 + i] = -1
    A[6, 6] = A[7, 7] = cj * M
    A[8, 8] = cj * I
    A[9, 9] = A[10, 10] = cj * m
    A[11, 11] = cj * J
    for row, column in ((0, 12), (6, 16)):
        A[row, column + 2] = A[row + 1, column] = A[row + 1, column + 3] = A[row + 2, column + 1] = 1
        A[row + 3, column + 2] = A[row + 4, column + 3] = -1
        A[row + 5, column + 2], A[row + 5, column + 3] = -s, c
    A[5, 5] = cj - c * y[14] - s * y[15]
    A[11, 5] = -c * y[18] - s * y[19]
    A[6, 0] = k
    for row, column in ((12, 0), (16, 6)):
        A[row, column + 1] = A[row + 1, column + 2] = A[row + 2, column] = A[row + 3, column + 1] = 1
        A[row + 2, column + 3] = A[row + 3, column + 4] = -1
        A[row + 2, column + 5], A[row + 3, column + 5] = -s, c
    A[18, 5], A[19, 5] = -c * w, -s * w


def by_hand(rtol: float) -> float:
    """Solve with bare scikit-sundae; the error in the two coordinates at the end."""
    from sksundae.ida import IDA

    theta = radians(20)
    y, yp = np.zeros(20), np.zeros(20)
    y[3:6] = a * sin(theta), -a * cos(theta), theta - pi / 2
    A = np.zeros((20, 20))
    jacobian(0.0, y, yp, y, 0.0, A)
    block = np.zeros((10, 10))
    block[:6, :6] = np.diag([M, M, I, m, m, J])
    block[:6, 6:], block[6:, :6] = A[6:12, 16:], A[12:16, :6]
    solution = np.linalg.solve(block, [0, -M * g, 0, 0, -m * g, 0, 0, 0, 0, 0])
    yp[6:12], y[16:] = solution[:6], solution[6:]
    corrected = rtol * np.sqrt(20 / 12)
    atol = np.r_[np.full(12, corrected), np.full(8, 1e15)]
    ida = IDA(residual, jacfn=jacobian, rtol=corrected, atol=atol, max_num_steps=1_000_000)
    end = ida.solve(np.linspace(0, 10, 1001), y, yp).y[-1]
    return max(abs(end[0] - X_AT_END), abs(end[5] + pi / 2 - THETA_AT_END))


def compiled(scene: ModelData, **changes: Any) -> Contestant:
    """The integration of a compiled scene (compiling, assembling and reporting are outside, as for the yardstick)."""
    job = prepare(scene, **changes)

    def solve() -> float:
        end = job.integrate().q[-1]
        return max(abs(end[0] - X_AT_END), abs(end[5] + pi / 2 - THETA_AT_END))

    name = "bdf" if job.settings.solver == "bdf" else job.settings.scheme
    return Contestant(name, f"rtol {job.settings.rtol:g}", False, solve)


def contestants() -> list[Contestant]:
    """This package and the yardstick at three tolerances."""
    scene = read_scene(SCENE)
    found = []
    for rtol in (1e-6, 1e-8, 1e-10):
        found.append(Contestant("scikit-sundae by hand", f"rtol {rtol:g}", True, partial(by_hand, rtol)))
        found.append(compiled(scene, rtol=rtol))
        found.append(compiled(scene, rtol=rtol, solver="projected", scheme="dop853"))
    return found
