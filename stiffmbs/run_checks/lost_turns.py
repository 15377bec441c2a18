"""Note on unwrapped angles with missed revolutions."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..compile.machine.layout import address, addresses
from ..compile.machine.routines import Routine
from ..compile.state import State
from ..compile.written_values import writer
from ..dynamics.dynamics import Dynamics, OutputRows
from .instants import some_instants

APART_FROM_COUNTERS = Routine(
    "stiffmbs.run_checks.native.turns",
    "apart_from_counters",
    "void(int64, int64, float64*, float64*, int64, int64*, int64*, float64*, int64*)",
)

UNCERTAIN_TURN = 1.0
"""Difference of an orientation and the integral of its rate, rad, from which on the turn is uncertain."""


def lost_turns_sentence(dynamics: Dynamics, rows: OutputRows) -> Iterator[str]:
    """Yield a sentence on the angle that differs most from the counter of its turns, if the turn is uncertain."""
    system, state = dynamics.system, dynamics.state
    solved = np.flatnonzero(~np.isnan(rows.position_violation))
    if not len(solved):
        return
    counted = system.term("position", "continuous_angle")
    instants = solved[some_instants(len(solved))]
    apart = _apart(state, rows.t[instants], rows.q[instants], counted.source, counted.row)
    if not np.nanmax(apart) > UNCERTAIN_TURN:
        return
    k, worst = np.unravel_index(int(np.nanargmax(apart)), apart.shape)
    name = writer(system, "position", int(counted.source[worst]))
    yield (
        f"whole turns of the angle of '{name}' are not certain: at t = {rows.t[instants[k]]:.6g} s the orientations and the integral of "
        f"the angular velocity differ by {apart[k, worst]:.2g} rad; the steps are too long for the speed (tighten rtol, or shorten step), "
        "or the angle's reference axis comes to lie along the axis of rotation"
    )


def _apart(state: State, t: np.ndarray, q: np.ndarray, source: np.ndarray, row: np.ndarray) -> np.ndarray:
    """Return the distances of angles (position terms) from their counters, rad, shape (len(t), len(row))."""
    state.load("position")
    apart = np.empty((len(t), len(row)))
    source, row = (np.ascontiguousarray(places, dtype=np.int64) for places in (source, row))
    at_t, at_q, at_source, at_row, at_apart = addresses(t, q, source, row, apart)
    APART_FROM_COUNTERS.call(*q.shape, at_t, at_q, len(row), at_source, at_row, at_apart, address(state.table))
    return apart
