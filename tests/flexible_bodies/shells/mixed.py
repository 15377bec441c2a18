"""Meshes of blocks and plates with common nodes, for the tests of solids and shells together."""

from pathlib import Path

import meshio
import numpy as np

from stiffmbs.flexible_bodies.finite_elements import FiniteElements
from stiffmbs.flexible_bodies.mesh import from_mesh

from ..bars import with_middles
from .meshes import places, surface, under

Part = tuple[np.ndarray, str, np.ndarray]
"""Points, kind of elements, and their nodes."""


def block(counts, size, start=(0.0, 0.0, 0.0), kind="hexahedron20") -> Part:
    """Return a block of bricks along the axes, mm."""
    axes = [first + np.linspace(0, length, n + 1) for first, length, n in zip(start, size, counts, strict=True)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    numbers = np.arange(len(points)).reshape([n + 1 for n in counts])
    corners = (0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)
    cells = [numbers[tuple(slice(k, n + k) for k, n in zip(corner, counts, strict=True))].ravel() for corner in corners]
    mesh = with_middles(points, "hexahedron", np.column_stack(cells), kind)
    return mesh.points, mesh.cells[0].type, mesh.cells[0].data


def plate(along, across, place, kind="quad") -> Part:
    """Return a plate of quadrilaterals at a function of two numbers from 0 to 1, mm."""
    points, cells, _ = surface(along, across, place)
    mesh = with_middles(points, "quad", cells["quad"], kind)
    return mesh.points, kind, mesh.cells[0].data


def written(path: Path, parts: dict[str, Part]) -> Path:
    """Write parts to a file of Abaqus, each a set of elements; nodes at one place are one."""
    points = np.vstack([part[0] for part in parts.values()])
    _, first, number = np.unique(points.round(6), axis=0, return_index=True, return_inverse=True)
    cells, start = [], 0
    for own, kind, nodes in parts.values():
        cells.append((kind, number.ravel()[start + nodes]))
        start += len(own)
    none = np.empty(0, dtype=int)
    sets = {
        name: [np.arange(len(nodes)) if k == j else none for j, (_, nodes) in enumerate(cells)]
        for k, name in enumerate(parts)
    }
    meshio.Mesh(points[first], cells, cell_sets=sets).write(path)
    return path


def both(folder: Path, parts: dict[str, Part], materials, thicknesses) -> FiniteElements:
    """Return the checked model of parts."""
    found = from_mesh(written(folder / "both.inp", parts), 1e-3, materials, thickness=thicknesses)
    found.check()
    return found


def end_moved(model: FiniteElements, held: np.ndarray, loaded: np.ndarray, component: int) -> float:
    """Return the mean displacement of nodes under a force of 1 N, shared between these along a line, with other nodes held."""
    order = loaded[np.lexsort(model.nodes[loaded].T)]
    share = np.ones(len(order))
    if len(order) > 2:
        share[[0, -1]] = 0.5
    forces = np.zeros((len(model.nodes), 6))
    forces[order, component] = share / share.sum()
    moved = under(model.stiffness, places(held, range(6)), forces.ravel())
    return float(moved[order, component].mean())
