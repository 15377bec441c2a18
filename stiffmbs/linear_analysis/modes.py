"""Natural modes: frequencies, damping ratios, mode shapes and kinetic energy of each body."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum

import numpy as np
from scipy.sparse import csr_array

from .eigenvalues import Zeros, eigen
from .parameters import LINEAR_ANALYSIS
from .state_space import StateMatrix


class Motion(Enum):
    """Type of motion of a mode."""

    OSCILLATING = "oscillating"
    APERIODIC = "aperiodic"
    RIGID = "rigid body"


@dataclass(frozen=True)
class Mode:
    """Mode: a pair of eigenvalues, or a single real one of user-defined states."""

    # oscillating with a conjugate pair, aperiodic with two real eigenvalues (overdamped or unstable), or a rigid body
    # motion without stiffness, whose eigenvalues are zero; damping may make one of the two nonzero
    motion: Motion
    # 1/s; the one with positive imaginary part first. A single one if states add unpaired real eigenvalues.
    eigenvalues: tuple[complex, ...]
    # shape (n_u,), complex: displacements and rotations of all bodies in ground axes. The largest displacement, or
    # rotation times the size of the mechanism, is 1.
    shape: np.ndarray
    participation: dict[str, float]  # fraction of the kinetic energy of each body, largest first

    @property
    def frequency(self) -> float:
        """Damped natural frequency, Hz: |Im s| / 2 pi."""
        return float(abs(self.eigenvalues[0].imag) / (2 * np.pi))

    @property
    def natural_frequency(self) -> float:
        """Undamped natural frequency, Hz: sqrt(|s_1 s_2|) / 2 pi, or |s| / 2 pi of a single eigenvalue."""
        product = abs(np.prod(self.eigenvalues))
        return float((np.sqrt(product) if len(self.eigenvalues) > 1 else product) / (2 * np.pi))

    @property
    def damping_ratio(self) -> float:
        """Damping ratio: -(s_1 + s_2)/2 over the undamped angular frequency; NaN for a rigid body motion."""
        natural = 2 * np.pi * self.natural_frequency
        mean = sum(self.eigenvalues).real / len(self.eigenvalues)
        return float(0.0 - mean / natural) if natural else float("nan")

    @property
    def is_stable(self) -> bool:
        """True if no part of the mode grows exponentially."""
        return max(value.real for value in self.eigenvalues) <= 0

    def as_dict(self) -> dict[str, object]:
        """Return the mode as a dictionary for JSON."""
        return {
            "frequency": self.natural_frequency,
            "damping": None if np.isnan(self.damping_ratio) else self.damping_ratio,
            "eigenvalue": [self.eigenvalues[0].real, self.eigenvalues[0].imag],
            "damped_frequency": self.frequency,
            "eigenvalues": [[value.real, value.imag] for value in self.eigenvalues],
            "motion": self.motion.value,
            "participation": self.participation,
        }


def natural_modes(state: StateMatrix, mass: csr_array, bodies: tuple[str, ...], scale: np.ndarray) -> list[Mode]:
    """Return the modes of a state matrix, one per degree of freedom and more of states, by undamped natural frequency.

    `mass` of shape (n_u, n_u): in ground axes. `scale` of shape (n_u,): the mechanism's size for displacements, 1 for
    rotations.
    """
    if not len(state.matrix):
        return []
    values, vectors, zeros = eigen(state.matrix, state.n_poses, state.n_states)
    shapes = state.poses @ vectors
    pairs = [
        *(
            ((complex(values[k]), complex(values[k].conjugate())), shapes[:, k])
            for k in np.flatnonzero(values.imag > 0)
        ),
        *_without_oscillation(values, shapes, state, zeros, scale),
    ]
    found = [_mode(both, shape, mass, bodies, scale) for both, shape in pairs]
    return sorted(found, key=lambda mode: (mode.natural_frequency, mode.frequency))


Pair = tuple[tuple[complex, ...], np.ndarray]


def _without_oscillation(
    values: np.ndarray, shapes: np.ndarray, state: StateMatrix, zeros: Zeros, scale: np.ndarray
) -> Iterator[Pair]:
    """Pair real eigenvalues: zeros of one rigid body motion, and real eigenvalues with the most similar shapes.

    A further zero belongs to a free motion with a damper, or to a pose variation without a free velocity (rolling
    constraints), which is no mode. A nonzero eigenvalue of such a pose variation is not paired, like those of states.
    """
    zero = zeros.eigenvectors.shape[1] + zeros.generalised.shape[1]
    rigid = _rigid_motions(state, zeros, scale)[:, : zero // 2]
    for shape in rigid.T:
        yield (0j, 0j), shape
    single = max(0, zero - 2 * rigid.shape[1] - (state.n_poses - state.degrees_of_freedom))
    reals = np.flatnonzero(values.imag == 0)
    found = [*values[reals].real, *[0.0] * single]
    known = [*shapes[:, reals].real.T, *_neutral_poses(state, zeros, rigid, scale).T[:single]]
    known += [np.zeros(len(scale))] * (len(found) - len(known))
    likeness = np.array(known).reshape(len(found), len(scale)) / scale
    pairs = list(_alike(likeness))
    others = max(0, state.degrees_of_freedom - int(np.sum(values.imag > 0)) - rigid.shape[1])
    if state.n_states or len(found) > 2 * others:  # unpaired eigenvalues
        moving = [pair for pair in pairs if all(np.any(np.abs(likeness[k]) > LINEAR_ANALYSIS.no_motion) for k in pair)]
        pairs = moving[:others]
        for k in set(range(len(found))) - {k for pair in pairs for k in pair}:
            yield (complex(found[k]),), known[k].astype(complex)
    for one, other in pairs:
        first, second = sorted((one, other), key=lambda k: -abs(found[k]))
        yield (complex(found[first]), complex(found[second])), known[first].astype(complex)


def _rigid_motions(state: StateMatrix, zeros: Zeros, scale: np.ndarray) -> np.ndarray:
    """Return the free velocities of generalised eigenvectors at zero, shape (n_u, motions).

    Other velocities only follow a pose, such as the lateral velocity of a rolling wheel that has turned.
    """
    rates = state.velocities @ zeros.generalised / scale[:, None]
    free = _free_velocities(state, scale)
    _, sizes, combined = np.linalg.svd(rates - free @ (free.T @ rates))
    accompanying = int(np.sum(sizes > LINEAR_ANALYSIS.close * np.linalg.norm(rates)))
    return np.asarray(scale[:, None] * (rates @ combined[accompanying:].T if accompanying else rates))


def _neutral_poses(state: StateMatrix, zeros: Zeros, rigid: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """Return poses of eigenvectors at zero, shape (n_u, k), in descending order of their non-rigid free velocities."""
    poses = state.poses @ zeros.eigenvectors / scale[:, None]
    if not poses.shape[1]:
        return poses
    free, known = _free_velocities(state, scale), np.linalg.qr(rigid / scale[:, None])[0]
    reached = free @ (free.T @ (poses - known @ (known.T @ poses)))
    return np.asarray(scale[:, None] * (poses @ np.linalg.svd(reached, full_matrices=False)[2].T))


def _free_velocities(state: StateMatrix, scale: np.ndarray) -> np.ndarray:
    """Return an orthonormal basis of the scaled free velocities."""
    own = slice(state.n_poses, state.n_poses + state.degrees_of_freedom)
    return np.linalg.qr(state.velocities[:, own] / scale[:, None])[0]


def _alike(shapes: np.ndarray) -> Iterator[tuple[int, int]]:
    """Yield pairs of shapes, the most similar first (modal assurance criterion)."""
    unit = shapes / np.maximum(np.linalg.norm(shapes, axis=1, keepdims=True), np.finfo(float).tiny)
    likeness = np.triu(np.abs(unit @ unit.T), 1) - np.tril(np.ones((len(shapes), len(shapes))))
    for _ in range(len(shapes) // 2):
        one, other = np.unravel_index(np.argmax(likeness), likeness.shape)
        yield int(one), int(other)
        for taken in (one, other):
            likeness[taken, :] = likeness[:, taken] = -2.0


def _mode(
    both: tuple[complex, ...], shape: np.ndarray, mass: csr_array, bodies: tuple[str, ...], scale: np.ndarray
) -> Mode:
    motion = Motion.OSCILLATING if both[0].imag else Motion.APERIODIC if all(both) else Motion.RIGID
    sizes = shape / scale * scale[0]  # the first entry of a body is a displacement
    if np.max(np.abs(sizes), initial=0.0) <= LINEAR_ANALYSIS.no_motion:  # states only
        return Mode(motion, both, np.zeros(len(shape), dtype=complex), {})
    shape = shape / sizes[np.argmax(np.abs(sizes))]
    energy = (shape.conj() * (mass @ shape)).real.reshape(len(bodies), -1).sum(axis=1)
    shares = dict(zip(bodies, (energy / energy.sum()).tolist(), strict=True))
    return Mode(motion, both, shape, dict(sorted(shares.items(), key=lambda part: -part[1])))
