"""Errors of all channels over time from the errors of the states: c(z) - c(z - e)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import permutations

import numpy as np

from ..compile.system import System
from ..dynamics.dynamics import Dynamics, OutputRows
from ..dynamics.initial import InitialValues
from ..errors import SolverError
from ..model.model_data import ModelData
from ..results.channels import channels_of
from ..results.error_bars import ChannelErrors, differences
from ..solve.missing_rows import reported
from ..solve.subsystems import Subsystem
from ..solve.trajectory import Trajectory
from .along_run import StateErrors
from .coordinates import as_rows, displaced
from .defects import windows
from .parameters import ESTIMATE
from .vibrations import FastMotions

Channels = dict[str, np.ndarray]
"""Values of channels by name, shape (n,)."""
OfOutputs = Callable[[slice], np.ndarray]
"""Errors of the channels at some output times, shape (channels, n)."""


@dataclass(frozen=True, eq=False)
class _Reports:
    """Channels of states as a run with the tolerance `rtol` reports them, in the order of their `names`.

    `project`: True if its states are projected.
    """

    model: ModelData
    dynamics: Dynamics
    run: Trajectory
    project: bool
    rtol: float
    names: list[str]

    def rows(self, t: np.ndarray, q: np.ndarray, u: np.ndarray, project: bool) -> OutputRows:
        """Return the output rows of states."""
        return reported(self.dynamics, replace(self.run, t=t, q=q, u=u), project, self.rtol)[0]

    def channels(self, rows: OutputRows, count: int) -> np.ndarray:
        """Return the channels of `count` states from their rows, shape (channels, n). Raises SolverError if one has none."""
        if len(rows.t) != count:
            raise SolverError("the equations have no finite values at some states moved by their errors")
        return self.stacked(channels_of(self.model, self.dynamics.system, rows), slice(None))

    def stacked(self, channels: Channels, block: slice) -> np.ndarray:
        """Return some of the values of channels, shape (channels, n)."""
        return np.array([channels[name][block] for name in self.names])

    def errors(
        self, values: np.ndarray, t: np.ndarray, q: np.ndarray, u: np.ndarray, of_states: np.ndarray
    ) -> np.ndarray:
        """Return the errors of the channels of states with errors (dq, du, ds), from their values, shape (channels, n).

        The states without these errors are projected without regard to stiff forces, with which they are not in balance anyway.
        """
        rows = self.dynamics.report(t, *displaced(self.dynamics.system, q, u, -of_states), True)
        return differences(self.names, values, self.channels(rows, len(t)))


@dataclass(frozen=True, eq=False)
class _Nodes:
    """States of a run at the nodes of its estimate, their errors (dq, du, ds), and the values and errors of the channels.

    `neighbours`: mask of the intervals between nodes in which none was left out. `of_bdf`: True if they are ends of steps of bdf.
    `own`: mask of the states with rates that belong to the mechanism; others have their values at the start.
    """

    t: np.ndarray
    q: np.ndarray
    u: np.ndarray
    of_states: np.ndarray
    values: np.ndarray
    errors: np.ndarray
    neighbours: np.ndarray
    of_bdf: bool
    own: np.ndarray

    def interpolated(self, t: np.ndarray, before: np.ndarray, after: np.ndarray) -> np.ndarray:
        """Return the errors of states at some times by those at the two nodes next to each, and at two more where steps are even."""
        t = np.clip(t, self.t[0], self.t[-1])
        rows = np.column_stack([before - 1, before, after, after + 1])
        cubic = (rows[:, 0] >= 0) & (rows[:, 3] < len(self.t))
        inside = rows[cubic]
        sizes = np.diff(self.t[inside], axis=1)
        even = sizes.max(axis=1) <= ESTIMATE.uneven * sizes.min(axis=1)
        cubic[cubic] = even & (self.pieces[inside[:, 0]] == self.pieces[inside[:, 3]])
        found = np.empty((len(t), self.of_states.shape[1]))
        for chosen, of in ((cubic, rows), (~cubic, rows[:, 1:3])):
            found[chosen] = self._through(self.of_states, t[chosen], of[chosen])
        return found

    def off_curve(self, system: System, t: np.ndarray, q: np.ndarray, before: np.ndarray) -> np.ndarray:
        """Return the distances of states with rates within steps of bdf from the curve through its steps, as errors of states.

        `before`: node before each time. The interpolant of bdf has its order and only states of the past: it misses fast states,
        which follow slow ones, by more than their errors at the ends of steps. Distances are zero where no curve is known.
        """
        found, states = np.zeros((len(t), self.of_states.shape[1])), system.with_rates[self.own]
        if not self.of_bdf or not len(states) or len(self.t) < ESTIMATE.points:
            return found
        first, unknown = windows(self.t, before, before + 1, ESTIMATE.points)
        rows = first[:, None] + np.arange(ESTIMATE.points)
        known = ~unknown & (self.pieces[rows[:, 0]] == self.pieces[rows[:, -1]])
        known &= (t > self.t[before]) & (t < self.t[before + 1])
        curve = self._through(self.q[:, states], t[known], rows[known])
        columns = found.shape[1] - len(self.own) + np.flatnonzero(self.own)
        found[np.ix_(known, columns)] = q[np.ix_(known, states)] - curve
        return found

    def _through(self, values: np.ndarray, t: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """Return values at times, each by the polynomial through those at some nodes, shape (n, k)."""
        nodes, weights = self.t[rows], np.ones(rows.shape)
        for i, j in permutations(range(rows.shape[1]), 2):
            weights[:, i] *= (t - nodes[:, j]) / (nodes[:, i] - nodes[:, j])
        return np.asarray(np.einsum("nk,nkf->nf", weights, values[rows]))

    @cached_property
    def pieces(self) -> np.ndarray:
        """Numbers of the pieces of the run without nodes left out to which the nodes belong."""
        return np.append(0, np.cumsum(~self.neighbours))


def channel_errors(
    model: ModelData, dynamics: Dynamics, start: InitialValues, subsystem: Subsystem | None, found: StateErrors,
    channels: Channels, trajectory: Trajectory, project: bool, rtol: float,
) -> ChannelErrors:  # fmt: skip
    """Return the errors of all channels of a model by one mechanism, without those of others.

    `channels`: those of the run. `project`: True if the output rows of the run are projected onto the constraints.
    """
    names = [name for name in channels if not name.startswith("constraint.")]
    reports, count = _Reports(model, dynamics, trajectory, project, rtol, names), len(found.t)

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
    values, better = (reports.channels(of, count)[:, kept] for of in rows)
    at, without = (of.at(kept) for of in rows)
    of_states = as_rows(dynamics.system, at.q - without.q, at.u - without.u)
    errors, neighbours = differences(names, values, better), np.diff(np.flatnonzero(kept)) == 1
    with_rates = dynamics.system.with_rates
    own = np.isin(with_rates, subsystem.part.trailing) if subsystem else np.ones(len(with_rates), dtype=bool)
    nodes = _Nodes(at.t, at.q, at.u, of_states, values, errors, neighbours, found.of_bdf, own)
    of_outputs: OfOutputs = _AtOutputs(reports, nodes, channels).errors
    if found.fast:
        system = subsystem.dynamics.system if subsystem else dynamics.system
        at_start = found.q[:1], found.u[:1]
        count = len(found.fast.decays)
        q, u = (np.repeat(each, count, axis=0) for each in at_start)
        moved = [whole(*displaced(system, q, u, -each)) for each in found.fast.phases]
        of_outputs = _with_fast_motions(reports, found.fast, whole(*at_start), moved, of_outputs)
    return ChannelErrors(names, at.t, values, of_outputs, found.restarts)


def _with_fast_motions(
    reports: _Reports, fast: FastMotions, start: tuple[np.ndarray, np.ndarray],
    moved: list[tuple[np.ndarray, np.ndarray]], errors: OfOutputs,
) -> OfOutputs:  # fmt: skip
    """Return errors at output times that are not smaller than those by fast motions that are not in the results.

    `start`: state at the start. `moved`: states without the displacements of each of the phases.
    """
    t = np.full(1 + len(fast.decays), fast.t)
    squares = np.zeros((len(reports.names), len(fast.decays)))
    try:
        for each in moved:
            q, u = (np.vstack(pair) for pair in zip(start, each, strict=True))
            values = reports.channels(reports.dynamics.report(t, q, u, True), len(t))
            squares += differences(reports.names, values[:, :1], values[:, 1:]) ** 2
    except SolverError:
        return errors

    def with_them(block: slice) -> np.ndarray:
        sizes, found = np.sqrt(squares) @ fast.sizes(reports.run.t[block]), errors(block)
        return np.where(np.abs(found) < sizes, sizes, found)

    return with_them


@dataclass(frozen=True, eq=False)
class _AtOutputs:
    """Errors of the channels of a run at its output times.

    Errors of states between two nodes are interpolated: those of channels are not linear where a force changes with a small
    velocity, as friction does. Stiff forces need errors of states that are in balance, which interpolated ones are not: then those
    of the channels are interpolated. This is so where the errors of a node's neighbours give its channel an error that is wrong by
    its size. Next to an event, states without their errors lie on its other side: the smaller of both errors is not the jump there.
    Errors of the interpolation of states within steps are added.
    """

    reports: _Reports
    nodes: _Nodes
    channels: Channels

    def errors(self, block: slice) -> np.ndarray:
        """Return the errors at some output times, shape (channels, n)."""
        nodes, t = self.nodes, self.reports.run.t[block]
        line = np.array([np.interp(t, nodes.t, each) for each in nodes.errors])
        if self._hold is None:
            return line
        first = np.clip(np.searchsorted(nodes.t, t, side="right") - 1, 0, len(nodes.t) - 2)
        found = self._from_nodes(block, first, line)
        off_curve = nodes.off_curve(self.reports.dynamics.system, t, self.reports.run.q[block], first)
        if not off_curve.any():
            return found
        try:
            return np.asarray(found + self._by(block, off_curve))
        except SolverError:
            return found

    def _by(self, block: slice, of_states: np.ndarray) -> np.ndarray:
        """Return the errors at some output times by errors of the states there. Raises SolverError if a state has no solution."""
        run, values = self.reports.run, self.reports.stacked(self.channels, block)
        return self.reports.errors(values, run.t[block], run.q[block], run.u[block], of_states)

    def _from_nodes(self, block: slice, first: np.ndarray, line: np.ndarray) -> np.ndarray:
        """Return the errors at some output times from those at the nodes, `first` being the node before each, and `line` between them."""
        try:
            direct = self._by(block, self.nodes.interpolated(self.reports.run.t[block], first, first + 1))
        except SolverError:
            return line
        assert self._hold is not None
        return np.where(self._hold[:, first] | (np.abs(direct) < np.abs(line)), direct, line)

    @cached_property
    def _hold(self) -> np.ndarray | None:
        """Mask of the intervals between nodes in which interpolated errors of states hold, shape (channels, n); None if none do."""
        nodes = self.nodes
        if len(nodes.t) < 3:
            return None
        inner = np.arange(1, len(nodes.t) - 1)
        of_states = nodes.interpolated(nodes.t[inner], inner - 1, inner + 1)
        try:
            alone = self.reports.errors(
                nodes.values[:, inner], nodes.t[inner], nodes.q[inner], nodes.u[inner], of_states
            )
        except SolverError:
            return None
        off = np.pad(
            np.abs(alone - nodes.errors[:, inner]), ((0, 0), (1, 1)), mode="reflect"
        )  # an end has no neighbours
        sizes = np.abs(nodes.errors)
        return nodes.neighbours & (np.maximum(off[:, :-1], off[:, 1:]) <= np.maximum(sizes[:, :-1], sizes[:, 1:]))
