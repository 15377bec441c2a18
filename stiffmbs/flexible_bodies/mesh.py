"""Meshes of solid elements or of shells, read by meshio."""

from __future__ import annotations

import contextlib
import io
import logging
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..errors import InputError, needs
from ..reading.files.quoted import first_line
from .abaqus_sets import with_own_sets
from .finite_elements import FiniteElements
from .materials import (
    PHYSICAL,
    SHELLS,
    SOLIDS,
    ElementMaterials,
    element_groups,
    of_elements,
    parts_of,
    refuse_unknown,
    thickness_of_elements,
)
from .mesh_checks import check_connected, check_jacobians, check_repeated, check_shared, check_volumes
from .mesh_files import ABAQUS, GMSH, for_reader, refuse_ignored
from .shapes import ELEMENTS, TOGETHER
from .shells.checks import check_shells
from .shells.shell import COMPONENTS, DIVISION
from .shells.shell import of_elements as shell_of
from .solid import Block, Solid

if TYPE_CHECKING:
    import meshio

    from .description import Material

LOGGER = logging.getLogger(__name__)
GMSH_ORDER = {"wedge18": [0, 1, 2, 3, 4, 5, 6, 9, 7, 12, 14, 13, 8, 10, 11, 15, 17, 16]}
"""Order of the nodes of elements that meshio leaves in that of Gmsh."""
HARMLESS = {"vertex", "line", "line3", "triangle", "triangle6", "quad", "quad8", "quad9"}
"""Elements of a mesh that are not solids and are used only as groups."""
NOT_SHELLS = {"triangle6", "quad8", "quad9"}
"""Elements of surfaces that are not read as shells."""
Placed = Callable[[np.ndarray], np.ndarray]


def from_mesh(
    path: Path, length: float, materials: Material | Mapping[str, Material], placed: Placed = lambda nodes: nodes,
    thickness: float | Mapping[str, float] | None = None,
) -> FiniteElements:  # fmt: skip
    """Return the model of a mesh of tetrahedra, hexahedra, wedges and pyramids of first or second order, or of shells.

    `path`: file of a format of meshio: Gmsh, Abaqus, Nastran, VTK. `length`: unit of the mesh, m. `materials`: one of all
    elements, or by groups of elements. `placed`: function of the positions of all nodes, shape (n, 3), m, that returns
    other ones. `thickness`: of shells, m; triangles and quadrilaterals are shells if it is given. Raises InputError.
    """
    LOGGER.info("reading and assembling the mesh %s", path.name)
    mesh, what = _read(path), SOLIDS if thickness is None else SHELLS
    kinds = _kinds(mesh) if thickness is None else _kinds_of_shells(mesh)
    connected = {kind: _connected(mesh, kind) for kind in kinds}
    groups = {kind: element_groups(mesh, kind, what) for kind in kinds}
    if PHYSICAL in mesh.cell_data:  # Gmsh repeats elements of several physical groups (format 2)
        for kind in kinds:
            connected[kind], groups[kind] = _each_once(connected[kind], groups[kind])
    names = dict.fromkeys(name for of_kind in groups.values() for name in of_kind)
    refuse_unknown("materials", materials, names, what)
    refuse_unknown("thicknesses", thickness, names, what)
    used = np.unique(np.concatenate([cells.ravel() for cells in connected.values()]))
    numbers = np.full(len(mesh.points), -1)
    numbers[used] = np.arange(len(used))
    nodes = np.asarray(mesh.points, dtype=float)[used] * length
    if nodes.shape[1] != 3:
        raise InputError(f"found nodes with {nodes.shape[1]} coordinates, expected x, y and z")
    if not np.isfinite(nodes).all():
        raise InputError("nodes: found a position that is not finite, expected numbers")
    nodes, cells = placed(nodes), {kind: numbers[own] for kind, own in connected.items()}
    of_kinds = {kind: of_elements(materials, groups[kind], connected[kind]) for kind in kinds}
    of_nodes = _groups(mesh, numbers)
    parts = "" if isinstance(materials, Mapping) else parts_of(path, mesh, list(groups.values()), what)
    if thickness is None:
        return _of_solids(nodes, cells, of_kinds, of_nodes, parts)
    thick = {kind: thickness_of_elements(thickness, groups[kind], connected[kind]) for kind in kinds}
    check_shells(nodes, cells)
    shell = shell_of(nodes, cells, of_kinds, thick)
    return FiniteElements(
        nodes, shell.stiffness(), shell.mass(), of_nodes, cells, parts=parts, components=COMPONENTS, shell=shell
    )


def _of_solids(
    nodes: np.ndarray, cells: Mapping[str, np.ndarray], materials: Mapping[str, ElementMaterials],
    groups: Mapping[str, np.ndarray], parts: str,
) -> FiniteElements:  # fmt: skip
    """Return the model of solids; cells and materials by kinds of elements."""
    blocks = []
    for kind, own in cells.items():
        check_volumes(nodes, own, kind)
        check_repeated(own[:, : len(ELEMENTS[kind].shape.corners)])
        blocks.append(Block(kind, nodes, own.T, materials[kind]))
        check_jacobians(blocks[-1])
    check_shared(cells)
    check_connected(cells)
    solid = Solid(tuple(blocks))
    return FiniteElements(nodes, solid.stiffness(), solid.mass(), groups, cells, solid, parts=parts)


