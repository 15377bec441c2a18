"""Tables whose range a run has left, with the distance and the duration; drives whose positions follow tables.

The steps of integrators record the arguments of tables in force laws (`stiffmbs.solve.events.native.outside`). Arguments
that depend on time alone are known without a run. Solvers that do not search their steps for events, and requests, are
judged at the output times.
"""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace

import numpy as np

from ..compile.inputs.of_time import TABLE, Given, Input, expressions_of, given_to
from ..compile.inputs.table_ranges import TableRanges
from ..compile.state import State
from ..compile.system import System
from ..compile.table_values import curve, ends_of, spline_data
from ..compile.written_values import table_arguments, tables_in
from ..dynamics.dynamics import OutputRows
from ..elements.element import Element, Joint
from ..elements.joints.drive import Drive
from ..elements.states.amount import TABLE as INPUT_TABLE
from ..errors import SolverError
from ..model.model_data import ModelData
from ..model.settings import RunSettings
from ..notes import Note, NoteKind, of_users
from ..reading.table import Table
from ..results.channels import counters
from ..solve.events.departures import ROUNDING, Departure, merged, refused_departure
from ..solve.settings import traits_of
from ..solve.trajectory import Trajectory

SAMPLES = 2001
"""Times between which arguments that depend on time alone are taken as straight lines."""
OF_FIELD = "the table "
"""Beginning of the text of an input that is the table of a field."""
_DEPARTURE = (
    "the table '{label}' was left for {duration:.3g} s, first at t = {first:.6g} s: its argument reaches {reached:.6g}, "
    "{beyond:.3g} beyond its {end}, "
)
_POINTS = "(its points have values from {least:.6g} to {greatest:.6g})"
EXTENDED = NoteKind("table-extended", f"{_DEPARTURE}where it is extrapolated {_POINTS}")
LEFT = NoteKind(
    "table-left",
    f"{_DEPARTURE}and the slope there continues it to {{continued:.6g}} {_POINTS}",
    "state 'beyond': hold, extend, error or repeat, or give more points",
)
SMOOTH_CURVES = "use 'spline: true', or 'smoothing' with the accuracy of measured points"
KINKED = NoteKind(
    "drive-by-lines",
    "{element}: the position by the table '{label}' follows straight lines, so velocities jump at the points: the effort of "
    "the drive and all reactions lack these impulses and are not those of a smooth motion",
    SMOOTH_CURVES,
)
SHAPE_PRESERVING = NoteKind(
    "drive-by-table",
    "{element}: the position by the table '{label}' follows a curve whose accelerations jump at the points, so the effort of "
    "the drive and all reactions are those of this interpolation and may be several times those of a smooth motion",
    SMOOTH_CURVES,
)


def left_tables(system: System, trajectory: Trajectory, settings: RunSettings) -> list[Departure]:
    """Return the departures of a run, those of its steps if the solver searches them for events, or at output times."""
    traits = traits_of(settings)
    recorded = not (traits.fixed_steps or traits.exact)
    of_state = trajectory.departures if recorded else _at_states(system, trajectory.t, trajectory.q, trajectory.u)
    return list(merged([*of_state, *_of_time(system, float(trajectory.t[0]), float(trajectory.t[-1]))]))


def left_by_requests(
    model: ModelData, system: System, rows: OutputRows, channels: Mapping[str, np.ndarray]
) -> list[Departure]:
    """Return the departures from tables of requests at the output times that have values."""
    from ..results.requests import value_over_time

    found: list[Departure] = []
    counted = counters(model, system, rows.q)
    for name, output in model.outputs().items():
        for label, argument in _arguments(output.tree, output.tables):
            x = value_over_time(model, replace(output, tree=argument), rows.t, channels, counted)
            known = np.isfinite(x)
            if known.any():
                found += _departure(name, label, output.tables[label], rows.t[known], x[known])
    return list(merged(found))


