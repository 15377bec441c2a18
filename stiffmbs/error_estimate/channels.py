"""Errors of all channels over time from the errors of the states: c(z) - c(z - e)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..dynamics.dynamics import Dynamics, OutputRows
from ..dynamics.initial import InitialValues
from ..errors import SolverError
from ..model.model_data import ModelData
from ..results.channels import channels_of
from ..results.error_bars import ChannelErrors, difference
from ..solve.missing_rows import reported
from ..solve.subsystems import Subsystem
from ..solve.trajectory import Trajectory
from .along_run import StateErrors
from .coordinates import as_rows, displaced
from .vibrations import FastMotions

Channels = dict[str, np.ndarray]
"""Values of all channels by name."""


@dataclass(frozen=True)
class _Reports:
    """Channels of states as a run with the tolerance `rtol` reports them; `project`: True if its states are projected."""

    model: ModelData
    dynamics: Dynamics
    run: Trajectory
    project: bool
    rtol: float

    def rows(self, t: np.ndarray, q: np.ndarray, u: np.ndarray, project: bool) -> OutputRows:
        """Return the output rows of states."""
        return reported(self.dynamics, replace(self.run, t=t, q=q, u=u), project, self.rtol)[0]

    def channels(self, rows: OutputRows, count: int) -> Channels:
        """Return the channels of `count` states from their rows. Raises SolverError if one has none."""
        if len(rows.t) != count:
            raise SolverError("the equations have no finite values at some states moved by their errors")
        return channels_of(self.model, self.dynamics.system, rows)

    def errors(self, values: Channels, t: np.ndarray, q: np.ndarray, u: np.ndarray, of_states: np.ndarray) -> Channels:
        """Return the errors of the channels of states with errors (dq, du, ds), from their values.

        The states without these errors are projected without regard to stiff forces, with which they are not in balance anyway.
        """
        rows = self.dynamics.report(t, *displaced(self.dynamics.system, q, u, -of_states), True)
        better = self.channels(rows, len(t))
        return {name: difference(name, values[name], better[name]) for name in better}


@dataclass(frozen=True, eq=False)
class _Nodes:
    """States of a run at the nodes of its estimate, their errors (dq, du, ds), and the values and errors of the channels.

    `neighbours`: mask of the intervals between nodes in which none was left out.
    """

    t: np.ndarray
    q: np.ndarray
    u: np.ndarray
    of_states: np.ndarray
    values: Channels
    errors: Channels
    neighbours: np.ndarray

    def line(self, t: np.ndarray, first: np.ndarray, last: np.ndarray) -> np.ndarray:
        """Return the errors of states at some times, each on the straight line through those at two nodes."""
        part = np.minimum((t - self.t[first]) / (self.t[last] - self.t[first]), 1.0)[:, None]
        return self.of_states[first] + part * (self.of_states[last] - self.of_states[first])


def channel_errors(
    model: ModelData, dynamics: Dynamics, start: InitialValues, subsystem: Subsystem | None, found: StateErrors,
    channels: Channels, trajectory: Trajectory, project: bool, rtol: float,
) -> ChannelErrors:  # fmt: skip
    """Return the errors of all channels of a model by one mechanism, without those of others.

    `channels`: those of the run. `project`: True if the output rows of the run are projected onto the constraints.
    """
    reports, count = _Reports(model, dynamics, trajectory, project, rtol), len(found.t)

    def whole(q: np.ndarray, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return states of the model from those of the mechanism."""
        if subsystem is None:
            return q, u
        states = np.tile(start.q, (len(q), 1)), np.tile(start.u, (len(q), 1))
        subsystem.part.put(q, u, *states)
        return states

    rows = [found.rows] if project and subsystem is None else []
    states = [(found.recorded_q, found.recorded_u, project), (found.q, found.u, True)]
    rows += [reports.rows(found.t, *whole(q, u), projected) for q, u, projected in states[len(rows) :]]
    kept = ~found.left_out
    kept[0] = True
    values, better = ({name: each[kept] for name, each in reports.channels(of, count).items()} for of in rows)
    errors = {name: difference(name, values[name], better[name]) for name in values}
    at, without = (of.at(kept) for of in rows)
    of_states = as_rows(dynamics.system, at.q - without.q, at.u - without.u)
    nodes = _Nodes(at.t, at.q, at.u, of_states, values, errors, np.diff(np.flatnonzero(kept)) == 1)
    of_outputs = _at_outputs(reports, nodes, channels)
    if found.fast:
        system = subsystem.dynamics.system if subsystem else dynamics.system
        at_start = found.q[:1], found.u[:1]
        count = len(found.fast.decays)
        q, u = (np.repeat(each, count, axis=0) for each in at_start)
        moved = [whole(*displaced(system, q, u, -each)) for each in found.fast.phases]
        of_outputs = _with_fast_motions(reports, found.fast, whole(*at_start), moved, of_outputs)
    return ChannelErrors(at.t, values, of_outputs, found.restarts)


