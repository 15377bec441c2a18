"""Checks of runs: what each needs and reads, in the order in which a solution has their notes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import partial
from itertools import repeat
from operator import attrgetter, call

import numpy as np

from ..compile.active_dampers import active_damper_notes
from ..compile.callbacks import notes_on_functions
from ..compile.system import System
from ..compile.written_values import table_notes
from ..dynamics.dynamics import OutputRows
from ..dynamics.initial import InitialValues
from ..elements.element import Force
from ..model.scene import notes_of
from ..notes import Note, NoteKind, Severity
from ..redundancy.messages.presolve_report import StructureNotes
from ..results.channels import series_of
from ..results.energy_balance_notes import range_notes, undefined_values
from ..run_checks.growth import motion_within_tolerance, senseless
from ..run_checks.left_tables import departure_notes, left_by_requests, left_tables
from ..run_checks.motion import motion_notes
from ..run_checks.uncertain_forces import uncertain_forces
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


@dataclass(frozen=True)
class Check:
    """Check of a run.

    - `notes`: function that yields the notes.
    - `reads`: attributes of `Integrated` that are its arguments.
    - `needs`: attribute that is false for runs without what it checks; empty if every run has it.
    """

    name: str
    notes: Callable[..., Iterable[str]]
    reads: tuple[str, ...]
    needs: str = ""


def notes_on(run: Integrated) -> tuple[Note, ...]:
    """Return the notes of all checks of a run."""
    found: list[str] = []
    for check in CHECKS:
        if not check.needs or attrgetter(check.needs)(run):
            found += check.notes(*map(call, map(attrgetter, check.reads), repeat(run)))
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
    from ..redundancy.opposed_actuators import opposed_notes  # models without drives load neither
    from ..run_checks.tabled_drives import tabled_drive_notes

    system, grid = job.dynamics.system, job.grid
    opposed = partial(opposed_notes, system, job.data, job.start.q, grid)
    yield from job.dynamics.kept("opposed actuators", None, opposed)
    yield from tabled_drive_notes(
        system, job.data.joints, job.dynamics.input_features(grid.start, grid.end).breakpoints
    )


def _assembly(start: InitialValues) -> tuple[str]:
    return (start.sentence(),)


def _start_forces(job: Job, rows: OutputRows) -> Iterator[Note]:
    before = job.start_from.elements if job.start_from else None
    if job.start_from is None or before is not None:
        yield from start_force_notes(job.data, job.dynamics, job.start, job.grid.start, rows, before)


def _solver(note: str) -> Iterator[Note]:
    yield SOLVER(text=note)


def _tolerance(job: Job, system: System, trajectory: Trajectory) -> Iterator[Note]:
    if system.size == 1.0 and job.settings.atol is None and "rtol" in traits_of(job.settings).reads:
        yield from motion_within_tolerance(system, job.settings, trajectory)


def _ranges(job: Job, system: System, rows: OutputRows) -> Iterator[Note]:
    limited = {name: x for name, x in job.data.forces.items() if type(x).valid_ranges is not Force.valid_ranges}
    if ranges := {name: found for name, force in limited.items() if (found := force.valid_ranges())}:
        yield from range_notes(ranges, partial(series_of, job.data, system, rows), rows.t)


def _left_tables(job: Job, system: System, trajectory: Trajectory) -> Iterator[Note]:
    yield from departure_notes(left_tables(system, trajectory, job.settings))


def _left_by_requests(job: Job, system: System, rows: OutputRows, channels: dict[str, np.ndarray]) -> Iterator[Note]:
    yield from departure_notes(left_by_requests(job.data, system, rows, channels))


CHECKS = (
    Check("parts", notes_of, ("job.data",)),
    Check("tables", table_notes, ("job.data",), "system.has_laws"),
    Check("active dampers", active_damper_notes, ("job.data",)),
    Check("joints", tuple, ("structure.of_joints",)),
    Check("drives", _drives, ("job",)),
    Check("start", tuple, ("job.start.notes",)),
    Check("functions", notes_on_functions, ("system",), "system.has_functions"),
    Check("assembly", _assembly, ("job.start",), "job.start.moved"),
    Check("forces at the start", _start_forces, ("job", "rows")),
    Check("solver", _solver, ("trajectory.note",), "trajectory.note"),
    Check("tolerance", _tolerance, ("job", "system", "trajectory")),
    Check("settings", settings_notes, ("job.settings", "system")),
    Check("reruns", tuple, ("of_reruns",)),
    Check("ranges", _ranges, ("job", "system", "rows")),
    Check("left tables", _left_tables, ("job", "system", "trajectory"), "system.has_tables"),
    Check("tables left by requests", _left_by_requests, ("job", "system", "rows", "channels"), "job.data.requests"),
    Check("flexible bodies", flexible_body_notes, ("system", "rows"), "system.has_coupled_inertia"),
    Check("impossible results", senseless, ("job.dynamics", "rows", "job.on_constraints", "broken")),
    Check("motion", motion_notes, ("job.dynamics", "rows", "job.settings.rtol", "again")),
    Check("uncertain forces", uncertain_forces, ("job.dynamics", "trajectory", "rows")),
    Check("undefined values", undefined_values, ("rows", "channels"), "channels"),
)
"""All checks of a run."""