def _arguments(tree: ast.expr, tables: Collection[str]) -> Iterator[tuple[str, ast.expr]]:
    """Yield the tables that an expression calls, each with its argument."""
    for node in ast.walk(tree):
        match node:
            case ast.Call(ast.Name(label), [argument]) if label in tables:
                yield label, argument


def stopped_at(first: Departure, trajectory: Trajectory) -> Trajectory:
    """Return a trajectory that ends at a departure, with the reason."""
    return trajectory.stopped_after(int(np.searchsorted(trajectory.t, first.first, side="right")), first.refusal())


def departure_notes(found: list[Departure], model: ModelData) -> Iterator[Note]:
    """Yield a note for each table that was extrapolated, unless the model continues it as intended."""
    unintended = [departure for departure in found if departure.label not in model.continued_tables()]
    return of_users((departure.element, note) for departure in unintended for note in _notes(departure))


def _notes(left: Departure) -> Iterator[Note]:
    """Yield a note on an extrapolation, unless the table keeps the value of its end as intended."""
    if left.table.beyond not in (None, "extend"):
        return
    sides = [side for side in (0, 1) if left.beyond[side] > 0 and not _keeps_value(left.table, side)]
    if not sides:
        return
    side = max(sides, key=lambda each: left.beyond[each])
    reached = left.reached[side]
    values = [value for _, value in left.table.table]
    continued = float(curve(left.table)(np.array([reached]))[0])
    yield (EXTENDED if left.table.beyond else LEFT)(
        left.element, label=left.label, duration=left.duration, first=left.first, reached=reached, end=left.end(side),
        beyond=left.beyond[side], continued=continued, least=min(values), greatest=max(values),
    )  # fmt: skip


def _keeps_value(table: Table, side: int) -> bool:
    """Return True if a table is level at an end: its outer points are equal, or its slope is clamped to zero."""
    points = table.table[:2] if side == 0 else table.table[-2:]
    _, _, before, after = ends_of(spline_data(table))
    slope = before[0] if side == 0 else after[-1]
    return slope == 0.0 and (points[0][1] == points[1][1] or table.ends == "clamped")


def _of_time(system: System, start: float, end: float) -> Iterator[Departure]:
    """Yield the departures from tables whose arguments depend on time alone."""
    given = given_to(system)
    t = _samples(start, end)
    for group in system.groups:
        if not group.has_inputs:
            continue
        for name, element in zip(group.names, group.elements, strict=True):
            for law in _laws(element, given):
                if name in given.tables and INPUT_TABLE in law.tables:
                    continue  # the value of an input, which is noted where it is used
                for called, argument in _arguments(law.tree, law.tables):
                    of_field = law.text.startswith(OF_FIELD)
                    label = law.text.removeprefix(OF_FIELD) if of_field else called.removesuffix("(t)")
                    with np.errstate(all="ignore"):
                        x = law.at(t, argument)
                    yield from _departure(name, label, law.tables[called].table, t, x)


def _laws(element: Element, given: Given) -> Iterator[Input]:
    """Yield the formulas and tables of time of an element."""
    for tree, text, values, tables in expressions_of(element, given):
        yield Input(tree, text, values, {label: TableRanges(table) for label, table in tables.items()})


def _samples(start: float, end: float) -> np.ndarray:
    return np.linspace(start, end, SAMPLES)


def _departure(element: str, label: str, table: Table, t: np.ndarray, x: np.ndarray) -> Iterator[Departure]:
    """Yield the departure from a table by an argument x, which is straight between the times t; if there is one."""
    if table.repeats or not np.isfinite(x).all():
        return
    found = Departure(element, label, table, (float(x.min()), float(x.max())), *_outside(t, x, table))
    if found.matters:
        yield found


