"""Channels of bodies in space as arrays."""

import numpy as np

from .spatial_closed_forms import matrices


def vector(solution, body, part=""):
    """x, y and z of a body's channels, (n, 3); `part` is v for its velocity, w for its angular velocity."""
    return np.stack([solution[f"{body}.{part}{c}"] for c in "xyz"], axis=-1)


def axes(solution, body):
    """Rotation matrices (n, 3, 3) of a body's own axes, from a quaternion whose norm is watched as well."""
    q = np.array([solution[f"{body}.q{k}"] for k in range(4)])
    np.testing.assert_allclose((q**2).sum(axis=0), 1, atol=1e-12)
    return matrices(q)
