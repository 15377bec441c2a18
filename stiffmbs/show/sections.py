"""Sections of a report that a user asks for: an equilibrium, natural modes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..compile.bodies import BODY_KINDS
from ..describe.model_data import ModelData
from ..jobs.equilibrium import EquilibriumFound
from ..jobs.modes import Modes
from ..linear_analysis.modes import Mode, Motion

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Sheet

LEAST_SHARE = 0.01
"""Part in the kinetic energy from which on a body is named."""


@dataclass(frozen=True)
class Table:
    """Heads of columns, and rows of cells."""

    heads: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


@dataclass(frozen=True)
class Section:
    """A title, sentences, tables, and figures of matplotlib's."""

    title: str
    sentences: tuple[str, ...]
    tables: tuple[Table, ...] = ()
    figures: tuple[Sheet, ...] = ()


def equilibrium_section(found: EquilibriumFound, model: ModelData) -> Section:
    """Poses of bodies; forces and torques of elements on their first bodies."""
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


def modes_section(found: Modes) -> Section:
    """Frequency, damping and eigenvalues of each mode, and the bodies that take part."""
    count = found.degrees_of_freedom
    head = f"About the state at t = {found.t:g} s: {count} degree{'s' if count != 1 else ''} of freedom."
    heads = ("mode", "Hz", "damping", "eigenvalues, 1/s", "kinetic energy")
    rows = tuple((str(k), *_mode(mode)) for k, mode in enumerate(found.modes, start=1))
    return Section("Natural modes", (head, *found.notes), (Table(heads, rows),) if rows else ())


def _mode(mode: Mode) -> Iterator[str]:
    one, other = mode.eigenvalues
    oscillating = mode.motion is Motion.OSCILLATING
    yield f"{mode.natural_frequency:.6g}"
    yield "rigid body" if mode.motion is Motion.RIGID else f"{mode.damping_ratio:.4g}"
    yield f"{one.real:.6g} ± {abs(one.imag):.6g}i" if oscillating else f"{one.real:.6g}, {other.real:.6g}"
    yield ", ".join(f"{name} {100 * part:.0f} %" for name, part in mode.participation.items() if part >= LEAST_SHARE)
