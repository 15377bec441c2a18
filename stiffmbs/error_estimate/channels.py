"""Errors of all channels over time from the errors of the states: c(z) - c(z - e)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..dynamics.dynamics import Dynamics, OutputRows
from ..dynamics.initial import InitialValues
from ..model.model_data import ModelData
from ..results.channels import channels_of
from ..results.error_bars import ErrorBar, between
from ..solve.missing_rows import reported
from ..solve.subsystems import Subsystem
from ..solve.trajectory import Trajectory
from .along_run import StateErrors
from .second_run import difference


@dataclass(frozen=True)
class ChannelErrors:
    """Values and errors of all channels at the nodes of one mechanism, by name, shape (n,); `t`: s."""

    t: np.ndarray
    values: dict[str, np.ndarray]
    errors: dict[str, np.ndarray]

    def at(self, times: np.ndarray, channel: str) -> np.ndarray:
        """Return the errors of a channel at other times, by linear interpolation."""
        return np.interp(times, self.t, self.errors[channel])


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
    kept = ~found.at_event
    return ChannelErrors(
        found.t[kept], {name: each[kept] for name, each in values.items()},
        {name: each[kept] for name, each in errors.items()},
    )  # fmt: skip


def _rows(dynamics: Dynamics, trajectory: Trajectory, project: bool, rtol: float) -> OutputRows:
    """Return the output rows of states as a run reports them."""
    return reported(dynamics, trajectory, project, rtol)[0]


def bars(times: np.ndarray, channels: dict[str, np.ndarray], parts: Sequence[ChannelErrors]) -> dict[str, ErrorBar]:
    """Return the error bars of the channels of a run from the errors along its mechanisms, one after the other in `parts`."""
    found = {}
    for name, values in channels.items():
        if name.startswith("constraint."):
            continue
        error = np.sum([part.at(times, name) for part in parts], axis=0)
        over_time = float(np.nanmax(np.abs(error), initial=0.0))
        ends = [_peak(sign * values, error, times, parts, name, sign) for sign in (-1.0, 1.0)]
        (least, sampled_least), (greatest, sampled_greatest) = ends
        found[name] = ErrorBar(over_time, least, greatest, sampled_least, sampled_greatest)
    return found


def _peak(
    values: np.ndarray, error: np.ndarray, times: np.ndarray, parts: Sequence[ChannelErrors], name: str, sign: float
) -> tuple[float, float]:
    """Return the error bar of the greatest value, and the part of it between output times."""
    if np.isnan(values).all():
        return np.nan, np.nan
    own = max(parts, key=lambda part: np.ptp(part.values[name]))  # the mechanism of the channel
    t = np.sort(np.concatenate([times, own.t]))
    t = t[np.diff(t, prepend=-np.inf) > 0.0]
    fine, at = np.interp(t, own.t, sign * own.values[name]), np.searchsorted(t, times)
    fine[at] = values
    sampled = between(t, fine, at)
    peak = abs(float(error[int(np.nanargmax(values))]))
    return peak + sampled, sampled
