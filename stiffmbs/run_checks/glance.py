"""Scan of the output rows for NaN, drift and contradictions."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..compile.machine.layout import addresses
from ..compile.machine.routines import Routine
from ..compile.system import System
from ..results.energy_balance import MOST_INSTANTS
from ..solve.dynamics import OutputRows

GLANCE = Routine(
    "stiffmbs.run_checks.native.glance",
    "glance",
    "int64(int64, int64, int64, int64, float64*, float64*, float64*, float64*, float64*, float64*, float64*, float64*, float64*, "
    "int64, float64, int64, float64*, float64*, float64*, int64*, float64*)",
)


class Glance(NamedTuple):
    """Result of a scan of finite rows at increasing times.

    Attributes
    ----------
    exchanged : float
        Energy: the largest kinetic energy, change of the potential energy, or work, J.
    missing : float
        Largest error of the energy balance, since the start or between two rows, J.
    width_q, width_u : float
        Bounds of the displacement of any coordinate from its start, and of any velocity.
    contradicting : int
        Rows that contradict the next one within a step (`stiffmbs.run_checks.overlooked`).
    """

    exchanged: float
    missing: float
    width_q: float
    width_u: float
    contradicting: int


def glance_at(system: System, rows: OutputRows, steps: np.ndarray, part: float) -> Glance | None:
    """Scan all rows in one pass; return None if they are not finite at increasing times, or are too many.

    Parameters
    ----------
    system : System
    rows : OutputRows
    steps : ndarray
        Ends of the solver's own steps, s.
    part : float
        Difference that is a contradiction, relative to the larger acceleration.
    """
    count = len(rows.t)
    if not 0 < count < MOST_INSTANTS or not (
        system.n_c == 0 or np.isfinite([rows.position_violation, rows.velocity_violation]).all()
    ):
        return None
    found, memory, contradicting = np.zeros(5), np.empty((2, count)), np.empty(count, dtype=np.int64)
    arrays = (
        rows.t,
        rows.q,
        rows.u,
        rows.acceleration,
        rows.values,
        system.mass,
        rows.kinetic,
        rows.potential,
        rows.power,
    )
    kept = [np.ascontiguousarray(array, dtype=float) for array in (*arrays, steps)]
    *of_rows, at_steps = addresses(*kept)
    known = GLANCE.call(
        count, system.n_q, system.n_u, rows.values.shape[1], *of_rows, system.keeps_energy, part, len(steps), at_steps,
        *addresses(memory[0], memory[1], contradicting, found),
    )  # fmt: skip
    exchanged, missing, width_q, width_u, pairs = found.tolist()
    return Glance(exchanged, missing, width_q, width_u, int(pairs)) if known else None