def _with_fast_motions(
    reports: _Reports, fast: FastMotions, start: tuple[np.ndarray, np.ndarray],
    moved: list[tuple[np.ndarray, np.ndarray]], errors: Channels,
) -> Channels:  # fmt: skip
    """Return errors at output times that are not smaller than those by fast motions that are not in the results.

    `start`: state at the start. `moved`: states without the displacements of each of the phases.
    """
    t = np.full(1 + len(fast.decays), fast.t)
    squares = {name: np.zeros(len(fast.decays)) for name in errors}
    try:
        for each in moved:
            q, u = (np.vstack(pair) for pair in zip(start, each, strict=True))
            rows = reports.dynamics.report(t, q, u, True)
            for name, values in reports.channels(rows, len(t)).items():
                squares[name] += difference(name, np.repeat(values[:1], len(fast.decays)), values[1:]) ** 2
    except SolverError:
        return errors
    left = fast.sizes(reports.run.t[: len(next(iter(errors.values())))])
    sizes = {name: np.sqrt(squares[name]) @ left for name in errors}
    return {name: np.where(np.abs(error) < sizes[name], sizes[name], error) for name, error in errors.items()}


def _at_outputs(reports: _Reports, nodes: _Nodes, channels: Channels) -> Channels:
    """Return the errors of the channels of a run at its output times.

    Errors of states between two nodes are interpolated: those of channels are not linear where a force changes with a small
    velocity, as friction does. Stiff forces need errors of states that are in balance, which interpolated ones are not: then those
    of the channels are interpolated. This is so where the errors of a node's neighbours give its channel an error that is wrong by
    its size. Next to an event, states without their errors lie on its other side: the smaller of both errors is not the jump there.
    """
    run, count = reports.run, len(next(iter(channels.values())))
    t, q, u = run.t[:count], run.q[:count], run.u[:count]
    first = np.clip(np.searchsorted(nodes.t, t, side="right") - 1, 0, len(nodes.t) - 2)
    interpolated = {name: np.interp(t, nodes.t, each) for name, each in nodes.errors.items()}
    if len(nodes.t) < 3:
        return interpolated
    inner = np.arange(1, len(nodes.t) - 1)
    try:
        of_outputs = reports.errors(channels, t, q, u, nodes.line(t, first, first + 1))
        alone = reports.errors(
            {name: each[inner] for name, each in nodes.values.items()}, nodes.t[inner], nodes.q[inner], nodes.u[inner],
            nodes.line(nodes.t[inner], inner - 1, inner + 1),
        )  # fmt: skip
    except SolverError:
        return interpolated
    found = {}
    for name, errors in nodes.errors.items():
        off = np.pad(np.abs(alone[name] - errors[inner]), 1, mode="reflect")  # an end has no neighbours
        sizes = np.abs(errors)
        holds = nodes.neighbours & (np.maximum(off[:-1], off[1:]) <= np.maximum(sizes[:-1], sizes[1:]))
        direct, line = of_outputs[name], interpolated[name]
        found[name] = np.where(holds[first] | (np.abs(direct) < np.abs(line)), direct, line)
    return found
