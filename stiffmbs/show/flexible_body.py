"""Report on a reduced flexible body as text and as JSON, and its mode shapes for ParaView."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..flexible_bodies.finite_elements import FiniteElements
from ..flexible_bodies.reduction import ReducedBody
from ..notes import note_lines

if TYPE_CHECKING:
    from ..results.flexible_motion import FlexibleMotion

MOST_FREQUENCIES = 12
"""Number of modes that are shown, the slowest first."""
UNREPRESENTED = 0.01
"""Share of the strain energy, without a unit, above which a note says that loads are not represented: stresses are 10 % low."""
LARGE_CONDITION = 1e12
"""Condition number above which a note advises fewer modes."""


def flexible_body_text(name: str, body: ReducedBody, interfaces: Sequence[str], held: Mapping[str, np.ndarray]) -> str:
    """Return the report as text.

    `name` is that of the file, and `interfaces` are names; `held` has the natural frequencies, Hz, with some interfaces held.
    """
    nodes, elastic = body.nodes, len(body.frequencies)
    interface_modes = int(body.sizes.sum())
    lines = [
        f"{name}: {nodes} nodes, reduced to {elastic} elastic modes",
        _line("modes", f"{interface_modes} of interfaces, {len(body.fixed_frequencies)} normal modes with all interfaces held"),
        _line("mass", f"{body.mass:.6g} kg"),
        _line("centre", f"{_numbers(body.centre)} m"),
        _line("inertia", f"{_numbers(body.inertia[np.triu_indices(3)])} kg m^2 (xx xy xz yy yz zz, about the centre)"),
        *(_line("interface", f"{own}: {'point' if size == 3 else 'point and rotation'} at {_numbers(point)} m")
          for own, size, point in zip(interfaces, body.sizes, body.points, strict=True)),
        _line("rigid", f"six frequencies of {body.rigid_frequencies.max():.1e} Hz or less"),
        _line("free", f"{_listed(body.frequencies)} Hz"),
        *(_line("held", f"{_listed(found)} Hz ({which})") for which, found in held.items()),
        _line("fixed", f"{_listed(body.fixed_frequencies)} Hz (all interfaces held)"),
        _line("effective", f"{', '.join(f'{100 * part:.1f} %' for part in body.effective_mass.sum(axis=0))} of the mass along x, y, z "
              "in the normal modes"),
        _line("condition", f"{body.condition:.2g} of the mass matrix of all modes"),
        *note_lines(_notes(body)),
    ]  # fmt: skip
    return "\n".join(lines)


def _notes(body: ReducedBody) -> list[str]:
    notes = list(body.notes)
    if body.dependent:
        notes.append(f"{body.dependent} of the modes are linear combinations of the others and left out")
    if body.condition > LARGE_CONDITION:
        notes.append(f"the condition number of the modes is {body.condition:.1e}; use fewer modes")
    return notes


def flexible_body_as_dict(
    name: str, body: ReducedBody, interfaces: Sequence[str], held: Mapping[str, np.ndarray]
) -> dict[str, object]:
    """Return the report for JSON; parameters as `flexible_body_text`."""
    return {
        "body": name,
        "nodes": body.nodes,
        "mass": body.mass,
        "center_of_mass": body.centre.tolist(),
        "inertia": body.inertia.tolist(),
        "interfaces": {own: point.tolist() for own, point in zip(interfaces, body.points, strict=True)},
        "rigid_frequencies": body.rigid_frequencies.tolist(),
        "free_frequencies": body.frequencies.tolist(),
        "held_frequencies": {which: found.tolist() for which, found in held.items()},
        "fixed_frequencies": body.fixed_frequencies.tolist(),
        "effective_mass": body.effective_mass.tolist(),
        "condition": body.condition,
        "messages": _notes(body),
    }


def _line(label: str, text: str) -> str:
    return f"{label:12}{text}"


def _numbers(values: np.ndarray) -> str:
    return " ".join(f"{value:.6g}" for value in np.where(np.abs(values) < 1e-12 * np.abs(values).max(), 0.0, values))


def _listed(values: np.ndarray) -> str:
    more = len(values) - MOST_FREQUENCIES
    shown = " ".join(f"{value:.7g}" for value in values[:MOST_FREQUENCIES])
    return f"{shown}{f' and {more} more' if more > 0 else ''}" if len(values) else "none"


def flexible_motion_as_dict(scene: str, motion: FlexibleMotion, nodes: Sequence[int]) -> dict[str, Any]:
    """Return the stresses, strain energy and displacements of a flexible body in a run, for JSON.

    `scene`: name of the file. `nodes`: nodes whose displacements are reported.
    """
    energy = motion.strain_energy()
    peaks = motion.peaks() if motion.model.has_stresses else {}
    found: dict[str, Any] = {
        "scene": scene,
        "body": motion.name,
        "stress": {
            name: {"value": peak.value, "node": peak.node, "point": list(peak.point), "time": peak.time}
            | ({} if (bar := motion.error_of_stress(peak)) is None else {"error": bar})
            for name, peak in peaks.items()
        },
        "strain_energy": {"largest": float(energy.sum(axis=1).max()), "by_mode": energy.max(axis=0).tolist()},
        "frequencies": motion.reduced.frequencies.tolist(),
        "displacement": {},
        "notes": _notes_on_motion(motion),
    }
    for node, own in zip(nodes, motion.displacement(nodes).transpose(1, 0, 2), strict=True):
        size = np.linalg.norm(own, axis=1)
        row = int(size.argmax())
        found["displacement"][str(node)] = {
            "largest": float(size[row]), "time": float(motion.t[row]), "last": own[-1].tolist(),
        }  # fmt: skip
    return found


def _notes_on_motion(motion: FlexibleMotion) -> list[str]:
    """Return a note if loads by the body's own inertia and weight deform it in shapes that its modes do not contain."""
    share, t = motion.unrepresented()
    if share <= UNREPRESENTED:
        return []
    return [
        f"stresses by inertia and weight of '{motion.name}' are incomplete: {100 * share:.2g} % of its strain energy at t = {t:.4g} s is that of shapes "
        "which its modes do not contain; add residual_modes: true (weight, acceleration), or more modes (rotation)"
    ]


