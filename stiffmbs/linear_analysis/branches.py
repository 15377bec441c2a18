"""Modes of neighbouring states joined to branches, and the direction in which the modes of a rotor whirl."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.optimize import linear_sum_assignment

from .modes import Mode


def likeness(one: np.ndarray, other: np.ndarray) -> float:
    """Return the modal assurance criterion of two shapes, from 0 (orthogonal) to 1 (the same).

    Source: R. J. Allemang, "The modal assurance criterion: twenty years of use and abuse", Sound and Vibration 37, 2003.
    """
    sizes = np.vdot(one, one).real * np.vdot(other, other).real
    return float(abs(np.vdot(one, other)) ** 2 / sizes) if sizes > 0.0 else 0.0


def apart(one: complex, other: complex) -> float:
    """Return the distance of two eigenvalues relative to their sizes, from 0 to 1."""
    sizes = abs(one) + abs(other)
    return abs(one - other) / sizes if sizes > 0.0 else 0.0


def continued(
    modes: Sequence[Mode], expected: Sequence[complex], following: Sequence[Mode], scale: np.ndarray
) -> dict[int, int]:
    """Return the number of the following mode that continues each of some modes, by its own number.

    All pairs together have the most similar shapes and the nearest eigenvalues (assignment problem). `expected`: eigenvalue
    that each mode is expected to have. `scale` of shape (n_u,): as for `natural_modes`.
    """
    if not (modes and following):
        return {}
    shapes, others = ([mode.shape / scale for mode in each] for each in (modes, following))
    cost = [
        [
            1.0 - likeness(shape, other) + apart(value, mode.eigenvalues[0])
            for other, mode in zip(others, following, strict=True)
        ]
        for shape, value in zip(shapes, expected, strict=True)
    ]
    rows, columns = linear_sum_assignment(np.array(cost))
    return dict(zip(rows.tolist(), columns.tolist(), strict=True))


def whirl(shape: np.ndarray, velocities: np.ndarray, scale: np.ndarray, energy: np.ndarray) -> float:
    """Return the direction of whirl of a mode: 1 forward on circles, -1 backward, 0 in a plane or about the axis; NaN without rotation.

    The orbit of a displacement d in d exp(i w t) has the normal Im(d x conj(d)). Bodies without rotation do not count; if these have most
    of the kinetic energy, it is no mode of a rotor: 0. `shape`, `velocities` of shape (n_u,): shape of the mode and velocities of
    all bodies in space, ground axes. `energy` of shape (bodies,): kinetic energy of each.
    """
    moves = (shape / scale).reshape(-1, 2, 3)  # body, displacement and rotation, axis
    spins = velocities.reshape(-1, 2, 3)[:, 1]
    rates = np.linalg.norm(spins, axis=1)
    turning = rates > 0.0
    if turning.any() and energy[turning].sum() <= energy[~turning].sum():
        return 0.0
    axes = spins[turning] / rates[turning, None]
    moves = moves[turning]
    size = float(np.sum(np.abs(moves) ** 2))
    if not size > 0.0:
        return 0.0 if turning.any() else float("nan")
    normals = np.cross(moves, moves.conj()).imag
    return float(np.einsum("bka,ba->", normals, axes) / size)
