"""Meshes and matrices of bars for the tests of flexible bodies."""

from pathlib import Path

import meshio
import numpy as np
from meshio._mesh import topological_dimension
from skfem import MeshHex, MeshHex2, MeshTet, MeshTet2

from stiffmbs.flexible_bodies.description import Material
from stiffmbs.flexible_bodies.finite_elements import FiniteElements
from stiffmbs.flexible_bodies.interfaces import Interface
from stiffmbs.flexible_bodies.mesh import from_mesh

topological_dimension["wedge15"] = 3  # missing in meshio 5.3, which writes them
REFERENCES = Path(__file__).parents[3] / "shared" / "references" / "flexible"
"""Reference data outside of the repository; tests that need them are skipped where they are absent."""
LENGTH, WIDTH, HEIGHT = 0.4, 0.03, 0.02
E, NU, DENSITY = 2.1e11, 0.3, 7850.0
STEEL = Material(E=E, nu=NU, density=DENSITY)
MASS = LENGTH * WIDTH * HEIGHT * DENSITY


MIDDLES = {
    "hexahedron20": ("hexahedron", "01 12 23 30 45 56 67 74 04 15 26 37"),
    "hexahedron27": ("hexahedron", "01 12 23 30 45 56 67 74 04 15 26 37 0473 1265 0154 3762 0321 4567 01234567"),
    "triangle6": ("triangle", "01 12 20"),
    "quad8": ("quad", "01 12 23 30"),
    "quad9": ("quad", "01 12 23 30 0123"),
    "wedge15": ("wedge", "01 12 20 34 45 53 03 14 25"),
    "wedge18": ("wedge", "01 12 20 34 45 53 03 14 25 0143 1254 2035"),
}
"""Corners between which the further nodes of an element are, in the order of VTK."""


def mesh_of_bar(kind: str, along: int = 8, across: int = 2) -> meshio.Mesh:
    """Return a bar along x from the origin, in mm."""
    linear = kind.rstrip("0123456789")
    if linear in ("wedge", "pyramid"):
        bricks = mesh_of_bar("hexahedron", along, across)
        points, cells = split(linear, bricks.points, bricks.cells[0].data)
        return with_middles(points, linear, cells, kind)
    axes = [np.linspace(0, 1000 * size, n + 1) for size, n in ((LENGTH, along), (WIDTH, across), (HEIGHT, across))]
    plain = (MeshTet if kind.startswith("tetra") else MeshHex).init_tensor(*axes)
    if kind.startswith("tetra"):
        plain = MeshTet(plain.p, _right_handed(plain.p.T, plain.t.T).T)
    found = {"tetra10": MeshTet2, "hexahedron27": MeshHex2}.get(kind, type(plain)).from_mesh(plain)
    from skfem.io.meshio import to_meshio

    mesh = to_meshio(found)
    return with_middles(mesh.points, linear, mesh.cells[0].data, kind) if kind == "hexahedron20" else mesh


def split(kind: str, points: np.ndarray, cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return nodes and elements of bricks that are divided into two wedges, or into six pyramids about their middles."""
    if kind == "wedge":
        return points, np.vstack([cells[:, list(half)] for half in ((0, 1, 2, 4, 5, 6), (0, 2, 3, 4, 6, 7))])
    middles = len(points) + np.arange(len(cells))
    bases = ((0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (2, 6, 7, 3), (0, 3, 7, 4), (1, 5, 6, 2))
    pyramids = [np.column_stack([cells[:, list(base)], middles]) for base in bases]
    return np.vstack([points, points[cells].mean(axis=1)]), np.vstack(pyramids)


def with_middles(points: np.ndarray, linear: str, cells: np.ndarray, kind: str) -> meshio.Mesh:
    """Return a mesh with further nodes in the middle between corners; neighbours share those at one place."""
    middles = MIDDLES.get(kind, (linear, ""))[1]
    wanted = [points[cells[:, [int(corner) for corner in between]]].mean(axis=1) for between in middles.split()]
    if not wanted:
        return meshio.Mesh(points, [(linear, cells)])
    more = np.stack(wanted, axis=1)
    _, first, place = np.unique(more.reshape(-1, 3).round(6), axis=0, return_index=True, return_inverse=True)
    return meshio.Mesh(
        np.vstack([points, more.reshape(-1, 3)[first]]),
        [(kind, np.hstack([cells, len(points) + place.reshape(len(cells), -1)]))],
    )


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
