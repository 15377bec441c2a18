"""Equilibria as text, and as a section of a report."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from ..analyses.equilibrium import EquilibriumFound
from ..compile.bodies import BODY_KINDS
from ..model.model_data import ModelData
from .sections import Section, Table

ACTIONS = "force, torque (N, N m)"


def equilibrium_text(found: EquilibriumFound, model: ModelData) -> str:
    """Return a table of the poses of bodies, the force and torque of each element on its first body, and states."""
    head = f"{found.name or 'model'}: equilibrium at t = {found.t:g} s after {found.moves} moves, imbalance {found.imbalance:.1e}"
    lines = [head]
    for title, names, labels in _tables("pose (m, rad)", model):
        width = max((len(name) for name in names), default=0)
        lines.append(f"{title}: {', '.join(labels)}")
        for name, values in _rows(found, names, labels):
            lines.append(f"  {name:<{width}}  " + "  ".join(f"{value:>14.8g}" for value in values))
    states = {**model.state_values(), **model.state_outputs()}
    if states:
        width = max(map(len, states))
        lines += ["states:", *(f"  {name:<{width}}  {found.channels[name]:>14.8g}" for name in states)]
    return "\n".join([*lines, *(f"note: {note}" for note in found.notes)])


def equilibrium_section(found: EquilibriumFound, model: ModelData) -> Section:
    """Return a section with the poses of bodies, and forces and torques of elements on their first bodies."""
    head = f"At t = {found.t:g} s, with an imbalance of {found.imbalance:.1e} of the largest force."
    tables = [
        Table((title, *labels), tuple((name, *(f"{value:.8g}" for value in values)) for name, values in rows))
        for title, names, labels in _tables("body (m, rad)", model)
        if (rows := list(_rows(found, names, labels)))
    ]
    return Section("Static equilibrium", (head, *found.notes), tuple(tables))


def _tables(poses: str, model: ModelData) -> Iterator[tuple[str, Iterable[str], tuple[str, ...]]]:
    """Yield title, names of rows, and labels of columns of each table."""
    kind = BODY_KINDS[model.dimensions]
    yield poses, model.bodies, kind.positions
    yield ACTIONS, {**model.joints, **model.forces}, kind.reactions


def _rows(found: EquilibriumFound, names: Iterable[str], labels: tuple[str, ...]) -> Iterator[tuple[str, list[float]]]:
    for name in names:
        values = [found.channels[f"{name}.{label}"] for label in labels if f"{name}.{label}" in found.channels]
        if len(values) == len(labels):
            yield name, values
