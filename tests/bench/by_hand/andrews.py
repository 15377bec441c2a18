"""Andrews' squeezing mechanism by hand: SI2 in absolute coordinates, 82 unknowns, a dense matrix."""

from __future__ import annotations

from math import cos, sin, sqrt

import numpy as np
from numba import cfunc

from . import andrews_minimal as given
from .ida import Equations, Settings, at_rest
from .loop import JACOBIAN, RESIDUAL, array, fast, matrix

V, MU, LAM, N = 21, 42, 62, 82
"""Where velocities and the multipliers of ten pins begin, behind the coordinates, and the number of unknowns."""


@fast
def end(y, r, pin, i, a, b, sign):
    """One body's end of a pin, its point (a, b): in both constraints, and with their multipliers on the body."""
    s, c, q, v = sin(y[3 * i + 2]), cos(y[3 * i + 2]), 3 * i, V + 3 * i
    x, z = sign * (a * c - b * s), sign * (a * s + b * c)
    mu, lam = MU + 2 * pin, LAM + 2 * pin
    r[mu] += sign * y[q] + x
    r[mu + 1] += sign * y[q + 1] + z
    r[lam] += sign * y[v] - z * y[v + 2]
    r[lam + 1] += sign * y[v + 1] + x * y[v + 2]
    r[q] += sign * y[mu]
    r[q + 1] += sign * y[mu + 1]
    r[q + 2] += x * y[mu + 1] - z * y[mu]
    r[v] += sign * y[lam]
    r[v + 1] += sign * y[lam + 1]
    r[v + 2] += x * y[lam + 1] - z * y[lam]


@fast
def end_matrix(y, A, pin, i, a, b, sign):
    """Its partial derivatives."""
    s, c, q, v = sin(y[3 * i + 2]), cos(y[3 * i + 2]), 3 * i, V + 3 * i
    x, z, w = sign * (a * c - b * s), sign * (a * s + b * c), y[v + 2]
    mu, lam = MU + 2 * pin, LAM + 2 * pin
    A[mu + N * q] = A[mu + 1 + N * (q + 1)] = A[lam + N * v] = A[lam + 1 + N * (v + 1)] = sign
    A[q + N * mu] = A[q + 1 + N * (mu + 1)] = A[v + N * lam] = A[v + 1 + N * (lam + 1)] = sign
    A[mu + N * (q + 2)] = A[lam + N * (v + 2)] = A[q + 2 + N * mu] = A[v + 2 + N * lam] = -z
    A[mu + 1 + N * (q + 2)] = A[lam + 1 + N * (v + 2)] = A[q + 2 + N * (mu + 1)] = A[v + 2 + N * (lam + 1)] = x
    A[lam + N * (q + 2)] = -x * w
    A[lam + 1 + N * (q + 2)] = -z * w
    A[q + 2 + N * (q + 2)] -= x * y[mu] + z * y[mu + 1]
    A[v + 2 + N * (q + 2)] -= x * y[lam] + z * y[lam + 1]


@cfunc(RESIDUAL, cache=True, error_model="numpy")
def residual(t, yy, yp, rr, user):
    """y = (x y phi of K1 .. K7, their velocities, mu, lambda); pins O F B A5 A7 E H P3 P4 P6."""
    y, d, r = array(user, yy), array(user, yp), array(user, rr)
    for i in range(21):
        r[i] = d[i] - y[V + i]
    for i in range(7):
        r[V + 3 * i] = given.MASS[i] * d[V + 3 * i]
        r[V + 3 * i + 1] = given.MASS[i] * d[V + 3 * i + 1]
        r[V + 3 * i + 2] = given.INERTIA[i] * d[V + 3 * i + 2]
    for i in range(MU, N):
        r[i] = 0.0
    r[MU + 4], r[MU + 5] = -given.XB, -given.YB
    r[MU + 6], r[MU + 7] = -given.XA, -given.YA
    r[MU + 8], r[MU + 9] = -given.XA, -given.YA
    end(y, r, 0, 0, -given.RA, 0.0, 1.0)
    end(y, r, 1, 0, given.RR - given.RA, 0.0, -1.0)
    end(y, r, 1, 1, given.DA, 0.0, 1.0)
    end(y, r, 2, 2, -given.SB, given.SA, 1.0)
    end(y, r, 3, 4, -given.TA, -given.TB, 1.0)
    end(y, r, 4, 6, given.UB, given.UA, 1.0)
    end(y, r, 5, 3, 0.0, given.E - given.EA, 1.0)
    end(y, r, 5, 4, given.ZT - given.TA, -given.TB, -1.0)
    end(y, r, 6, 5, given.FA - given.ZF, 0.0, 1.0)
    end(y, r, 6, 6, given.UB, given.UA - given.U, -1.0)
    end(y, r, 7, 2, -given.SB, given.SA - given.SS, 1.0)
    end(y, r, 7, 1, given.DA - given.D, 0.0, -1.0)
    end(y, r, 8, 3, 0.0, -given.EA, 1.0)
    end(y, r, 8, 1, given.DA - given.D, 0.0, -1.0)
    end(y, r, 9, 5, given.FA, 0.0, 1.0)
    end(y, r, 9, 1, given.DA - given.D, 0.0, -1.0)
    r[V + 2] -= given.MOM
    s, c = sin(y[8]), cos(y[8])
    x, z = (given.SD - given.SB) * c - (given.SA - given.SC) * s, (given.SD - given.SB) * s + (given.SA - given.SC) * c
    dx, dz = y[6] + x - given.XC, y[7] + z - given.YC
    pull = given.C0 * (1.0 - given.L0 / sqrt(dx * dx + dz * dz))
    r[V + 6] += pull * dx
    r[V + 7] += pull * dz
    r[V + 8] += pull * (x * dz - z * dx)
    return 0


