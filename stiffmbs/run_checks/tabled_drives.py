"""Drives whose positions follow tables: the derivatives of an interpolation that is not smooth decide their efforts."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping

import numpy as np

from ..compile.inputs.of_time import TABLE, Input, expressions_of, given_to
from ..compile.inputs.table_ranges import TableRanges
from ..compile.system import System
from ..elements.element import Joint
from ..elements.joints.drive import Drive
from ..notes import Note, NoteKind
from ..reading.table import Table
from ..solve.events.departures import ROUNDING

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


def tabled_drive_notes(system: System, joints: Mapping[str, Joint], breakpoints: np.ndarray) -> Iterator[Note]:
    """Yield a note for each drive whose position is a table without continuous accelerations at some breakpoints, s."""
    given = given_to(system)
    for name, joint in joints.items():
        if isinstance(joint, Drive) and joint.prescribed_position is not None:
            for tree, text, values, tables in expressions_of(joint, given):
                law = Input(tree, text, values, {label: TableRanges(table) for label, table in tables.items()})
                for label, table in tables.items():
                    points = _points(table)
                    if any(_passes(table, points, law.at(breakpoints, part)) for part in _arguments(tree, label)):
                        kind = KINKED if table.lines else SHAPE_PRESERVING
                        yield kind(name, label="position" if label == TABLE else label.removesuffix("(t)"))


def _arguments(tree: ast.expr, table: str) -> Iterator[ast.expr]:
    """Yield the arguments with which an expression calls a table."""
    for node in ast.walk(tree):
        match node:
            case ast.Call(ast.Name(name), [argument]) if name == table:
                yield argument


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