def flexible_motion_text(report: Mapping[str, Any]) -> str:
    """Return the report of `flexible_motion_as_dict` as text."""
    lines = [f"{report['body']} in {report['scene']}"]
    for name, peak in report["stress"].items():
        bar = f" +- {peak['error'] / 1e6:.2g}" if "error" in peak else ""
        point = _numbers(np.array(peak["point"]))
        lines.append(
            f"{name:20}{peak['value'] / 1e6:.6g}{bar} MPa at node {peak['node']} ({point} m), {peak['time']:.6g} s"
        )
    if not report["stress"]:
        lines.append("stress              none: only meshes have stresses")
    of_modes = np.array(report["strain_energy"]["by_mode"])
    lines.append(f"{'strain energy':20}{report['strain_energy']['largest']:.6g} J at most")
    for k in np.argsort(of_modes)[::-1][:MOST_FREQUENCIES]:
        lines.append(f"{'  mode':20}{k + 1} ({report['frequencies'][k]:.6g} Hz): {of_modes[k]:.4g} J at most")
    for node, own in report["displacement"].items():
        lines.append(f"{f'node {node}':20}{own['largest']:.6g} m at {own['time']:.6g} s, at most")
    lines += [f"{'note':20}{note}" for note in report["notes"]]
    return "\n".join(lines)


def write_shapes(path: Path, model: FiniteElements, body: ReducedBody) -> None:
    """Write nodes, elements and the displacement of each mode as vectors at the nodes. Raises OSError."""
    import meshio

    cells = dict(model.cells) or {"vertex": np.arange(len(model.nodes))[:, None]}
    fields = {
        f"mode {k + 1}: {frequency:.6g} Hz": body.displacements[..., k] for k, frequency in enumerate(body.frequencies)
    }
    meshio.Mesh(model.nodes, list(cells.items()), point_data=fields).write(path)
