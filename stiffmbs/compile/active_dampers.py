"""Dampers whose force adds energy: negative damping, indefinite damping matrices, and tables of the wrong sign."""

from __future__ import annotations

import ast
from collections.abc import Iterator

import numpy as np

from ..elements.forces.springs import AngleSpring, LineSpring
from ..notes import Note, NoteKind, of_users
from ..reading.fields import Described
from ..reading.formula.formula import Formula
from ..reading.table import Table
from .table_values import parts_of

ROUNDING = 1e-9
"""Power or eigenvalue, relative to the largest, that counts as zero."""
SAMPLES = np.linspace(0.0, 1.0, 65)
"""Places within each piece of a table at which its power is evaluated; they include both ends."""
REMEDY = "Reverse its sign, unless the vibrations are meant to grow"
NEGATIVE = NoteKind(
    "negative-damping", "its damping is negative, {damping:g}, so that its force adds energy. {remedy}", REMEDY
)
INDEFINITE = NoteKind(
    "indefinite-damping", "its damping matrix is negative {where}, so that its force adds energy. {remedy}", REMEDY
)
ACTIVE_TABLE = NoteKind(
    "damping-table",
    "the table of its damper_law has the wrong sign between v = {low:.4g} and {high:.4g} {unit}, within its own range of "
    "{first:.4g} to {last:.4g} {unit}, so that its force adds energy there. {remedy}",
    REMEDY,
)


def active_damper_notes(data: Described) -> Iterator[Note]:
    """Yield a note for each damping of a model that adds energy, with the range in which it does."""
    found = [(name, note) for name, force in getattr(data, "forces", {}).items() for note in _notes(force)]
    return of_users(found) if found else iter(())


def _notes(force: Described) -> Iterator[Note]:
    damping = getattr(force, "damping", None)
    table = _table(getattr(force, "damper_law", None))
    if isinstance(force, LineSpring | AngleSpring) and table is not None:
        yield from _of_table(table, damping or 0.0, "m/s" if isinstance(force, LineSpring) else "rad/s")
    elif isinstance(damping, float) and damping < 0:
        yield NEGATIVE(damping=damping)
    elif isinstance(damping, tuple) and all(isinstance(row, tuple) for row in damping):
        yield from _of_matrix(np.array([[part or 0.0 for part in row] for row in damping], dtype=float))


def _table(law: object) -> Table | None:
    """Return a law that is a table of the rate, or a call of one by its name; None for any other law."""
    if isinstance(law, Formula):
        match law.tree:
            case ast.Call(ast.Name(name), [ast.Name("v")]):
                return law.tables.get(name)
    return law if isinstance(law, Table) else None


def _of_matrix(damping: np.ndarray) -> Iterator[Note]:
    """Yield a note on a symmetric damping matrix with a negative eigenvalue, in units in which its diagonal is 1."""
    size = np.sqrt(np.abs(np.diag(damping)))
    size[size == 0] = max(float(np.max(size, initial=0.0)), 1.0)
    lowest = float(np.linalg.eigvalsh(damping / size[:, None] / size)[0])
    if lowest < -ROUNDING:
        negative = np.flatnonzero(np.diag(damping) < 0)
        where = f"in component {', '.join(str(k + 1) for k in negative)}" if negative.size else "in coupled motions"
        yield INDEFINITE(where=where)


def _of_table(table: Table, damping: float, unit: str) -> Iterator[Note]:
    """Yield a note on the rates at which a table, with the linear damping, pushes in the direction of the rate.

    A constant part is no damping: the force at rest is subtracted, if the table has one.
    """
    x, pieces = parts_of(table)
    z = SAMPLES[:, None] * np.diff(x)
    v = x[:-1] + z
    a, b, c, d = pieces.T
    v, force = v.T.ravel(), (((a * z + b) * z + c) * z + d + damping * v).T.ravel()
    at_rest = float(np.interp(0.0, v, force)) if x[0] <= 0 <= x[-1] else 0.0
    power = v * (force - at_rest)
    active = power < -ROUNDING * np.max(np.abs(power), initial=0.0)
    if active.any():
        low, high = float(v[active].min()), float(v[active].max())
        yield ACTIVE_TABLE(low=low, high=high, unit=unit, first=x[0], last=x[-1])
