"""Reasons to end the steps of IDA or a Radau method: failures, rounding, and drift from the constraints."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...dynamics.algebraic_states import no_value_ahead
from ...dynamics.dynamics import Dynamics
from ...errors import SolverError
from ...model.settings import RunSettings
from ..engine import Reached
from ..error_control.precision import governed_by_rounding, too_fine
from ..error_control.relaxation import RELAXATION, refuse_drift
from ..events.chattering import CHATTERING
from ..explicit.native.parameters import CONTROL
from ..reasons import Reason
from ..suspect import suspect
from ..trajectory import Grid

if TYPE_CHECKING:
    from .native_engine import NativeEngine


def refuse(engine: NativeEngine, dynamics: Dynamics, settings: RunSettings, reached: Reached, grid: Grid) -> None:
    """Raise a SolverError if steps have failed, are governed by rounding, or have drifted from the constraints."""
    if failure := _failure(engine, dynamics, settings, reached, grid):
        raise SolverError(Reason.NO_STEP.of(f"stopped at t = {reached.t:.9g} s: {failure}"))
    if reached.t < grid.end and engine.steps() >= RELAXATION.check_interval:
        refuse_drift(dynamics, reached.t, *engine.split(reached.y), settings)


def _failure(engine: NativeEngine, dynamics: Dynamics, settings: RunSettings, reached: Reached, grid: Grid) -> str:
    """Return the reason why the run ends at this state, or an empty string."""
    steps = engine.steps()
    endless = (grid.end - reached.t) * steps > CHATTERING.steps_ahead * (reached.t - grid.start)
    by_rounding = steps > CONTROL.enough_steps and (endless or governed_by_rounding(engine.statistics()))
    if not (by_rounding or reached.failure):
        return ""
    q, u = engine.split(reached.y)
    missing = no_value_ahead(dynamics, reached.t, q, u) if reached.failure else ""
    reason = missing or too_fine(dynamics, settings, reached.t, q)
    if reason or not reached.failure:
        return reason
    return reached.failure + suspect(dynamics, reached.t, q, u)
