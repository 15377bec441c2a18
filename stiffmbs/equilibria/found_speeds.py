"""Speeds of a steady motion that forces determine, such as that of a car against drag or of a wheel.

Each replaces a displacement that changes no force: of all bodies along the motion or, for a rate of rotation, to its
side, or of the wheel about its axis.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..dynamics.dynamics import Dynamics
from .matrices import Matrix, dense
from .parameters import EQUILIBRIA
from .steady_motion import SteadyMotion


@dataclass(frozen=True)
class FoundSpeeds:
    """Derivatives of the balance of forces and rates of states by the unknown speeds.

    - `effect` of shape (n_u + states, speeds): negative derivative of the residual by each speed.
    - `momentum` of shape (n_u + states, speeds): momenta by each speed.
    - `held` of shape (speeds, n_u + states): displacements fixed in place of the speeds.
    - `sizes` of shape (speeds,): magnitudes of the speeds, m/s and rad/s.
    """

    effect: np.ndarray
    momentum: np.ndarray
    held: np.ndarray
    sizes: np.ndarray


def with_found_spins(dynamics: Dynamics, motion: SteadyMotion, by_velocity: Matrix) -> SteadyMotion:
    """Return a motion whose spins are unknown if forces or states, but no rolling constraints, depend on them.

    `by_velocity` of shape (n_u + states, n_u): derivatives of the forces and of the rates of states.
    """
    if motion.is_rest or not len(motion.spinning):
        return motion
    effects = dense(abs(by_velocity).max(axis=0)).ravel()
    depends = effects[motion.spinning] > EQUILIBRIA.no_effect * np.max(effects, initial=0.0)
    return replace(motion, found=np.flatnonzero(depends & ~motion.fixed_by_rolling(dynamics)))


def found_speeds(dynamics: Dynamics, motion: SteadyMotion, by_velocity: Matrix) -> FoundSpeeds:
    """Return the derivatives of the balance by the unknown speeds; parameters as for `with_found_spins`."""
    mass, by = dynamics.system.mass[:, None], motion.by_speeds(dynamics)
    others = np.zeros((by_velocity.shape[0] - len(by), by.shape[1]))
    inertia = np.concatenate([mass * motion.accelerated_by_speeds(dynamics, by), others])
    momentum = np.concatenate([mass * motion.replaced(dynamics, by), others])
    return FoundSpeeds(inertia - by_velocity @ by, momentum, momentum.T, motion.speed_sizes(dynamics.system.size))
