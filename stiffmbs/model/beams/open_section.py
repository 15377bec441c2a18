"""Constants of open cross sections that consist of a chain of straight, thin walls."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

GAUSS = np.polynomial.legendre.leggauss(3)
"""Points and weights, exact for the square of the shear flow, a polynomial of degree four."""


def of_rectangles(
    rectangles: Sequence[tuple[float, float, float, float]],
) -> tuple[float, np.ndarray, np.ndarray, np.ndarray]:
    """Return area, centroid, moments of second order about it, shape (2, 2), and of third order of rectangles.

    The last are the integrals of each coordinate times the square of the distance from the centroid, shape (2,).
    Each rectangle has its smallest and largest coordinate along axis 2, then along axis 3, m.
    """
    low, high = (np.array([one[k::2] for one in rectangles]) for k in (0, 1))
    areas, centres = np.prod(high - low, axis=1), (low + high) / 2
    A = float(areas.sum())
    centroid = areas @ centres / A
    away = centres - centroid
    own = (high - low) ** 2 / 12
    third = (areas[:, None] * away).T @ ((away**2 + own).sum(axis=1)) + areas @ (2 * away * own)
    return A, centroid, (areas[:, None] * away).T @ away + np.diag(areas @ own), third


def of_walls(points: Sequence[tuple[float, float]], thickness: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
    """Return the shear centre and the shear compliance times G, shape (2, 2), of a chain of walls.

    The shear flow is q = -(I^-1 V) . S for a shear force V, with the static moment S of the part of the section up to
    there (Timoshenko, Strength of Materials II, 1956, sec. 52). Its moment is that of V at the shear centre, and
    its energy the integral of q^2/(2 G t).

    `points`: corners of the middle lines, from one free edge to the other, along axes 2 and 3, m. `thickness`: of each
    wall, m.
    """
    corners = np.array(points, dtype=float)
    t, along = np.array(thickness), np.diff(corners, axis=0)
    lengths = np.linalg.norm(along, axis=1)
    areas = t * lengths
    centroid = areas @ (corners[1:] + corners[:-1]) / 2 / areas.sum()
    corners = corners - centroid
    middle = (corners[1:] + corners[:-1]) / 2
    moments = (areas[:, None] * middle).T @ middle + (areas[:, None] * along).T @ along / 12
    compliance, torque, before = np.zeros((2, 2)), np.zeros(2), np.zeros(2)
    for (a, b), wall, length, area in zip(pairwise(corners), t, lengths, areas, strict=True):
        for x, weight in zip((1 + GAUSS[0]) / 2, GAUSS[1] / 2, strict=True):
            flow = -np.linalg.solve(moments, before + area * (x * a + x * x / 2 * (b - a)))
            compliance += weight * length / wall * np.outer(flow, flow)
            torque += weight * flow * (a[0] * b[1] - a[1] * b[0])
        before = before + area * (a + b) / 2
    return centroid + np.array([torque[1], -torque[0]]), compliance
