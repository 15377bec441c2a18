"""Optional sections of a report."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..analyses.equilibrium import EquilibriumFound
from ..compile.bodies import BODY_KINDS
from ..describe.model_data import ModelData

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Sheet


@dataclass(frozen=True)
class Table:
    """Table: heads of columns, and rows of cells."""

    heads: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


@dataclass(frozen=True)
class Section:
    """Section: a title, sentences, tables, and figures of matplotlib."""

    title: str
    sentences: tuple[str, ...]
    tables: tuple[Table, ...] = ()
    figures: tuple[Sheet, ...] = ()


def equilibrium_section(found: EquilibriumFound, model: ModelData) -> Section:
    """Return a section with the poses of bodies, and forces and torques of elements on their first bodies."""
    kind = BODY_KINDS[model.dimensions]
    head = f"At t = {found.t:g} s, with an imbalance of {found.imbalance:.1e} of the largest force."
    tables = (
        _channels("body (m, rad)", model.bodies, kind.positions, found),
        _channels("force, torque (N, N m)", {**model.joints, **model.forces}, kind.reactions, found),
    )
    return Section("Static equilibrium", (head, *found.notes), tuple(table for table in tables if table.rows))


def _channels(title: str, names: Iterable[str], labels: tuple[str, ...], found: EquilibriumFound) -> Table:
    rows = []
    for name in names:
        values = [found.channels.get(f"{name}.{label}") for label in labels]
        rows += [] if None in values else [(name, *(f"{value:.8g}" for value in values))]
    return Table((title, *labels), tuple(rows))
