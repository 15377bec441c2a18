"""Dampers whose force adds energy: negative damping, indefinite damping matrices, and laws of the wrong sign."""

from __future__ import annotations

import ast
from collections.abc import Iterator

import numpy as np

from ..elements.forces.springs import AngleSpring, LineSpring
from ..notes import Note, NoteKind, of_users
from ..reading.fields import Described
from ..reading.formula.formula import Formula
from ..reading.formula.functions import FUNCTIONS
from ..reading.formula.text import evaluate
from ..reading.table import Table
from .table_values import curve, parts_of

RATE = "v"
"""Name of the rate in a law."""
ROUNDING = 1e-9
"""Power or eigenvalue, relative to the largest, that counts as zero."""
SAMPLES = np.linspace(0.0, 1.0, 65)
"""Places within each piece of a table at which its power is evaluated; they include both ends."""
RATES = np.geomspace(1e-6, 1e3, 91)
"""Rates at which a formula is evaluated, m/s or rad/s; the first ones at which it acts decide, as its range is unknown."""
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
ACTIVE_FORMULA = NoteKind(
    "damping-formula",
    "its damper_law '{text}' has the wrong sign at {rates} rates, from v = {least:.2g} {unit} on, so that its force adds "
    "energy. {remedy}",
    REMEDY,
)


def active_damper_notes(data: Described) -> Iterator[Note]:
    """Yield a note for each damping of a model that adds energy, with the range in which it does."""
    found = [(name, note) for name, force in getattr(data, "forces", {}).items() for note in _notes(force)]
    return of_users(found) if found else iter(())


def _notes(force: Described) -> Iterator[Note]:
    damping = getattr(force, "damping", None)
    law = getattr(force, "damper_law", None)
    table, unit = _table(law), "m/s" if isinstance(force, LineSpring) else "rad/s"
    if isinstance(force, LineSpring | AngleSpring) and table is not None:
        yield from _of_table(table, damping or 0.0, unit)
    elif isinstance(law, Formula) and {*law.variables, *law.states} <= {RATE}:
        yield from _of_formula(law, damping or 0.0, unit)
    elif isinstance(damping, float) and damping < 0:
        yield NEGATIVE(damping=damping)
    elif isinstance(damping, tuple) and all(isinstance(row, tuple) for row in damping):
        yield from _of_matrix(np.array([[part or 0.0 for part in row] for row in damping], dtype=float))


def _table(law: object) -> Table | None:
    """Return a law that is a table of the rate, or a call of one by its name; None for any other law."""
    if isinstance(law, Formula):
        match law.tree:
            case ast.Call(ast.Name(name), [ast.Name(argument)]) if argument == RATE:
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


def _of_formula(law: Formula, damping: float, unit: str) -> Iterator[Note]:
    """Yield a note on a law that, with the linear damping, pushes in the direction of the first rates.

    As for tables, the force at rest is subtracted. Rates at which the law has no force or no value are passed over.
    """
    v = np.concatenate([-RATES[::-1], [0.0], RATES])
    names, functions = {**law.values, RATE: v}, {name: function.array for name, function in FUNCTIONS.items()}
    functions |= {name: curve(table) for name, table in law.tables.items()}
    with np.errstate(all="ignore"):
        force = evaluate(law.tree, names.__getitem__, functions, np.float64) + damping * v
    at_rest = force[len(RATES)]
    acts = np.abs(force - at_rest) > ROUNDING * np.maximum(np.abs(force), np.abs(at_rest))
    active = {}
    for rates, sense in (("negative", -1.0), ("positive", 1.0)):
        first = next((k for k in np.flatnonzero(sense * v > 0)[:: int(sense)] if acts[k]), None)
        if first is not None and v[first] * (force[first] - at_rest) < 0:
            active[rates] = abs(float(v[first]))
    if active:
        yield ACTIVE_FORMULA(text=law.text, rates=" and ".join(active), least=min(active.values()), unit=unit)