def _outside(t: np.ndarray, x: np.ndarray, table: Table) -> tuple[float, float]:
    """Return the time for which an argument is outside a table, and the first such time, s."""
    duration, first = 0.0, np.inf
    for sense, end in ((-1.0, table.table[0][0]), (1.0, table.table[-1][0])):
        over = sense * (x - end)
        first = float(t[0]) if over[0] > 0 else first
        a, b, h = over[:-1], over[1:], np.diff(t)
        with np.errstate(all="ignore"):
            crossing = np.where((a > 0) == (b > 0), 0.0, a / (a - b))
        part = np.where((a > 0) & (b > 0), 1.0, np.where(b > 0, 1.0 - crossing, np.where(a > 0, crossing, 0.0)))
        duration += float(part @ h)
        out = np.flatnonzero(part > 0)
        if len(out):
            k = int(out[0])
            first = min(first, float(t[k] + (0.0 if a[k] > 0 else crossing[k]) * h[k]))
    return duration, first


def may_refuse(system: System) -> bool:
    """Return True if an element has a table with ``beyond: error``."""
    elements = (element for group in system.groups if group.kind.has_tables for element in group.elements)
    return any(table.beyond == "error" for element in elements for _, table in tables_in(element, ""))


def refuse_departure(system: System, t: float, q: np.ndarray, u: np.ndarray) -> None:
    """Raise a SolverError if a state is outside a table with ``beyond: error``; names the table."""
    found = [*_at_states(system, np.array([t]), q[None], u[None]), *_of_time(system, t, t)]
    if first := refused_departure(found):
        raise SolverError(first.refusal())


def _at_states(system: System, times: np.ndarray, q: np.ndarray, u: np.ndarray) -> Iterator[Departure]:
    """Yield the departures that states at given times show."""
    arguments = list(table_arguments(system))
    if all(table is None for *_, table in arguments):
        return
    own = slice(system.n_event_functions, system.n_values("event_function"))
    values = State(system).values_at("event_function", own, times, q, u)
    for (element, label, table), x in zip(arguments, values.T, strict=True):
        if table is not None and np.isfinite(x).all():
            yield from _departure(element, label, table, times, x)


def tabled_drive_notes(system: System, joints: Mapping[str, Joint], breakpoints: np.ndarray) -> Iterator[Note]:
    """Yield a note for each drive whose position is a table without continuous accelerations at some breakpoints, s."""
    given = given_to(system)
    for name, joint in joints.items():
        if isinstance(joint, Drive) and joint.prescribed_position is not None:
            for law in _laws(joint, given):
                for label, ranges in law.tables.items():
                    table, points = ranges.table, _points(ranges.table)
                    arguments = (law.at(breakpoints, part) for _, part in _arguments(law.tree, [label]))
                    if any(_passes(table, points, argument) for argument in arguments):
                        kind = KINKED if table.lines else SHAPE_PRESERVING
                        yield kind(name, label="position" if label == TABLE else label.removesuffix("(t)"))


def _points(table: Table) -> np.ndarray:
    """Return the points at which the second derivative of a table, or its first one, is not continuous."""
    x, y = np.array(table.table).T
    slopes = np.diff(y) / np.diff(x)
    bends = np.abs(np.diff(slopes)) > ROUNDING * np.abs(slopes).max()
    if table.interpolation in ("spline", "smoothing") or not bends.any():
        return np.empty(0)
    at_ends = table.repeats or table.beyond == "hold"
    return x[np.concatenate([[at_ends], bends if table.lines else np.ones(len(bends), dtype=bool), [at_ends]])]


def _passes(table: Table, points: np.ndarray, argument: np.ndarray) -> bool:
    """Return True if the argument is at one of some points of a table."""
    first, last = table.table[0][0], table.table[-1][0]
    if table.repeats:
        argument = first + np.mod(argument - first, last - first)
    if not len(points):
        return False
    after = np.minimum(np.maximum(np.searchsorted(points, argument), 1), len(points) - 1)
    apart = np.minimum(np.abs(argument - points[after]), np.abs(argument - points[after - 1]))
    return bool((apart <= ROUNDING * (last - first)).any())
