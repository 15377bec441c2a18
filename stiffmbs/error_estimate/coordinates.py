"""Errors in the coordinates in which a run integrates: rows (dq, du, ds) of changes of poses, velocities and further states.

Steps resolve the turning of bodies in these coordinates, a quaternion by half the angle and angular velocities in axes of the
body. Along the steps, the equations of errors in axes of the ground would turn as fast as the bodies.
"""

from __future__ import annotations

import numpy as np

from ..compile.quaternions import CONJUGATE, times, times_vector
from ..compile.system import System


def width(system: System) -> int:
    """Return the length of a row."""
    return system.n_pose + system.n_u + len(system.with_rates)


def as_rows(system: System, dq: np.ndarray, du: np.ndarray) -> np.ndarray:
    """Return changes of q and u, or of their rates, as rows."""
    return np.hstack([dq[:, : system.n_pose], du, dq[:, system.with_rates]])


def typical(system: System, q: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Return the sizes of changes (dq, du, ds) that are large for a motion: of the mechanism, a radian, the largest velocities."""
    scale, states = system.per_velocity(system.size, 1.0), np.abs(q[:, system.with_rates]).max(axis=0, initial=1.0)
    of_pose = np.ones((len(system.bodies), system.n_pose // len(system.bodies)))
    of_pose[:, : system.of_body.dimensions] = system.size
    return np.concatenate([of_pose.ravel(), scale * max(1.0, np.abs(u / scale).max(initial=0.0)), states])


def displaced(system: System, q: np.ndarray, u: np.ndarray, errors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return q and u changed by errors, with unit quaternions."""
    n_pose, q = system.n_pose, q.copy()
    q[:, :n_pose] += errors[:, :n_pose]
    q[:, system.with_rates] += errors[:, n_pose + system.n_u :]
    if system.of_body.dimensions == 3:
        p = q[:, :n_pose].reshape(len(q), -1, 7)[..., 3:]
        p /= np.linalg.norm(p, axis=-1, keepdims=True)
    return q, u + errors[:, n_pose : n_pose + system.n_u]


def displacements(system: System, q: np.ndarray, dq: np.ndarray) -> np.ndarray:
    """Return the displacements in the axes of u, shape (n, n_u), by small changes of poses, shape (n, n_pose)."""
    if system.of_body.dimensions == 2:
        return dq
    p, of_bodies = _quaternions(system, q), dq.reshape(len(dq), len(system.bodies), 7)
    turned = 2.0 * times(p * CONJUGATE, of_bodies[..., 3:])[..., 1:]
    return np.concatenate([of_bodies[..., :3], turned], axis=-1).reshape(len(dq), system.n_u)


def pose_rates(system: System, q: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Return the rates of the poses of many states, shape (n, n_pose)."""
    u = system.followed * u
    if system.of_body.dimensions == 2:
        return u
    bodies = len(system.bodies)
    of_q, of_u = q[:, : system.n_pose].reshape(len(q), bodies, 7), u.reshape(len(q), bodies, 6)
    rates = np.concatenate([of_u[..., :3], 0.5 * times_vector(of_q[..., 3:], of_u[..., 3:])], axis=-1)
    return rates.reshape(len(q), -1)


def _quaternions(system: System, q: np.ndarray) -> np.ndarray:
    """Return the unit quaternions of all bodies, shape (n, bodies, 4)."""
    p = q[:, : system.n_pose].reshape(len(q), len(system.bodies), 7)[..., 3:]
    return np.asarray(p / np.linalg.norm(p, axis=-1, keepdims=True))