def _kinds(mesh: meshio.Mesh) -> list[str]:
    """Return the kinds of solids of a mesh; refuse others, and those whose nodes do not meet."""
    found = dict.fromkeys(block.type for block in mesh.cells)
    solid = [kind for kind in found if kind in ELEMENTS]
    if not solid and found.keys() & DIVISION.keys():
        raise InputError(
            f"found surfaces ({', '.join(sorted(found))}) without a thickness, expected solids, or 'thickness' for shells"
        )
    if (
        not solid
        or found.keys() - ELEMENTS.keys() - HARMLESS
        or not any(together >= set(solid) for together in TOGETHER)
    ):
        raise InputError(
            f"found elements of the types {', '.join(sorted(found)) or 'none'}, expected solids of the types "
            f"{'; '.join(', '.join(kind for kind in ELEMENTS if kind in together) for together in TOGETHER)}"
        )
    return solid


def _kinds_of_shells(mesh: meshio.Mesh) -> list[str]:
    """Return the kinds of shells of a mesh; refuse other elements, apart from those that are used only as groups."""
    found = dict.fromkeys(block.type for block in mesh.cells)
    solid = sorted(found.keys() & ELEMENTS.keys())
    if solid:
        raise InputError(
            f"found a thickness of shells for a mesh with solids ({', '.join(solid)}), expected none for solids; meshes of "
            "both are not supported"
        )
    if not found.keys() & DIVISION.keys() or found.keys() - DIVISION.keys() - HARMLESS or found.keys() & NOT_SHELLS:
        raise InputError(
            f"found elements of the types {', '.join(sorted(found)) or 'none'}, expected shells of the types {', '.join(DIVISION)}"
        )
    return [kind for kind in found if kind in DIVISION]


def _connected(mesh: meshio.Mesh, kind: str) -> np.ndarray:
    """Return the nodes of the elements of a kind, shape (elements, nodes of an element)."""
    found = np.vstack([block.data for block in mesh.cells if block.type == kind]).astype(np.int64)
    count = len(ELEMENTS[kind].powers) if kind in ELEMENTS else len({*sum(DIVISION[kind], ())})
    if not found.size or found.shape[1] != count:
        raise InputError(
            f"found {len(found)} elements of {found.shape[1]} nodes of the type {kind}, expected some of {count}"
        )
    if found.min() < 0 or found.max() >= len(mesh.points):
        raise InputError(
            f"found an element with a node outside the {len(mesh.points)} nodes of the mesh, expected only these"
        )
    return found


def _each_once(cells: np.ndarray, groups: Mapping[str, np.ndarray]) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Return elements without repetitions, and the groups by their new numbers."""
    _, first, unique = np.unique(cells, axis=0, return_index=True, return_inverse=True)
    kept = np.sort(first)
    numbers = np.searchsorted(kept, first[unique.ravel()])
    return cells[kept], {name: np.unique(numbers[elements]) for name, elements in groups.items()}


def _read(path: Path) -> meshio.Mesh:
    with needs("meshio", "flexible"):
        import meshio
        from meshio._mesh import topological_dimension
    topological_dimension.update(dict.fromkeys(("wedge15", "pyramid13"), 3))  # missing in meshio 5.3, which reads them
    if not path.is_file():  # a pipe or a device may not end
        raise InputError("found no such file, expected a mesh")
    refuse_ignored(path)
    said = io.StringIO()
    try:
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            found = meshio.read(*for_reader(path))
        return (
            _as_vtk(found)
            if path.suffix.lower() == GMSH
            else with_own_sets(found, path)
            if path.suffix.lower() == ABAQUS
            else found
        )
    except InputError:
        raise
    except SystemExit:
        reason = said.getvalue().partition("\n")[0] or "unknown format"
    except Exception as error:  # readers raise many types
        reason = "reference to the unknown number " * isinstance(error, KeyError) + first_line(error)
    raise InputError(f"found no mesh ({reason}), expected Gmsh .msh, Abaqus .inp, Nastran .bdf, VTK .vtu or .vtk")


def _as_vtk(mesh: meshio.Mesh) -> meshio.Mesh:
    """Return a mesh of Gmsh with the order of VTK in all elements, without meshio's sets of geometric entities."""
    mesh.cell_sets = {name: found for name, found in mesh.cell_sets.items() if not name.startswith("gmsh:")}
    for block in mesh.cells:
        if block.type in GMSH_ORDER:
            block.data = block.data[:, GMSH_ORDER[block.type]]
    return mesh


def _groups(mesh: meshio.Mesh, numbers: np.ndarray) -> dict[str, np.ndarray]:
    """Return the named groups of nodes: sets of points, and nodes of sets or physical groups of elements."""
    found: dict[str, list[np.ndarray]] = {}
    for name, points in mesh.point_sets.items():
        found.setdefault(name, []).append(np.asarray(points, dtype=np.int64))
    for name, of_blocks in mesh.cell_sets.items():
        for block, members in zip(mesh.cells, of_blocks, strict=False):
            if members is not None and len(members):
                found.setdefault(name, []).append(np.unique(block.data[members]))
    physical = mesh.cell_data.get(PHYSICAL)
    for name, (tag, dimension) in mesh.field_data.items() if physical is not None else ():
        for block, tags in zip(mesh.cells, physical, strict=True):
            members = np.flatnonzero(tags == tag)
            if len(members) and block.dim == dimension:
                found.setdefault(name, []).append(np.unique(block.data[members]))
    groups = {
        name: numbers[np.unique(np.concatenate([*parts, np.empty(0, dtype=np.int64)]))] for name, parts in found.items()
    }
    return {name: nodes[nodes >= 0] for name, nodes in groups.items()}
