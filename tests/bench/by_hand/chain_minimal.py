"""The chain of rods in its angles: forces in the pins by a tridiagonal system of blocks, O(N) for a chain of N rods."""

from __future__ import annotations

import numpy as np

from .chain import g, m
from .loop import fast


@fast
def accelerations(phi, w, h, spin, force):
    """Angular accelerations, and the force of each pin on the rod to its right (that past the last rod is zero).

    The ends of a rod, at -+h (cos phi, sin phi) from its centre, are accelerated by the forces F to the left and -G to
    the right: with n = (-sin phi, cos phi) and e = (cos phi, sin phi)
        left   a - h n spin + h e w^2,  right   a + h n spin - h e w^2,
        a = (F - G)/m - (0, g),         spin = -h n.(F + G)/I.
    Right end of one rod and left end of the next are one point: D_k F_k + U_k F_k+1 + U_k-1 F_k-1 = b_k, symmetric.
    """
    count = len(phi)
    p, r = 1.0 / m, 3.0 / m
    nx, nz = 0.0, 0.0
    ex, ez, gx, gz = 0.0, 0.0, 0.0, 0.0
    before = False
    pivots, offs = np.empty((count, 3)), np.empty((count, 3))
    for k in range(count):
        s, c = np.sin(phi[k]), np.cos(phi[k])
        nx, nz = -s, c
        dxx, dxz, dzz = p + r * nx * nx, r * nx * nz, p + r * nz * nz
        uxx, uxz, uzz = -p + r * nx * nx, r * nx * nz, -p + r * nz * nz
        bx, bz = -h * c * w[k] * w[k], -h * s * w[k] * w[k] + g
        if before:
            oxx, oxz, ozz = offs[k - 1, 0], offs[k - 1, 1], offs[k - 1, 2]
            exx, exz, ezz = p + r * ex * ex, r * ex * ez, p + r * ez * ez
            ixx, ixz, izz = pivots[k - 1, 0], pivots[k - 1, 1], pivots[k - 1, 2]
            lxx, lxz = oxx * ixx + oxz * ixz, oxx * ixz + oxz * izz
            lzx, lzz = oxz * ixx + ozz * ixz, oxz * ixz + ozz * izz
            dxx += exx - (lxx * oxx + lxz * oxz)
            dxz += exz - (lxx * oxz + lxz * ozz)
            dzz += ezz - (lzx * oxz + lzz * ozz)
            bx += gx - (lxx * force[k - 1, 0] + lxz * force[k - 1, 1])
            bz += gz - (lzx * force[k - 1, 0] + lzz * force[k - 1, 1])
        determinant = dxx * dzz - dxz * dxz
        pivots[k, 0], pivots[k, 1], pivots[k, 2] = dzz / determinant, -dxz / determinant, dxx / determinant
        offs[k, 0], offs[k, 1], offs[k, 2] = uxx, uxz, uzz
        force[k, 0], force[k, 1] = bx, bz
        gx, gz = -h * c * w[k] * w[k], -h * s * w[k] * w[k] - g
        ex, ez, before = nx, nz, True
    force[count, 0] = force[count, 1] = 0.0
    for k in range(count - 1, -1, -1):
        bx, bz = force[k, 0], force[k, 1]
        fx, fz = force[k + 1, 0], force[k + 1, 1]
        bx -= offs[k, 0] * fx + offs[k, 1] * fz
        bz -= offs[k, 1] * fx + offs[k, 2] * fz
        force[k, 0] = pivots[k, 0] * bx + pivots[k, 1] * bz
        force[k, 1] = pivots[k, 1] * bx + pivots[k, 2] * bz
        s, c = np.sin(phi[k]), np.cos(phi[k])
        spin[k] = -h * (-s * (force[k, 0] + fx) + c * (force[k, 1] + fz)) / (m * h * h / 3)


@fast
def minimal(t, y, h):
    """Rates of the angles and of their velocities."""
    count = len(y) // 2
    rates = np.empty(2 * count)
    rates[:count] = y[count:]
    accelerations(y[:count], y[count:], h, rates[count:], np.empty((count + 1, 2)))
    return rates


def places(y: np.ndarray, h: float) -> np.ndarray:
    """Coordinates of the rods, rows of (x1 y1 phi1 x2 ...), from rows of angles and their velocities."""
    phi = y[:, : y.shape[1] // 2]
    coordinates = np.empty((*phi.shape, 3))
    for k, arm in enumerate((h * np.cos(phi), h * np.sin(phi))):
        coordinates[:, :, k] = 2 * np.cumsum(arm, axis=1) - arm
    coordinates[:, :, 2] = phi
    return coordinates.reshape(len(phi), -1)
