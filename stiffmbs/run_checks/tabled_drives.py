"""Drives whose positions follow tables: the derivatives of an interpolation that is not smooth decide their efforts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from ..compile.inputs.of_time import given_to
from ..compile.system import System
from ..elements.element import Joint
from ..elements.joints.drive import Drive
from ..notes import Note, NoteKind
from ..reading.formula.formula import Formula
from ..reading.table import Table

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


def tabled_drive_notes(system: System, joints: Mapping[str, Joint]) -> Iterator[Note]:
    """Yield a note for each drive whose position is a table without continuous accelerations."""
    of_inputs = given_to(system).tables
    for name, joint in joints.items():
        if isinstance(joint, Drive):
            for label, table in _tables(joint.prescribed_position, of_inputs):
                if kind := _not_smooth(table):
                    yield kind(name, label=label)


def _tables(law: object, of_inputs: Mapping[str, Table]) -> Iterator[tuple[str, Table]]:
    """Yield the tables in a law of time, with their names, the name of the field or that of the input."""
    match law:
        case Table():
            yield "position", law
        case Formula():
            yield from law.tables.items()
            yield from ((name, of_inputs[name]) for name in law.states if name in of_inputs)


def _not_smooth(table: Table) -> NoteKind | None:
    """Return how the accelerations of a table of positions are not continuous; None if they are, or it is straight."""
    if table.interpolation in ("spline", "smoothing"):
        return None
    x, y = np.array(table.table).T
    slopes = np.diff(y) / np.diff(x)
    if np.ptp(slopes) <= 1e-9 * np.abs(slopes).max():
        return None
    return KINKED if table.lines else SHAPE_PRESERVING
