"""Errors of all channels over time from the errors of the states: c(z) - c(z - e)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..dynamics.dynamics import Dynamics, OutputRows
from ..dynamics.initial import InitialValues
from ..errors import SolverError
from ..model.model_data import ModelData
from ..results.channel_errors import ChannelErrors, difference
from ..results.channels import channels_of
from ..solve.missing_rows import reported
from ..solve.subsystems import Subsystem
from ..solve.trajectory import Trajectory
from .along_run import StateErrors


def channel_errors(
    model: ModelData, dynamics: Dynamics, start: InitialValues, subsystem: Subsystem | None, found: StateErrors,
    trajectory: Trajectory, project: bool, rtol: float,
) -> ChannelErrors:  # fmt: skip
    """Return the errors of all channels of a model at the nodes of one mechanism; other mechanisms stay at the start.

    `project`: True if the output rows of the run are projected onto the constraints.
    """
    states = []
    for q, u in ((found.recorded_q, found.recorded_u), (found.q, found.u)):
        if subsystem is not None:
            whole = np.tile(start.q, (len(q), 1)), np.tile(start.u, (len(u), 1))
            subsystem.part.put(q, u, *whole)
            q, u = whole
        states.append((q, u))
    values, better = (
        channels_of(model, dynamics.system, _rows(dynamics, replace(trajectory, t=found.t, q=q, u=u), projected, rtol))
        for (q, u), projected in zip(states, (project, True), strict=True)
    )
    errors = {name: difference(name, values[name], better[name]) for name in values}
    kept = ~found.left_out
    kept[[0, -1]] = True
    return ChannelErrors(
        found.t[kept], {name: each[kept] for name, each in values.items()},
        {name: each[kept] for name, each in errors.items()}, found.restarts,
    )  # fmt: skip


def _rows(dynamics: Dynamics, trajectory: Trajectory, project: bool, rtol: float) -> OutputRows:
    """Return the output rows of states as a run reports them. Raises SolverError if a state has none."""
    rows, _ = reported(dynamics, trajectory, project, rtol)
    if len(rows.t) != len(trajectory.t):
        raise SolverError("the equations have no finite values at some states moved by their errors")
    return rows
