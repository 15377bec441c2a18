"""Elements that wrote given values of a term set."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from ..notes import Note, NoteKind, of_users
from ..reading.fields import Described
from ..reading.formula.formula import Formula
from ..reading.table import Table
from .group import Group
from .law_intervals import TABLES
from .system import System
from .table_values import parts_of, spline_data
from .terms import TERM_SETS


def writer(system: System, term_set: str, at: int) -> str:
    """Return the name of the element that writes the value with a given index."""
    group, element = _writer(system, term_set, at)
    return group.names[element]


def beyond(system: System, limit: int) -> str:
    """Return the message for a violated limit, given its index among the values of the set ``event_function``."""
    group, element = _writer(system, "event_function", limit)
    return f"'{group.names[element]}': {group.kind.element.beyond}"  # type: ignore[attr-defined]


def _writer(system: System, term_set: str, at: int) -> tuple[Group, int]:
    for g, group in enumerate(system.groups):
        for k, term in enumerate(TERM_SETS[term_set]):
            width = group.entries[term]
            first = int(system.places[term_set][g, 1 + k])
            if first <= at < first + group.count * width:
                return group, (at - first) // width
    raise IndexError(f"the set {term_set} has no value {at}")


def values_of(system: System, values: np.ndarray, term_set: str, element: str) -> dict[str, np.ndarray]:
    """Return the values that one element wrote for each term of a set."""
    found = {}
    for g, group in enumerate(system.groups):
        if element in group.names:
            e = group.names.index(element)
            for k, term in enumerate(TERM_SETS[term_set]):
                width = group.entries[term]
                first = system.places[term_set][g, 1 + k] + e * width
                found[term] = values[first : first + width]
    return found


def table_arguments(system: System) -> Iterator[tuple[str, str, Table | None]]:
    """Yield the element, and the label and table of each argument of a law; None if it is no table of the element's own.

    The order is that of the values of the set ``event_function`` after the event functions.
    """
    for group in system.groups:
        own = group.index[:, 2 * group.kind.n_bodies] if group.record.laws else ()
        for name, element, start in zip(group.names, group.elements, own, strict=False):
            tables = {spline_data(table).tobytes(): (label, table) for label, table in tables_in(element, "")}
            for law, number in group.record.laws:
                found: tuple[str, Table | None] = "", None
                if law in TABLES:
                    at = int(start + group.numbers[start + number])
                    count = int(group.numbers[at])
                    found = tables.get(group.numbers[at : at + 2 + count + 4 * (count - 1)].tobytes(), found)
                yield name, *found


BEYOND = 0.1
"""Overshoot, relative to the range of a table's values, that is not reported."""
SECTIONS = "joints", "forces", "states"
CURVES = {"akima": "Akima's cubics", "spline": "a cubic spline"}
"""Interpolations that may overshoot."""
OVERSHOOTS = NoteKind(
    "table-overshoots",
    "the table '{label}' is {curve} that reaches {value:.4g} at {at:.4g}, but its points are between {low:.4g} and "
    "{high:.4g}; {remedy}",
    "the default interpolation and 'lines: true' stay within this range",
)


def table_notes(data: Described) -> Iterator[Note]:
    """Yield a note for each table of a model whose interpolation overshoots its points."""
    return of_users(
        (name, note)
        for section in SECTIONS
        for name, element in getattr(data, section, {}).items()
        for label, table in tables_in(element, "")
        for note in _beyond(label, table)
    )


def tables_in(value: object, label: str) -> Iterator[tuple[str, Table]]:
    """Yield the tables in a field, with their names in the scene or the name of the field."""
    match value:
        case Table():
            yield label, value
        case Formula():
            yield from value.tables.items()
        case Described():
            for name, field in type(value).model_fields.items():
                yield from tables_in(getattr(value, name), field.alias or name)
        case Mapping():
            for name, part in value.items():
                yield from tables_in(part, name)
        case tuple():
            for part in value:
                yield from tables_in(part, label)


def _beyond(label: str, table: Table) -> Iterator[Note]:
    """Yield a note on the overshoot of a table."""
    if table.interpolation not in CURVES:
        return
    at, values = _extrema(table)
    y = np.array(table.table)[:, 1]
    low, high = float(y.min()), float(y.max())
    over = np.maximum(values - high, low - values)
    k = int(np.argmax(over))
    if over[k] > BEYOND * (high - low):
        curve = CURVES[table.interpolation]
        yield OVERSHOOTS(label=label, curve=curve, value=values[k], at=at[k], low=low, high=high)


def _extrema(table: Table) -> tuple[np.ndarray, np.ndarray]:
    """Return the arguments inside the pieces at which the slope is zero, and the values there."""
    x, pieces = parts_of(table)
    a, b, c, d = pieces.T[:, None]
    with np.errstate(all="ignore"):
        half = -(b + np.copysign(np.sqrt(b * b - 3 * a * c), b))
        z = np.concatenate([half / (3 * a), c / half])
    z = np.where((z > 0) & (z < np.diff(x)), z, 0.0)
    return (x[:-1] + z).ravel(), (((a * z + b) * z + c) * z + d).ravel()
