"""How far the relaxed formulation lets constraints creep."""

from __future__ import annotations

import numpy as np

from ..describe.settings import RunSettings
from .mechanics import Mechanics

POSITION_CREEP, VELOCITY_CREEP = 1e-9, 1e-12
"""Seconds; measured on mechanisms of 1 kg and 1 m, where lam is 10 to 100 N: no effect on steps and errors."""
TIGHTEST, LOOSEST = 1e-3, 1e3
"""Bounds of the factor by which a tolerance other than 1e-8 changes the creep."""


def relax(mechanics: Mechanics, settings: RunSettings, t: float) -> None:
    """Set the relaxations of all rows for the state at hand.

    E_mu = eps C_q C_q^T and E_lam = eps J M^-1 J^T, by their diagonals, so that lengths, angles, masses and forces of
    any size creep alike; in proportion to the tolerance.
    """
    state, system = mechanics.state, mechanics.system
    state.evaluate("motion", t)
    factor = min(max(settings.rtol / 1e-8, TIGHTEST), LOOSEST)
    scales = []
    for name, weight in (("C_q", np.ones(system.n_u)), ("J", 1 / system.mass)):
        term = system.term("motion", name)
        values = state.values["motion"][term.source]
        scale = np.zeros(system.n_c)
        np.add.at(scale, term.row, values**2 * weight[term.column])
        scales.append(scale)
    state.relax(POSITION_CREEP * factor * scales[0], VELOCITY_CREEP * factor * scales[1])
