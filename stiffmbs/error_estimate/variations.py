"""Variations of many states at once: displacements, small rotations and velocities in ground axes, and further states.

A variation is a row (x, v, s): x of displacements and small rotations in ground axes, v = x', both of shape (n_u,), and
changes s of the coordinates after those of the bodies that have a rate. With u in the axes of the body, v = A du.
"""

from __future__ import annotations

import numpy as np

from ..compile.quaternions import CONJUGATE, rotated, times, times_vector
from ..compile.system import System


class Variations:
    """Geometry of variations of the states with coordinates `q`, shape (n, n_q)."""

    def __init__(self, system: System, q: np.ndarray) -> None:
        self._system, self._bodies = system, len(system.bodies)
        self._flat = system.of_body.dimensions == 2
        if not self._flat:
            p = q[:, : system.n_pose].reshape(len(q), self._bodies, 7)[..., 3:]
            self._p = p / np.linalg.norm(p, axis=-1, keepdims=True)

    def ground(self, u: np.ndarray) -> np.ndarray:
        """Return vectors of the axes of u in ground axes, shapes (n, ..., n_u)."""
        return u if self._flat else self._rotated(u, self._p)

    def own(self, v: np.ndarray) -> np.ndarray:
        """Return vectors of ground axes in the axes of u, shapes (n, ..., n_u)."""
        return v if self._flat else self._rotated(v, self._p * CONJUGATE)

    def _rotated(self, vectors: np.ndarray, p: np.ndarray) -> np.ndarray:
        turned = vectors.reshape(*vectors.shape[:-1], self._bodies, 6).copy()
        turned[..., 3:] = rotated(_among(p, vectors), turned[..., 3:])
        return turned.reshape(vectors.shape)

    def spun(self, w: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Return w x v of the angular parts, zeros for the others; `w` of shape (n, n_u) and `v` in ground axes."""
        if self._flat:
            return np.zeros_like(v)
        found = np.zeros_like(v).reshape(*v.shape[:-1], self._bodies, 6)
        spins = _among(w.reshape(len(w), self._bodies, 6), v)[..., 3:]
        found[..., 3:] = np.cross(spins, v.reshape(found.shape)[..., 3:])
        return found.reshape(v.shape)

    def displacement(self, dq: np.ndarray) -> np.ndarray:
        """Return x of small changes of the coordinates, shapes (n, ..., n_q)."""
        poses = dq[..., : self._system.n_pose]
        if self._flat:
            return poses
        poses = poses.reshape(*dq.shape[:-1], self._bodies, 7)
        turned = 2.0 * times(poses[..., 3:], _among(self._p * CONJUGATE, dq))[..., 1:]
        found = np.concatenate([poses[..., :3], turned], axis=-1)
        return found.reshape(*dq.shape[:-1], self._system.n_u)

    def moved(self, q: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Return the coordinates `q`, shape (n, n_q), after displacements x, shape (n, ..., n_u)."""
        there = np.broadcast_to(_among(q, x), (*x.shape[:-1], q.shape[-1])).copy()
        if self._flat:
            there[..., : self._system.n_pose] += x
            return there
        poses = there[..., : self._system.n_pose].reshape(*x.shape[:-1], self._bodies, 7)
        parts = x.reshape(*x.shape[:-1], self._bodies, 6)
        poses[..., :3] += parts[..., :3]
        p = _among(self._p, x)
        half = np.zeros((*parts.shape[:-1], 4))
        half[..., 1:] = 0.5 * parts[..., 3:]
        poses[..., 3:] = p + times(half, np.broadcast_to(p, half.shape))
        poses[..., 3:] /= np.linalg.norm(poses[..., 3:], axis=-1, keepdims=True)
        there[..., : self._system.n_pose] = poses.reshape(*x.shape[:-1], -1)
        return there


def _among(array: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Return an array over states (axis 0) with the further leading axes of another one."""
    extra = others.ndim - 2
    return array.reshape(len(array), *(1,) * extra, *array.shape[1:])


def position_rates(system: System, q: np.ndarray, u: np.ndarray, trailing: np.ndarray) -> np.ndarray:
    """Return q' of many states, shape (n, n_q), with those of the coordinates after the bodies' given."""
    u = system.followed * u
    if system.of_body.dimensions == 2:
        return np.hstack([u, trailing])
    bodies = len(system.bodies)
    of_q, of_u = q[:, : system.n_pose].reshape(len(q), bodies, 7), u.reshape(len(q), bodies, 6)
    rates = np.concatenate([of_u[..., :3], 0.5 * times_vector(of_q[..., 3:], of_u[..., 3:])], axis=-1)
    return np.hstack([rates.reshape(len(q), -1), trailing])
