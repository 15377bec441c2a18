"""Notes on tables whose interpolation overshoots their points."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from ..reading.fields import Described
from ..reading.formula.formula import Formula
from ..reading.table import Table
from .table_values import parts_of

BEYOND = 0.1
"""Overshoot, relative to the range of a table's values, that is not reported."""
SECTIONS = "joints", "forces", "states"
CURVES = {"akima": "Akima's cubics", "spline": "a cubic spline"}
"""Interpolations that may overshoot."""


def table_notes(data: Described) -> Iterator[str]:
    """Yield a note for each table of a model whose interpolation overshoots its points."""
    users: dict[str, list[str]] = {}
    for section in SECTIONS:
        for name, element in getattr(data, section, {}).items():
            for label, table in _tables(element, ""):
                if note := _beyond(table):
                    users.setdefault(f"the table '{label}' {note}", []).append(name)
    for note, names in users.items():
        yield f"{', '.join(dict.fromkeys(names))}: {note}"


def _tables(value: Any, label: str) -> Iterator[tuple[str, Table]]:
    """Yield the tables in a field, with their names in the scene or the name of the field."""
    match value:
        case Table():
            yield label, value
        case Formula():
            yield from value.tables.items()
        case Described():
            for name in type(value).model_fields:
                yield from _tables(getattr(value, name), name)
        case Mapping():
            for name, part in value.items():
                yield from _tables(part, name)
        case tuple():
            for part in value:
                yield from _tables(part, label)


def _beyond(table: Table) -> str:
    """Return a sentence on the overshoot of a table, or an empty string."""
    if table.interpolation not in CURVES:
        return ""
    at, values = _extrema(table)
    y = np.array(table.table)[:, 1]
    low, high = float(y.min()), float(y.max())
    over = np.maximum(values - high, low - values)
    k = int(np.argmax(over))
    if not over[k] > BEYOND * (high - low):
        return ""
    return (
        f"is {CURVES[table.interpolation]} that reaches {values[k]:.4g} at {at[k]:.4g}, but its points are between {low:.4g} and "
        f"{high:.4g}; the default interpolation and 'lines: true' stay within this range"
    )


def _extrema(table: Table) -> tuple[np.ndarray, np.ndarray]:
    """Return the arguments inside the pieces at which the slope is zero, and the values there."""
    x, pieces = parts_of(table)
    a, b, c, d = pieces.T[:, None]
    with np.errstate(all="ignore"):
        half = -(b + np.copysign(np.sqrt(b * b - 3 * a * c), b))
        z = np.concatenate([half / (3 * a), c / half])
    z = np.where((z > 0) & (z < np.diff(x)), z, 0.0)
    return (x[:-1] + z).ravel(), (((a * z + b) * z + c) * z + d).ravel()
