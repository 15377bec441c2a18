"""Free bodies in the plane under contacts and laws over distance, by Runge-Kutta steps so short that none misses anything.

Nothing here comes from the package: forces are written out by hand.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit

LINE, CIRCLES, LAW, STOP = range(4)
GAUSSIAN, WINDOW, ARCH, TENT, GATE, LORENTZ = range(6)
"""Bumps of a law: exp(-z^2); (tanh(z + 5) - tanh(z - 5))/2; max(0, 1 - z^2); straight lines up and down; a gate of two
steps; 1/(1 + z^2), z being the distance from the middle in widths."""


@dataclass(frozen=True)
class Scene:
    """Bodies and forces as numbers.

    Attributes
    ----------
    mass, inertia : ndarrays, shape (bodies,)
    start : ndarray, shape (bodies, 6)
        x, y, angle and their rates.
    gravity : ndarray, shape (2,)
    forces : ndarray, shape (forces, 12)
        The kind, then what `_add` reads of it.
    """

    mass: np.ndarray
    inertia: np.ndarray
    start: np.ndarray
    gravity: np.ndarray
    forces: np.ndarray


def moved(scene: Scene, duration: float, points: int, step: float, change: float = 0.0) -> np.ndarray:
    """States at evenly spaced instants, shape (points, bodies, 6), from a start changed by so much in each number."""
    start = scene.start + change * np.cos(1.0 + np.arange(scene.start.size)).reshape(scene.start.shape)
    between = max(1, int(np.ceil(duration / (points - 1) / step)))
    h = duration / (points - 1) / between
    found: np.ndarray = _integrated(start, scene.mass, scene.inertia, scene.gravity, scene.forces, points, between, h)
    return found


@njit(cache=True)
def _bump(kind, z):  # type: ignore[no-untyped-def]
    if kind == GAUSSIAN:
        return np.exp(-z * z)
    if kind == WINDOW:
        return 0.5 * (np.tanh(z + 5.0) - np.tanh(z - 5.0))
    if kind == ARCH:
        return max(0.0, 1.0 - z * z)
    if kind == TENT:
        return max(0.0, 1.0 - abs(z))
    if kind == LORENTZ:
        return 1.0 / (1.0 + z * z)
    rise = min(max((z + 2.0), 0.0), 1.0)
    fall = min(max((z - 1.0), 0.0), 1.0)
    return rise * rise * (3.0 - 2.0 * rise) * (1.0 - fall * fall * (3.0 - 2.0 * fall))


@njit(cache=True)
def _add(force, y, total):  # type: ignore[no-untyped-def]
    """Add one force to the total on each body, shape (bodies, 3)."""
    kind, i = int(force[0]), int(force[1])
    if kind == LINE:  # point of body i at (px, py), wall point (wx, wy), normal angle, k, n, chi
        c, s = np.cos(y[i, 2]), np.sin(y[i, 2])
        rx, ry = c * force[2] - s * force[3], s * force[2] + c * force[3]
        nx, ny = np.cos(force[6]), np.sin(force[6])
        gap = (y[i, 0] + rx - force[4]) * nx + (y[i, 1] + ry - force[5]) * ny
        if gap < 0:
            rate = (y[i, 3] - y[i, 5] * ry) * nx + (y[i, 4] + y[i, 5] * rx) * ny
            damped = 1.0 - force[9] * rate
            if damped > 0:
                push = force[7] * (-gap) ** force[8] * damped
                total[i, 0] += push * nx
                total[i, 1] += push * ny
                total[i, 2] += push * (rx * ny - ry * nx)
    elif kind == CIRCLES:  # bodies i and j (below 0: ground at (gx, gy)), radius sum or difference, outward, k, n
        j = int(force[2])
        dx = y[i, 0] - (y[j, 0] if j >= 0 else force[3])
        dy = y[i, 1] - (y[j, 1] if j >= 0 else force[4])
        distance = np.sqrt(dx * dx + dy * dy)
        gap = force[6] * distance - force[5]
        if gap < 0:
            push = force[6] * force[7] * (-gap) ** force[8] / distance
            total[i, 0] += push * dx
            total[i, 1] += push * dy
            if j >= 0:
                total[j, 0] -= push * dx
                total[j, 1] -= push * dy
    elif kind == LAW:  # on body i over x or y (0, 1), along x or y, middle, width, height, bump
        z = (y[i, int(force[2])] - force[4]) / force[5]
        total[i, int(force[3])] += force[6] * _bump(int(force[7]), z)
    else:  # stop of angle
        total[i, 2] -= force[3] * max(0.0, y[i, 2] - force[2])


@njit(cache=True)
def _rates(y, mass, inertia, gravity, forces, rates):  # type: ignore[no-untyped-def]
    bodies = len(mass)
    total = np.zeros((bodies, 3))
    for k in range(len(forces)):
        _add(forces[k], y, total)
    for b in range(bodies):
        rates[b, :3] = y[b, 3:]
        rates[b, 3] = total[b, 0] / mass[b] + gravity[0]
        rates[b, 4] = total[b, 1] / mass[b] + gravity[1]
        rates[b, 5] = total[b, 2] / inertia[b]


@njit(cache=True)
def _integrated(start, mass, inertia, gravity, forces, points, between, h):  # type: ignore[no-untyped-def]
    y = start.copy()
    rows = np.zeros((points, *y.shape))
    rows[0] = y
    a, b, c, d = np.zeros_like(y), np.zeros_like(y), np.zeros_like(y), np.zeros_like(y)
    for point in range(1, points):
        for _ in range(between):
            _rates(y, mass, inertia, gravity, forces, a)
            _rates(y + h / 2 * a, mass, inertia, gravity, forces, b)
            _rates(y + h / 2 * b, mass, inertia, gravity, forces, c)
            _rates(y + h * c, mass, inertia, gravity, forces, d)
            y += h / 6 * (a + 2 * b + 2 * c + d)
        rows[point] = y
    return rows
