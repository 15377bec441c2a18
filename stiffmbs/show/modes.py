"""Equilibria and frequency responses as text and numbers; equilibria as a section of a report."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator

import numpy as np

from ..analyses.equilibrium import EquilibriumFound
from ..compile.bodies import BODY_KINDS
from ..linear_analysis.transfer import Transfer
from ..model.model_data import ModelData
from ..notes import note_lines
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
    return "\n".join([*lines, *note_lines(found.notes)])


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


def response_text(scene: str, found: Transfer, frequencies: np.ndarray, values: np.ndarray) -> str:
    """Return the gain and phase of each input and output at both ends, and at the peaks, as text.

    `frequencies` of shape (n,): frequencies, Hz. `values` of shape (n, outputs, inputs).
    """
    lines = [f"{scene}: gain and phase from {frequencies[0]:g} Hz to {frequencies[-1]:g} Hz"]
    for i, name in enumerate(found.inputs):
        for o, output in enumerate(found.outputs):
            lines.append(f"{name} -> {output}")
            gain, phase = np.abs(values[:, o, i]), np.degrees(np.angle(values[:, o, i]))
            inner = np.flatnonzero((gain[1:-1] > gain[:-2]) & (gain[1:-1] > gain[2:])) + 1
            for k in (0, *inner.tolist(), len(gain) - 1):
                mark = "peak" if k in inner else ""
                lines.append(f"  {frequencies[k]:>10.5g} Hz  {gain[k]:>12.5g}  {phase[k]:>8.2f} deg  {mark}".rstrip())
    return "\n".join([*lines, *note_lines(found.notes)])


def response_as_json(scene: str, found: Transfer, frequencies: np.ndarray, values: np.ndarray) -> str:
    """Return frequencies, and real and imaginary part by input and output, as JSON, and notes if any; arguments as of `response_text`."""
    parts = {
        name: {
            output: [[value.real, value.imag] for value in values[:, o, i].tolist()]
            for o, output in enumerate(found.outputs)
        }
        for i, name in enumerate(found.inputs)
    }
    notes = {"notes": list(found.notes)} if found.notes else {}
    return json.dumps({"scene": scene, "frequencies": frequencies.tolist(), "response": parts, **notes})


def response_csv(found: Transfer, frequencies: np.ndarray, values: np.ndarray) -> str:
    """Return columns of gain and phase as CSV; arguments as of `response_text`."""
    pairs = [(i, o) for i in range(len(found.inputs)) for o in range(len(found.outputs))]
    names = [f"{found.inputs[i]} -> {found.outputs[o]} {part}" for i, o in pairs for part in ("gain", "phase [deg]")]
    columns = [
        part for i, o in pairs for part in (np.abs(values[:, o, i]), np.degrees(np.unwrap(np.angle(values[:, o, i]))))
    ]
    rows = [",".join(["frequency [Hz]", *names])]
    rows += [",".join(f"{number:.15g}" for number in row) for row in np.column_stack([frequencies, *columns])]
    return "\n".join(rows) + "\n"
