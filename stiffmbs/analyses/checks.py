"""Checks of runs, in the order in which a solution has their notes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np

from ..compile.active_dampers import active_damper_notes
from ..compile.callbacks import notes_on_functions
from ..compile.system import System
from ..compile.written_values import table_notes
from ..dynamics.dynamics import OutputRows
from ..elements.element import Force
from ..model.scene import notes_of
from ..notes import Note, NoteKind, Severity
from ..redundancy.messages.presolve_report import StructureNotes
from ..results.channels import series_of
from ..results.energy_balance_notes import range_notes, undefined_values
from ..run_checks.growth import motion_within_tolerance, senseless
from ..run_checks.lost_digits import lost_digits_notes
from ..run_checks.motion import motion_notes
from ..solve.settings import settings_notes, traits_of
from ..solve.trajectory import Trajectory
from .job import Job
from .start_forces import start_force_notes

SOLVER = NoteKind("solver", "{text}", severity=Severity.REMARK)


@dataclass(frozen=True)
class Integrated:
    """Job that was integrated, as its checks read it.

    - `structure`: notes on joints and on the presolve.
    - `of_reruns`: notes on reruns of the job, and on omitted rows.
    - `channels`: all channels, if the model has requests or rows are not finite.
    - `broken`: note on the energy balance if it is certainly broken.
    - `again`: rerun up to the last of some times, s, with rows at these.
    """

    job: Job
    system: System
    trajectory: Trajectory
    rows: OutputRows
    structure: StructureNotes
    of_reruns: tuple[Note, ...]
    channels: dict[str, np.ndarray] | None
    broken: tuple[Note, ...]
    again: Callable[[np.ndarray], OutputRows]


class Check(NamedTuple):
    """Check of a run: its `notes`, computed only if `has` is true of the run."""

    name: str
    notes: Callable[[Integrated], Iterable[str]]
    has: Callable[[Integrated], object] = lambda run: True


def notes_on(run: Integrated) -> tuple[Note, ...]:
    """Return the notes of all checks of a run."""
    found: list[str] = []
    for check in CHECKS:
        found += check.notes(run) if check.has(run) else ()
    return tuple(map(Note.of, found))


def flexible_body_notes(system: System, rows: OutputRows) -> Iterator[Note]:
    """Yield the notes on the stiffness and the deformation of flexible bodies."""
    if system.has_coupled_inertia:
        from ..run_checks.geometric_stiffness import geometric_stiffness_notes

        yield from geometric_stiffness_notes(system, rows)


def _drives(job: Job) -> Iterator[Note]:
    """Yield notes on actuators that act on prescribed motions, and on drives by tables if the run passes their points."""
    if not any(joint.kind == "drive" for joint in job.data.joints.values()):
        return
    from ..redundancy.opposed_actuators import opposed_notes  # not for models without drives
    from ..run_checks.tables import tabled_drive_notes

    system, grid = job.dynamics.system, job.grid
    yield from job.dynamics.once(lambda _: opposed_notes(system, job.data, job.start.q, grid), name="opposed actuators")
    yield from tabled_drive_notes(
        system, job.data.joints, job.dynamics.input_features(grid.start, grid.end).breakpoints
    )


def _start_forces(run: Integrated) -> Iterator[Note]:
    job = run.job
    before = job.start_from.elements if job.start_from else None
    if job.start_from is None or before is not None:
        yield from start_force_notes(job.data, job.dynamics, job.start, job.grid.start, run.rows, before)


def _tolerance(run: Integrated) -> Iterator[Note]:
    settings = run.job.settings
    if run.system.size == 1.0 and settings.atol is None and "rtol" in traits_of(settings).reads:
        yield from motion_within_tolerance(run.system, settings, run.trajectory)


def _ranges(run: Integrated) -> Iterator[Note]:
    data = run.job.data
    limited = {name: x for name, x in data.forces.items() if type(x).valid_ranges is not Force.valid_ranges}
    if ranges := {name: found for name, force in limited.items() if (found := force.valid_ranges())}:
        yield from range_notes(ranges, partial(series_of, data, run.system, run.rows), run.rows.t)


def _left_tables(run: Integrated) -> Iterator[Note]:
    from ..run_checks.tables import departure_notes, left_tables

    return departure_notes(left_tables(run.system, run.trajectory, run.job.settings), run.job.data)


def _tables_left_by_requests(run: Integrated) -> Iterator[Note]:
    from ..run_checks.tables import departure_notes, left_by_requests

    found = left_by_requests(run.job.data, run.system, run.rows, run.channels or {})
    return departure_notes(found, run.job.data)


CHECKS = (
    Check("parts", lambda run: notes_of(run.job.data)),
    Check("tables", lambda run: table_notes(run.job.data), lambda run: run.system.has_laws),
    Check("active dampers", lambda run: active_damper_notes(run.job.data)),
    Check("joints", lambda run: run.structure.of_joints),
    Check("drives", lambda run: _drives(run.job)),
    Check("start", lambda run: run.job.start.notes),
    Check("functions", lambda run: notes_on_functions(run.system), lambda run: run.system.has_functions),
    Check("assembly", lambda run: (run.job.start.sentence(),), lambda run: run.job.start.moved),
    Check("forces at the start", _start_forces),
    Check("solver", lambda run: (SOLVER(text=run.trajectory.note),), lambda run: run.trajectory.note),
    Check("tolerance", _tolerance),
    Check("settings", lambda run: settings_notes(run.job.settings, run.system)),
    Check("reruns", lambda run: run.of_reruns),
    Check("ranges", _ranges),
    Check("left tables", _left_tables, lambda run: run.system.has_tables),
    Check("tables left by requests", _tables_left_by_requests, lambda run: run.job.data.requests),
    Check("flexible bodies", lambda run: flexible_body_notes(run.system, run.rows)),
    Check("impossible results", lambda run: senseless(run.job.dynamics, run.rows, run.job.on_constraints, run.broken)),
    Check("motion", lambda run: motion_notes(run.job.dynamics, run.rows, run.job.settings.rtol, run.again)),
    Check("lost digits", lambda run: lost_digits_notes(run.job.dynamics, run.rows), lambda run: run.trajectory.statistics.get("jacobians")),
    Check("undefined values", lambda run: undefined_values(run.rows, run.channels or {}), lambda run: run.channels),
)  # fmt: skip
"""All checks of a run."""
