"""Rigid displacements and screws (twists) in space, numerically; translation before rotation."""

from __future__ import annotations

import math
from typing import cast

import numpy as np

TERMS = 30
"""Number of terms of exponential series; arguments are at most of the order of pi."""


def tilde(a: np.ndarray) -> np.ndarray:
    """Return the matrix of the cross product a x b."""
    return np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


def adjoint(screw: np.ndarray) -> np.ndarray:
    """Return the matrix ad of the Lie bracket of a screw (u, theta), shape (6, 6)."""
    u, theta = tilde(screw[:3]), tilde(screw[3:])
    return np.block([[theta, u], [np.zeros((3, 3)), theta]])


def exponential(A: np.ndarray) -> np.ndarray:
    """Return exp(A) by its series."""
    return _series(A, lambda k: 1 / math.factorial(k), TERMS)


def tangent(A: np.ndarray) -> np.ndarray:
    """Return (1 - exp(-A))/A by its series."""
    return _series(-A, lambda k: 1 / math.factorial(k + 1), TERMS)


def half_sine(A: np.ndarray) -> np.ndarray:
    """Return sinh(A/2)/(A/2) by its series."""
    return _series(A @ A, lambda k: 1 / (4**k * math.factorial(2 * k + 1)), TERMS // 2)


def _series(A: np.ndarray, coefficient: object, terms: int) -> np.ndarray:
    total, power = np.zeros_like(A), np.eye(len(A))
    for k in range(terms):
        total = total + coefficient(k) * power  # type: ignore[operator]
        power = power @ A
    return total


def rotation_vector(R: np.ndarray) -> np.ndarray:
    """Return the rotation vector of a rotation matrix of less than half a turn."""
    sine = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]) / 2
    size = float(np.linalg.norm(sine))
    angle = math.atan2(size, (np.trace(R) - 1) / 2)
    return sine * (angle / size if size > 1e-7 else 1 + angle * angle / 6)


def logarithm(d: np.ndarray, R: np.ndarray) -> np.ndarray:
    """Return the screw (u, theta) of a displacement d with a rotation R, shape (6,)."""
    theta = rotation_vector(R)
    square = float(theta @ theta)
    half = math.sqrt(square) / 2
    rest = (1 - half / math.tan(half)) / square if square > 1e-4 else 1 / 12 + square / 720 + square**2 / 30240
    turned = np.cross(theta, d)
    return cast(np.ndarray, np.concatenate([d - turned / 2 + rest * np.cross(theta, turned), theta]))
