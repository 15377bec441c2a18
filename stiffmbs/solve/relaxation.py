"""How far the relaxed formulation lets constraints creep."""

from __future__ import annotations

import numpy as np

from ..compile.system import PLANAR, System
from ..describe.settings import RunSettings
from .mechanics import Mechanics

POSITION_CREEP, VELOCITY_CREEP = 1e-9, 1e-12
"""Seconds; measured on mechanisms of 1 kg and 1 m, where lam is 10 to 100 N: no effect on steps and errors."""
TIGHTEST, LOOSEST = 1e-3, 1e3
"""Bounds of the factor by which a tolerance other than 1e-8 changes the creep."""


def relax(mechanics: Mechanics, settings: RunSettings, t: float) -> None:
    """Set the relaxations of all rows for the state at hand.

    E_mu = eps C_q C_q^T and E_lam = eps J M^-1 J^T, by their diagonals, so that lengths, angles, masses and forces of
    any size creep alike; in proportion to the tolerance.  M is that of the heaviest body, at an arm as long as
    the mechanism: what it weighs may hang on light bodies and small moments of inertia, which by their own measure
    would let their joints creep far beyond the tolerance.
    """
    state, system = mechanics.state, mechanics.system
    state.evaluate("motion", t)
    factor = min(max(settings.rtol / 1e-8, TIGHTEST), LOOSEST)
    scales = []
    for name, weight in (("C_q", np.ones(system.n_u)), ("J", 1 / _heaviest(system))):
        term = system.term("motion", name)
        values = state.values["motion"][term.source]
        scale = np.zeros(system.n_c)
        np.add.at(scale, term.row, values**2 * weight[term.column])
        scales.append(scale)
    state.relax(POSITION_CREEP * factor * scales[0], VELOCITY_CREEP * factor * scales[1])


def _heaviest(system: System) -> np.ndarray:
    """For every body the largest mass, and the largest moment of inertia, as seen from across the mechanism."""
    mass, _, inertia = system.mass.reshape(-1, PLANAR).max(axis=0)
    return np.tile([mass, mass, inertia + mass * system.size**2], system.n_u // PLANAR)
