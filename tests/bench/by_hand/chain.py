"""The chain of rods by hand: SI2 with the unknowns of a rod and its pin side by side, so that the matrix is banded."""

from __future__ import annotations

from math import cos, sin

import numpy as np
from numba import cfunc

from .ida import Equations, Settings
from .loop import JACOBIAN, RESIDUAL, array, matrix, numbers, size

m, g = 0.1, 9.81
"""Mass of a rod, gravity."""
B, BAND = 10, 7
"""Unknowns of a rod: mu (2) and lambda (2) of the pin at its left end, (x y phi), their velocities; the diagonals
beside the main one."""
COLUMN = 3 * BAND
"""From an entry of the banded matrix to its right neighbour in the same row (a column holds 3 BAND + 1 values)."""


@cfunc(RESIDUAL, cache=True, error_model="numpy")
def residual(t, yy, yp, rr, user):
    """Pin k: the right end of rod k - 1 and the left end of rod k coincide."""
    y, d, r, n = array(user, yy), array(user, yp), array(user, rr), size(user)
    h = numbers(user)[0]
    I = m * h * h / 3
    x, z, vx, vz = 0.0, 0.0, 0.0, 0.0  # right end of the rod before
    for i in range(0, n, B):
        s, c = h * sin(y[i + 6]), h * cos(y[i + 6])
        w = y[i + 9]
        r[i] = y[i + 4] - c - x
        r[i + 1] = y[i + 5] - s - z
        r[i + 2] = y[i + 7] + s * w - vx
        r[i + 3] = y[i + 8] - c * w - vz
        mu_x, mu_z, lam_x, lam_z = 0.0, 0.0, 0.0, 0.0
        if i + B < n:
            mu_x, mu_z, lam_x, lam_z = y[i + B], y[i + B + 1], y[i + B + 2], y[i + B + 3]
        r[i + 4] = d[i + 4] - y[i + 7] + y[i] - mu_x
        r[i + 5] = d[i + 5] - y[i + 8] + y[i + 1] - mu_z
        r[i + 6] = d[i + 6] - w + s * (y[i] + mu_x) - c * (y[i + 1] + mu_z)
        r[i + 7] = m * d[i + 7] + y[i + 2] - lam_x
        r[i + 8] = m * d[i + 8] + m * g + y[i + 3] - lam_z
        r[i + 9] = I * d[i + 9] + s * (y[i + 2] + lam_x) - c * (y[i + 3] + lam_z)
        x, z, vx, vz = y[i + 4] + c, y[i + 5] + s, y[i + 7] - s * w, y[i + 8] + c * w
    return 0


@cfunc(JACOBIAN, cache=True, error_model="numpy")
def jacobian(t, cj, yy, yp, rr, jac, user, work1, work2, work3):
    """dr/dy + cj dr/dy': entry (i, j) stands at i + COLUMN j of the values from the first diagonal on."""
    y, A, n = array(user, yy), matrix(user), size(user)
    h = numbers(user)[0]
    I = m * h * h / 3
    for i in range(0, n, B):
        s, c = h * sin(y[i + 6]), h * cos(y[i + 6])
        w = y[i + 9]
        q, v = i + COLUMN * (i + 4), i + COLUMN * (i + 7)
        of_phi, of_w = q + 2 * COLUMN, v + 2 * COLUMN
        A[q] = A[q + 1 + COLUMN] = A[v + 2] = A[v + 3 + COLUMN] = 1.0
        A[of_phi] = s
        A[of_phi + 1] = -c
        A[of_w + 2] = s
        A[of_w + 3] = -c
        A[of_phi + 2] = c * w
        A[of_phi + 3] = s * w
        A[q + 4] = A[q + 5 + COLUMN] = A[of_phi + 6] = cj
        A[v + 4] = A[v + 5 + COLUMN] = A[of_w + 6] = -1.0
        A[v + 7] = A[v + 8 + COLUMN] = m * cj
        A[of_w + 9] = I * cj
        of_mu, of_lam = i + COLUMN * i, i + COLUMN * (i + 2)
        A[of_mu + 4] = A[of_mu + 5 + COLUMN] = A[of_lam + 7] = A[of_lam + 8 + COLUMN] = 1.0
        A[of_mu + 6] = s
        A[of_mu + 6 + COLUMN] = -c
        A[of_lam + 9] = s
        A[of_lam + 9 + COLUMN] = -c
        mu_x, mu_z, lam_x, lam_z = y[i], y[i + 1], y[i + 2], y[i + 3]
        if i + B < n:
            mu_x += y[i + B]
            mu_z += y[i + B + 1]
            lam_x += y[i + B + 2]
            lam_z += y[i + B + 3]
            of_mu += COLUMN * B
            of_lam += COLUMN * B
            A[of_mu + 4] = A[of_mu + 5 + COLUMN] = A[of_lam + 7] = A[of_lam + 8 + COLUMN] = -1.0
            A[of_mu + 6] = s
            A[of_mu + 6 + COLUMN] = -c
            A[of_lam + 9] = s
            A[of_lam + 9 + COLUMN] = -c
            A[q + B] = A[q + B + 1 + COLUMN] = A[v + B + 2] = A[v + B + 3 + COLUMN] = -1.0
            A[of_phi + B] = s
            A[of_phi + B + 1] = -c
            A[of_w + B + 2] = s
            A[of_w + B + 3] = -c
            A[of_phi + B + 2] = c * w
            A[of_phi + B + 3] = s * w
        A[of_phi + 6] += c * mu_x + s * mu_z
        A[of_phi + 9] = c * lam_x + s * lam_z
    return 0


def si2(rods: int, length: float) -> Equations:
    """The equations and their start: at rest, all rods horizontal; the chain starts to fall about its first pin."""
    from .chain_minimal import accelerations

    n, h = B * rods, length / 2
    first = np.arange(0, n, B)
    y, yp = np.zeros(n), np.zeros(n)
    y[first + 4] = h * (2 * np.arange(rods) + 1)
    spin, force = np.empty(rods), np.zeros((rods + 1, 2))
    accelerations(np.zeros(rods), np.zeros(rods), h, spin, force)
    yp[first + 9] = spin
    yp[first + 8] = h * (2 * np.cumsum(spin) - spin)
    y[first + 2], y[first + 3] = -force[:-1].T
    positions = (first[:, None] + np.arange(4, 7)).ravel()
    return Equations(
        residual, jacobian, y, yp, positions, positions + 3, band=BAND,
        numbers=np.array([h]), settings=Settings(renewal=0.05, suppressed=True),
    )  # fmt: skip
