"""Speeds of a steady motion that forces tell: of a car whose driver works against the air, of a wheel on its tyre.

Each takes the place of a move that changes no force: of all bodies along the motion, or of the wheel about its axis.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csc_array

from ..dynamics import Dynamics
from .steady_motion import SteadyMotion

NO_EFFECT = 1e-12
"""Part of the largest effect of a velocity, on forces or on rates of states, that counts as none."""


@dataclass(frozen=True)
class FoundSpeeds:
    """How a balance of forces and rates of states depends on the speeds that are found.

    Attributes
    ----------
    effect : ndarray, shape (n_u + states, speeds)
        How what is left falls with each.
    momentum : ndarray, shape (n_u + states, speeds)
        Momenta by each.
    held : ndarray, shape (speeds, n_u + states)
        The moves that are zero in their places.
    sizes : ndarray, shape (speeds,)
        Of the speeds, m/s and rad/s.
    """

    effect: np.ndarray
    momentum: np.ndarray
    held: np.ndarray
    sizes: np.ndarray


def with_found_spins(dynamics: Dynamics, motion: SteadyMotion, by_velocity: csc_array) -> SteadyMotion:
    """A motion whose spins are found where forces or rates of states depend on them, and no rolling constraint tells them.

    Parameters
    ----------
    dynamics : Dynamics
    motion : SteadyMotion
    by_velocity : sparse array, shape (n_u + states, n_u)
        Derivatives of the forces, and of the rates of states.
    """
    if motion.is_rest or not len(motion.spinning):
        return motion
    effects = abs(by_velocity).max(axis=0).toarray().ravel()
    depends = effects[motion.spinning] > NO_EFFECT * np.max(effects, initial=0.0)
    return replace(motion, found=np.flatnonzero(depends & ~motion.told_by_rolling(dynamics)))


def found_speeds(dynamics: Dynamics, motion: SteadyMotion, by_velocity: csc_array) -> FoundSpeeds:
    """How the balance depends on the speeds of a motion that are found; parameters as for `with_found_spins`."""
    mass, by = dynamics.system.mass[:, None], motion.by_speeds(dynamics)
    others = np.zeros((by_velocity.shape[0] - len(by), by.shape[1]))
    inertia = np.concatenate([mass * (motion.by_move(dynamics) @ by), others])
    momentum = np.concatenate([mass * by, others])
    return FoundSpeeds(inertia - by_velocity @ by, momentum, momentum.T, motion.speed_sizes(dynamics.system.size))
