"""Reductions of large finite element models, each in a process of its own: time, memory and error of the frequencies."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from stiffmbs.flexible_bodies.description import Material
from stiffmbs.flexible_bodies.interfaces import Interface
from stiffmbs.flexible_bodies.mesh import from_mesh
from stiffmbs.flexible_bodies.reduction import reduce
from tests.flexible_bodies.bars import HEIGHT, LENGTH, WIDTH, mesh_of_bar

from .benchmark import Row
from .processes import largest_memory

SIZE = (1.0, 0.05, 0.03)
"""Length, width and height of the bar, m; of steel."""
FREQUENCIES = (158.9925, 263.4806, 435.7375, 714.7804, 847.116, 1305.728, 1370.346, 1385.196, 2042.220, 2203.008)
"""Of the free bar, Hz, by hexahedra of orders 4 to 6, converged to 1e-6."""
MODES = 20


@dataclass(frozen=True)
class Mesh:
    """Divisions of the bar.

    Attributes
    ----------
    kind : str
        Elements, as meshio names them.
    along, across : int
        Divisions of the length, and of width and height.
    """

    kind: str
    along: int
    across: int


@dataclass(frozen=True)
class Reductions:
    """Reductions of the bar with two interfaces, from small to large."""

    name: str
    meshes: Sequence[Mesh]

    def measured(self) -> list[Row]:
        """Reduce all meshes."""
        return [_row(mesh) for mesh in self.meshes]

    def glanced(self) -> list[Row]:
        """Reduce the smallest mesh."""
        return [_row(self.meshes[0])]


def _row(mesh: Mesh) -> Row:
    """Measure a reduction in a fresh process."""
    program = [sys.executable, "-m", __name__, mesh.kind, str(mesh.along), str(mesh.across)]
    found = json.loads(subprocess.run(program, check=True, capture_output=True, text=True).stdout)
    setting = f"{found['nodes']} nodes, {found['elements']} {mesh.kind}, {found['reading']:.1f} s reading, {found['memory']:.0f} MB"
    return Row("reduction", setting, found["error"], found["seconds"], False)


def measure(mesh: Mesh) -> dict[str, float]:
    """Return nodes, elements, processor time of reading and of the reduction, s, largest memory, MB, and relative error."""
    bar = mesh_of_bar(mesh.kind, mesh.along, mesh.across)
    bar.points *= np.array(SIZE) / (LENGTH, WIDTH, HEIGHT)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "bar.vtu"
        bar.write(path)
        begun = time.process_time()
        model = from_mesh(path, 1e-3, Material(E=2.1e11, nu=0.3, density=7850.0))
    read = time.process_time()
    ends = []
    for name, x in (("start", 0.0), ("end", SIZE[0])):
        nodes = np.flatnonzero(np.abs(model.nodes[:, 0] - x) < 1e-9)
        ends.append(Interface(name, "average", nodes, model.nodes[nodes].mean(axis=0)))
    body = reduce(model, ends, MODES)
    done = time.process_time()
    error = np.abs(body.frequencies[: len(FREQUENCIES)] / FREQUENCIES - 1).max()
    return {
        "nodes": len(model.nodes), "elements": len(bar.cells[0].data), "reading": read - begun, "seconds": done - read,
        "memory": largest_memory(), "error": float(error),
    }  # fmt: skip


if __name__ == "__main__":
    kind, along, across = sys.argv[1:]
    print(json.dumps(measure(Mesh(kind, int(along), int(across)))))
