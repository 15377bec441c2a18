"""Own axes of bodies, and the principal axes in which they are solved."""

from __future__ import annotations

import numpy as np

from ..compile.bodies import QUATERNION
from ..compile.quaternions import CONJUGATE, rotated, times
from ..compile.system import System

OWN_ARE_PRINCIPAL = np.array([1.0, 0.0, 0.0, 0.0])


def in_own_axes(
    system: System, q: np.ndarray, u: np.ndarray, acceleration: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return coordinates, velocities and accelerations of the described bodies, one row per instant.

    Revolution counters and states are left out.  The arrays are returned unchanged in the plane, or if all own axes are
    principal ones.
    """
    axes = system.principal_axes
    q = q[:, : system.n_pose]
    if own_are_principal(system):
        return q, u, acceleration
    return _turned_back(q, CONJUGATE * axes), _seen_from(u, axes), _seen_from(acceleration, axes)


def own_are_principal(system: System) -> bool:
    """Return True in the plane, and if the own axes of all bodies are principal ones."""
    return bool(np.all(_with_principal_axes(system)))


def _with_principal_axes(system: System) -> np.ndarray:
    """Return True for each body whose own axes are principal ones, as in the plane, shape (n,)."""
    axes = system.principal_axes
    return np.all(axes == OWN_ARE_PRINCIPAL, axis=1) if axes.size else np.ones(len(system.bodies), dtype=bool)


def places_of_channels(system: System, q: np.ndarray, u: np.ndarray) -> dict[str, tuple[np.ndarray, int]]:
    """Return the places of channels that are coordinates q or velocities u of bodies: array and index.

    Rotations and angular velocities in other than principal axes have none.
    """
    levels, principal = ((q, system.of_body.positions), (u, system.of_body.velocities)), _with_principal_axes(system)
    return {
        f"{body}.{label}": (values, len(labels) * k + n)
        for values, labels in levels
        for k, body in enumerate(system.bodies)
        for n, label in enumerate(labels)
        if label not in QUATERNION and (n < system.of_body.linear or principal[k])
    }


def from_own_axes(system: System, q: np.ndarray) -> np.ndarray:
    """Return the solver's coordinates from those of the described bodies."""
    return _turned_back(q, system.principal_axes) if system.principal_axes.size else q


def rates_from_own_axes(system: System, u: np.ndarray) -> np.ndarray:
    """Return the solver's velocities from those of the described bodies."""
    return _seen_from(u, CONJUGATE * system.principal_axes) if system.principal_axes.size else u


def _turned_back(q: np.ndarray, axes: np.ndarray) -> np.ndarray:
    """Replace every quaternion p by p a."""
    bodies = q.reshape(len(q), -1, 7).copy()
    bodies[..., 3:] = times(bodies[..., 3:], axes)
    return bodies.reshape(q.shape)


def _seen_from(u: np.ndarray, axes: np.ndarray) -> np.ndarray:
    """Transform angular velocities w from axes rotated by a to the original ones: a w conj(a)."""
    bodies = u.reshape(len(u), -1, 6).copy()
    bodies[..., 3:] = rotated(axes, bodies[..., 3:])
    return bodies.reshape(u.shape)
