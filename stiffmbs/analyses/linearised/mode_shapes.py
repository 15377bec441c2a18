"""One period of a natural mode as results over time, to be drawn, animated and saved like those of a run."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.sparse import csr_array

from ...dynamics.algebraic_states import failure
from ...errors import SolverError
from ...linear_analysis.modes import Mode, Motion
from ...results.energy_balance import energy_balance
from ...results.solution import Solution
from ..solution_at_rest import solution_of_rows
from .at_state import AtState

UNHURRIED = 1.0
"""Period shown for a mode that does not oscillate, s."""


def mode_shape(found: AtState, own_axes: csr_array, mode: Mode, number: int, amplitude: float, points: int) -> Solution:
    """Return one period of a mode about a state, at constant amplitude; parameters and errors as for `Modes.shape`.

    `own_axes` transforms from ground axes to the axes of u.
    """
    dynamics, state = found.dynamics, found.dynamics.state
    system = dynamics.system
    oscillates = mode.motion is Motion.OSCILLATING
    rate = abs(mode.eigenvalues[0].imag) if oscillates else 2 * np.pi / UNHURRIED
    time = np.linspace(0.0, 2 * np.pi / rate, points)
    turning = np.exp(1j * rate * time)[:, None] * (mode.shape if oscillates else -1j * mode.shape.real)
    size = amplitude * system.size
    q, u = state.q.copy(), state.u.copy()
    moved = np.array([system.of_body.moved(q, own_axes @ move) for move in size * turning.real])
    rates = np.array([u + own_axes @ way for way in size * (1j * rate * turning).real])
    with state.unchanged():
        rows = dynamics.report(np.full(points, found.t), moved, rates, project=True)
    if len(rows.t) < points:
        raise SolverError(
            f"mode {number} cannot be shown with an amplitude of {amplitude:g} of the mechanism's size: "
            f"{failure(dynamics, rows.status, found.t)}; expected a smaller amplitude"
        )
    message = (
        f"one period of mode {number}, {mode.natural_frequency:.6g} Hz" if oscillates else f"mode {number}, to and fro"
    )
    solution = solution_of_rows(
        f"{found.data.name or 'model'}, mode {number}", found.data, system, rows, found.redundancy.not_unique, message, (),
        {"name": "modes", "steps": 0},
    )  # fmt: skip
    return replace(solution, time=time, balance=energy_balance(system, replace(rows, t=time), np.empty(0)))
