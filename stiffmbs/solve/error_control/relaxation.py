"""How far the relaxed formulation lets constraints creep."""

from __future__ import annotations

import numpy as np

from ...compile.system import System
from ...describe.settings import RunSettings
from ..dynamics import Dynamics

POSITION_CREEP, VELOCITY_CREEP = 1e-9, 1e-12
"""Seconds; measured on mechanisms of 1 kg and 1 m, where lam is 10 to 100 N: no effect on steps and errors."""
SHORT = 100
"""Bodies beyond which joints creep less, by the square of their number: in a long chain each holds more, and their creep adds up.
(A chain of 1000 rods at rtol 1e-6: off by 4e-4 m without this, by the tolerance's own 1e-5 with it.)"""
TIGHTEST, LOOSEST = 1e-3, 1e3
"""Bounds of the factor by which a tolerance other than 1e-8 changes the creep."""


def relax(dynamics: Dynamics, settings: RunSettings, t: float) -> None:
    """Set the relaxations of all rows for the state at hand.

    E_mu = eps C_q C_q^T and E_lam = eps J M^-1 J^T, by their diagonals, so that lengths, angles, masses and forces of
    any size creep alike; in proportion to the tolerance.  M is that of the heaviest body, at an arm as long as
    the mechanism: what it weighs may hang on light bodies and small moments of inertia, which by their own measure
    would let their joints creep far beyond the tolerance.
    """
    state, system = dynamics.state, dynamics.system
    if not system.n_c:
        return
    state.evaluate("motion", t)
    positions, velocities = system.term("motion", "C_q"), system.term("motion", "J")
    C_q, J = state.values["motion"][positions.source], state.values["motion"][velocities.source]
    of_positions = np.bincount(positions.row, C_q * C_q, minlength=system.n_c)
    of_velocities = np.bincount(velocities.row, J * J * lightness(dynamics)[velocities.column], minlength=system.n_c)
    creep = creep_of_positions(settings), creep_of_velocities(settings, system)
    state.relax(creep[0] * of_positions, creep[1] * of_velocities)


def creep_of_positions(settings: RunSettings) -> float:
    """E_mu for an entry 1 in a row of C_q."""
    return POSITION_CREEP * _factor(settings)


def creep_of_velocities(settings: RunSettings, system: System) -> float:
    """E_lam for an entry 1 in a row of J, of a velocity of lightness 1."""
    return VELOCITY_CREEP * _factor(settings) * min(1.0, (SHORT / len(system.bodies)) ** 2)


def lightness(dynamics: Dynamics) -> np.ndarray:
    """One over the mass and moment of inertia that velocities are taken for, shape (n_u,)."""
    return dynamics.kept("relaxation", None, lambda: 1 / _heaviest(dynamics.system))


def _factor(settings: RunSettings) -> float:
    return min(max(settings.rtol / 1e-8, TIGHTEST), LOOSEST)


def _heaviest(system: System) -> np.ndarray:
    """For every body the largest mass, and the largest moment of inertia, as seen from across the mechanism."""
    of_body = system.of_body
    largest = system.mass.reshape(-1, of_body.n_u).max(axis=0)
    mass, inertia = largest[0], largest[of_body.linear :].max()
    return system.per_velocity(mass, inertia + mass * system.size**2)
