"""Linearisation of the independent equations: differences of accelerations, restricted to the tangent space of the constraints."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import null_space

from .elements import State
from .system import difference

STEP = 3e-4


@dataclass(frozen=True)
class Linear:
    """z' = A z + B p, y = C z + D p in coordinates of the tangent space, whose basis is `tangent`, shape (2 n_u + states, n)."""

    a: np.ndarray
    b: np.ndarray
    c: np.ndarray
    d: np.ndarray
    tangent: np.ndarray

    def response(self, frequencies):
        """Return C (i w - A)^-1 B + D, shape (frequencies, outputs, inputs)."""
        return self.c @ self._states(frequencies) + self.d

    def terms(self, frequencies):
        """Return the sums of the magnitudes of the terms of each response, of which most may cancel."""
        return np.abs(self.c) @ np.abs(self._states(frequencies)) + np.abs(self.d)

    def _states(self, frequencies):
        unit = np.eye(len(self.a))
        return np.array([np.linalg.solve(2j * np.pi * f * unit - self.a, self.b) for f in frequencies])


def varied(system, state, z):
    """Return a state after displacements, rotations and changes of velocities in ground axes, and changes of states."""
    n = len(system.columns)
    x, v = np.zeros(6 * (system.n + 1)), np.zeros(6 * (system.n + 1))
    x[system.columns], v[system.columns] = z[:n], z[n : 2 * n]
    return State(state.poses.moved(x.reshape(-1, 6), 1.0), state.u + v.reshape(-1, 6), state.s + z[2 * n :])


def linear(system, state, t, loads, outputs):
    """Linearise about a state at rest.

    `loads`: arrays of shape (bodies, 6), unit inputs.  `outputs`: names of channels.
    """
    n, n_s = len(system.columns), len(state.s)
    size = 2 * n + n_s

    def rates(z, load=None):
        motion = system.motion(varied(system, state, z), t, load)
        return np.concatenate([z[n : 2 * n], motion.a.ravel()[system.columns], motion.rates])

    def measured(z, load=None):
        found = system.channels(varied(system, state, z), t, load)
        return np.array([found[name] for name in outputs])

    tangent = np.eye(size)
    if system.rows:
        J = system.jacobian(state.poses, t)[:, system.columns]
        free = null_space(J, rcond=1e-10)
        k = free.shape[1]
        tangent = np.zeros((size, 2 * k + n_s))
        tangent[:n, :k] = free
        tangent[n : 2 * n, k : 2 * k] = free
        tangent[2 * n :, 2 * k :] = np.eye(n_s)
    back = np.linalg.pinv(tangent)
    whole = np.array([difference(lambda h, way=way: rates(h * way), STEP) for way in tangent.T]).T.reshape(size, -1)
    c = np.array([difference(lambda h, way=way: measured(h * way), STEP) for way in tangent.T]).T.reshape(
        len(outputs), -1
    )
    zero = np.zeros(size)
    b = np.array([difference(lambda h, load=load: rates(zero, h * load), 1.0) for load in loads]).T
    d = np.array([difference(lambda h, load=load: measured(zero, h * load), 1.0) for load in loads]).T
    left = np.max(np.abs(whole - tangent @ (back @ whole)), initial=0.0)
    if left > 1e-5 * max(1.0, np.max(np.abs(whole), initial=0.0)):
        raise ValueError(f"the tangent space is not invariant: {left:.1e}")
    return Linear(back @ whole, back @ b, c, d, tangent)
