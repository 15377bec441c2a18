"""Meshes and matrices of bars for the tests of flexible bodies."""

from pathlib import Path

import meshio
import numpy as np
from skfem import MeshHex, MeshHex2, MeshTet, MeshTet2

from stiffmbs.flexible_bodies.description import Material
from stiffmbs.flexible_bodies.finite_elements import FiniteElements
from stiffmbs.flexible_bodies.interfaces import Interface
from stiffmbs.flexible_bodies.mesh import from_mesh

REFERENCES = Path(__file__).parents[3] / "shared" / "references" / "flexible"
"""Reference data outside of the repository; tests that need them are skipped where they are absent."""
LENGTH, WIDTH, HEIGHT = 0.4, 0.03, 0.02
E, NU, DENSITY = 2.1e11, 0.3, 7850.0
STEEL = Material(E=E, nu=NU, density=DENSITY)
MASS = LENGTH * WIDTH * HEIGHT * DENSITY


def mesh_of_bar(kind: str, along: int = 8, across: int = 2) -> meshio.Mesh:
    """Return a bar along x from the origin, in mm."""
    axes = [np.linspace(0, 1000 * size, n + 1) for size, n in ((LENGTH, along), (WIDTH, across), (HEIGHT, across))]
    plain = (MeshTet if kind.startswith("tetra") else MeshHex).init_tensor(*axes)
    if kind.startswith("tetra"):
        plain = MeshTet(plain.p, _right_handed(plain.p.T, plain.t.T).T)
    found = {"tetra10": MeshTet2, "hexahedron27": MeshHex2}.get(kind, type(plain)).from_mesh(plain)
    from skfem.io.meshio import to_meshio

    return to_meshio(found)


def _right_handed(points: np.ndarray, cells: np.ndarray) -> np.ndarray:
    edges = points[cells[:, 1:]] - points[cells[:, [0]]]
    return np.where(np.linalg.det(edges)[:, None] > 0, cells, cells[:, [0, 2, 1, 3]])


def bar(folder: Path, kind: str = "tetra10", **divisions: int) -> FiniteElements:
    """Return the model of a bar from its mesh file."""
    path = folder / "bar.vtu"
    mesh_of_bar(kind, **divisions).write(path)
    return from_mesh(path, 1e-3, STEEL)


def face(model: FiniteElements, x: float, name: str, kind: str = "rigid") -> Interface:
    """Return the interface of the nodes at x."""
    nodes = np.flatnonzero(np.abs(model.nodes[:, 0] - x) < 1e-9)
    return Interface(name, kind, nodes, model.nodes[nodes].mean(axis=0))
