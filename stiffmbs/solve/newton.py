"""How far Newton's iteration has to be taken, by the stiffness of the scene."""

from __future__ import annotations

import numpy as np

from ..describe.settings import RunSettings
from .mechanics import Mechanics

LOOSEST, TIGHTEST = 0.03, 1e-6
"""Part of the error tolerance that the iteration may leave.  0.03 in place of IDA's own 0.33 saves a quarter of the
steps; tighter than needed, it would fail in poses where the constraints are nearly dependent."""
SOFT = 1e4
"""1/s^2, the square of a rate, times the part that may be left: what remains in a position makes a force through the
stiffness, and the force a velocity, which has to stay below the tolerance too.  Measured on a bushing of 1e9 N/m on
1 kg: 5 000 steps with 0.33, 200 with this."""
NUMBERS_END = 1e-13
"""Least part of a coordinate that the iteration can settle, through iteration matrices as ill-conditioned as they get."""


def newton_tolerance(mechanics: Mechanics, settings: RunSettings, t: float) -> float:
    """The part of the error tolerance that Newton's iteration may leave at the state at hand."""
    state, mass = mechanics.state, mechanics.system.mass
    state.evaluate("tangent", t)
    stiffness, damping = (_largest_row_sum(mechanics, term, mass) for term in ("f_q", "f_u"))
    fastest = max(stiffness, damping**2)
    wanted = LOOSEST if fastest <= 0 else min(LOOSEST, SOFT / fastest)
    return max(wanted, TIGHTEST, NUMBERS_END / settings.rtol)


def _largest_row_sum(mechanics: Mechanics, name: str, mass: np.ndarray) -> float:
    """The largest sum of magnitudes in a row of M^-1 times a term of the tangent set."""
    term = mechanics.system.term("tangent", name)
    sums = np.zeros(len(mass))
    np.add.at(sums, term.row, np.abs(mechanics.state.values["tangent"][term.source]))
    return float(np.max(sums / mass, initial=0.0))
