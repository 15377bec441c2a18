"""Rotations, markers and measures of the independent equations of motion; all functions accept complex poses."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


def skew(v):
    """Return the matrix of the cross product with v."""
    x, y, z = v
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def cross(a, b):
    """Return the cross product; `numpy.cross` takes ten times as long."""
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def rotation(v):
    """Return the rotation matrix of a rotation vector (Rodrigues' formula)."""
    angle = np.linalg.norm(v)
    k = skew(v)
    half = np.sinc(angle / (2 * np.pi))
    return np.eye(3) + np.sinc(angle / np.pi) * k + half * half / 2 * (k @ k)


def about_z(angle):
    """Return a rotation about z."""
    return rotation(np.array([0.0, 0.0, angle]))


def of_quaternion(p):
    """Return the rotation matrix of a quaternion, scalar first."""
    w, *v = np.asarray(p, float) / np.linalg.norm(p)
    v = np.array(v)
    return 2 * (np.outer(v, v) + w * skew(v)) + (2 * w * w - 1) * np.eye(3)


def rotation_vector(turn):
    """Return the rotation vector of a rotation of less than half a turn."""
    sine = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]) / 2
    angle = np.arctan2(np.linalg.norm(sine), (np.trace(turn) - 1) / 2)
    return sine / np.sinc(angle / np.pi)


def arctan2(y, x):
    """Return the angle of a point; the imaginary part is its derivative, for complex steps."""
    real = np.arctan2(np.real(y), np.real(x))
    if not (np.iscomplexobj(y) or np.iscomplexobj(x)):
        return real
    squared = np.real(x) ** 2 + np.real(y) ** 2
    return real + 1j * (np.real(x) * np.imag(y) - np.real(y) * np.imag(x)) / squared


@dataclass(frozen=True)
class Poses:
    """Poses of all bodies, the last of which is the ground.

    `r` of shape (bodies, 3): centres of mass. `A` of shape (bodies, 3, 3): axes of the bodies as columns.
    """

    r: np.ndarray
    A: np.ndarray

    def moved(self, x, times=1.0):
        """Return the poses after displacements and rotations in ground axes, shape (bodies, 6); exact for complex infinitesimal times."""
        if np.iscomplexobj(times):
            return Poses(self.r + times * x[:, :3], self.A + times * np.array([skew(v) for v in x[:, 3:]]) @ self.A)
        return Poses(self.r + times * x[:, :3], np.array([rotation(times * v) for v in x[:, 3:]]) @ self.A)


@dataclass(frozen=True)
class Point:
    """Marker on a body: `point` from the centre of mass and `axes`, in the body's axes."""

    body: int
    point: np.ndarray
    axes: np.ndarray

    def at(self, poses):
        """Return the point in ground axes."""
        return poses.r[self.body] + poses.A[self.body] @ self.point

    def turned(self, poses):
        """Return the axes in ground axes, as columns."""
        return poses.A[self.body] @ self.axes

    def velocity(self, poses, u, at=None):
        """Return the velocity of the point, or of the body's point at a place, in ground axes."""
        place = self.at(poses) if at is None else at
        return u[self.body, :3] + cross(u[self.body, 3:], place - poses.r[self.body])
