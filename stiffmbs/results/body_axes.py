"""Orientations and angular velocities in the bodies' own axes, where the solver knows them in principal axes."""

from __future__ import annotations

import numpy as np

from ..compile.quaternions import CONJUGATE, rotated, times
from ..compile.system import System

OWN_ARE_PRINCIPAL = np.array([1.0, 0.0, 0.0, 0.0])


def in_own_axes(
    system: System, q: np.ndarray, u: np.ndarray, acceleration: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Coordinates, velocities and accelerations, one instant a row, of bodies as they are described.

    Counters of turns and states are left out.  Where all own axes are principal ones, and in the plane, the arrays are returned as they are.
    """
    axes = system.principal_axes
    q = q[:, : system.n_pose]
    if not axes.size or np.array_equal(axes, np.broadcast_to(OWN_ARE_PRINCIPAL, axes.shape)):
        return q, u, acceleration
    return _turned_back(q, CONJUGATE * axes), _seen_from(u, axes), _seen_from(acceleration, axes)


def from_own_axes(system: System, q: np.ndarray) -> np.ndarray:
    """Coordinates as the solver has them, from those of bodies as they are described."""
    return _turned_back(q, system.principal_axes) if system.principal_axes.size else q


def rates_from_own_axes(system: System, u: np.ndarray) -> np.ndarray:
    """Velocities as the solver has them, from those of bodies as they are described."""
    return _seen_from(u, CONJUGATE * system.principal_axes) if system.principal_axes.size else u


def _turned_back(q: np.ndarray, axes: np.ndarray) -> np.ndarray:
    """Every quaternion p replaced by p a."""
    bodies = q.reshape(len(q), -1, 7).copy()
    bodies[..., 3:] = times(bodies[..., 3:], axes)
    return bodies.reshape(q.shape)


def _seen_from(u: np.ndarray, axes: np.ndarray) -> np.ndarray:
    """Angular velocities w, in axes that are turned by a, in those that they are turned from: a w conj(a)."""
    bodies = u.reshape(len(u), -1, 6).copy()
    bodies[..., 3:] = rotated(axes, bodies[..., 3:])
    return bodies.reshape(u.shape)