@cfunc(JACOBIAN, cache=True, error_model="numpy")
def jacobian(t, cj, yy, yp, rr, jac, user, work1, work2, work3):
    """dr/dy + cj dr/dy', column after column."""
    y, A = array(user, yy), matrix(user)
    for i in range(21):
        A[i + N * i] = cj
        A[i + N * (V + i)] = -1.0
    for i in range(7):
        k = (N + 1) * (V + 3 * i)
        A[k] = A[k + N + 1] = given.MASS[i] * cj
        A[k + 2 * N + 2] = given.INERTIA[i] * cj
    end_matrix(y, A, 0, 0, -given.RA, 0.0, 1.0)
    end_matrix(y, A, 1, 0, given.RR - given.RA, 0.0, -1.0)
    end_matrix(y, A, 1, 1, given.DA, 0.0, 1.0)
    end_matrix(y, A, 2, 2, -given.SB, given.SA, 1.0)
    end_matrix(y, A, 3, 4, -given.TA, -given.TB, 1.0)
    end_matrix(y, A, 4, 6, given.UB, given.UA, 1.0)
    end_matrix(y, A, 5, 3, 0.0, given.E - given.EA, 1.0)
    end_matrix(y, A, 5, 4, given.ZT - given.TA, -given.TB, -1.0)
    end_matrix(y, A, 6, 5, given.FA - given.ZF, 0.0, 1.0)
    end_matrix(y, A, 6, 6, given.UB, given.UA - given.U, -1.0)
    end_matrix(y, A, 7, 2, -given.SB, given.SA - given.SS, 1.0)
    end_matrix(y, A, 7, 1, given.DA - given.D, 0.0, -1.0)
    end_matrix(y, A, 8, 3, 0.0, -given.EA, 1.0)
    end_matrix(y, A, 8, 1, given.DA - given.D, 0.0, -1.0)
    end_matrix(y, A, 9, 5, given.FA, 0.0, 1.0)
    end_matrix(y, A, 9, 1, given.DA - given.D, 0.0, -1.0)
    s, c = sin(y[8]), cos(y[8])
    x, z = (given.SD - given.SB) * c - (given.SA - given.SC) * s, (given.SD - given.SB) * s + (given.SA - given.SC) * c
    dx, dz = y[6] + x - given.XC, y[7] + z - given.YC
    length = sqrt(dx * dx + dz * dz)
    pull, more = given.C0 * (1.0 - given.L0 / length), given.C0 * given.L0 / length**3
    xx, xz, zz = pull + more * dx * dx, more * dx * dz, pull + more * dz * dz
    x_phi, z_phi = -z * xx + x * xz, -z * xz + x * zz
    A[V + 6 + N * 6] += xx
    A[V + 7 + N * 6] += xz
    A[V + 8 + N * 6] += x * xz - z * xx
    A[V + 6 + N * 7] += xz
    A[V + 7 + N * 7] += zz
    A[V + 8 + N * 7] += x * zz - z * xz
    A[V + 6 + N * 8] += x_phi
    A[V + 7 + N * 8] += z_phi
    A[V + 8 + N * 8] += x * z_phi - z * x_phi - pull * (z * dz + x * dx)
    return 0


def si2() -> Equations:
    """The equations and their start: at rest in the published pose."""
    y = np.zeros(N)
    angles = np.array([[given.BETA, given.THETA, given.GAMMA, given.PHI, given.DELTA, given.OMEGA, given.EPSILON]])
    y[:V] = given.places(angles)[0]
    return at_rest(
        Equations(residual, jacobian, y, np.zeros(N), np.arange(V), np.arange(V, MU), settings=Settings(0.1, 0.05)),
        np.arange(LAM, N),
    )
