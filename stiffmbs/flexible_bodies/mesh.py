"""Meshes of solid elements, of shells, or of both, read by meshio."""

from __future__ import annotations

import contextlib
import io
import logging
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import coo_array, csr_array

from ..errors import InputError, needs
from ..reading.files.quoted import first_line
from .abaqus_sets import with_own_sets
from .finite_elements import DISPLACEMENTS, FiniteElements
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
from .mesh_files import ABAQUS, GMSH, for_reader, refuse_ignored, unused
from .shapes import ELEMENTS, TOGETHER
from .shells.checks import check_shells
from .shells.divided import PARTS, with_divided_shells
from .shells.shell import COMPONENTS, DIVISION, Shell
from .shells.shell import of_elements as shell_of
from .shells.welds import rotations
from .solid import Block, Solid

if TYPE_CHECKING:
    import meshio

    from .description import Material

LOGGER = logging.getLogger(__name__)
ABAQUS_TYPES = {"C3D5": "pyramid", "C3D27": "hexahedron27", "S6": "triangle6", "S8": "quad8"}
"""Elements of Abaqus and CalculiX that meshio 5.3 does not know."""
ABAQUS_ORDER = {"hexahedron27": [*range(20), 26, 24, 23, 25, 21, 22, 20]}
"""Order of the nodes of such elements: node 21 is in the middle, and nodes 22 to 27 are on the faces (Abaqus' manual, three-dimensional solid
element library)."""
GMSH_ORDER = {"wedge18": [0, 1, 2, 3, 4, 5, 6, 9, 7, 12, 14, 13, 8, 10, 11, 15, 17, 16]}
"""Order of the nodes of elements that meshio leaves in that of Gmsh."""
HARMLESS = {"vertex", "line", "line3", *DIVISION, *PARTS}
"""Elements of a mesh that are not solids and are used only as groups."""
Placed = Callable[[np.ndarray], np.ndarray]


def from_mesh(
    path: Path, length: float, materials: Material | Mapping[str, Material], placed: Placed = lambda nodes: nodes,
    thickness: float | Mapping[str, float] | None = None,
) -> FiniteElements:  # fmt: skip
    """Return the model of a mesh of tetrahedra, hexahedra, wedges and pyramids of first or second order, or of shells.

    `path`: file of a format of meshio: Gmsh, Abaqus, Nastran, VTK. `length`: unit of the mesh, m. `materials`: one of all
    elements, or by groups of elements. `placed`: function of the positions of all nodes, shape (n, 3), m, that returns
    other ones. `thickness`: of shells, m; triangles and quadrilaterals are shells if it is given. In a mesh with solids, those are
    shells that are in a group with a thickness. Raises InputError.
    """
    LOGGER.info("reading and assembling the mesh %s", path.name)
    mesh = _read(path)
    if thickness is not None:
        mesh = with_divided_shells(mesh)
    kinds = _kinds(mesh, thickness)
    connected = {kind: _connected(mesh, kind) for kind in kinds}
    groups = {kind: element_groups(mesh, kind, what) for kind, what in kinds.items()}
    if PHYSICAL in mesh.cell_data:  # Gmsh repeats elements of several physical groups (format 2)
        for kind in kinds:
            connected[kind], groups[kind] = _each_once(connected[kind], groups[kind])
    of_shells = dict.fromkeys(name for kind, of_kind in groups.items() if kinds[kind] == SHELLS for name in of_kind)
    refuse_unknown("thicknesses", thickness, of_shells, SHELLS)
    if {*kinds.values()} == {SOLIDS, SHELLS}:
        kinds, connected, groups = _shells_of_groups(kinds, connected, groups, thickness)
    names = dict.fromkeys(name for of_kind in groups.values() for name in of_kind)
    refuse_unknown("materials", materials, names, " or ".join(dict.fromkeys(kinds.values())))
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
    whats = tuple(dict.fromkeys(kinds.values()))
    parts = "" if isinstance(materials, Mapping) else parts_of(path, mesh, list(groups.values()), whats)
    solids = {kind: own for kind, own in cells.items() if kinds[kind] == SOLIDS}
    shells = {kind: own for kind, own in cells.items() if kinds[kind] == SHELLS}
    thick = {kind: thickness_of_elements(thickness or 0.0, groups[kind], connected[kind]) for kind in shells}
    solid, shell = None, None
    if solids:
        solid = _of_solids(nodes, solids, of_kinds)
    if shells:
        check_shells(nodes, shells)
        shell = shell_of(nodes, shells, of_kinds, thick)
    check_connected(solids, shells)
    stiffness, mass = _matrices(solid, shell)
    return FiniteElements(
        nodes, stiffness, mass, of_nodes, {**solids, **shells}, solid, parts=parts, unused=unused(path),
        components=DISPLACEMENTS if shell is None else COMPONENTS, shell=shell,
    )  # fmt: skip


def _matrices(solid: Solid | None, shell: Shell | None) -> tuple[csr_array, csr_array]:
    """Return stiffness and mass of solids, of shells, or of both; nodes have six components if there are shells."""
    if shell is None:
        assert solid is not None
        return solid.stiffness(), solid.mass()
    if solid is None:
        return shell.stiffness(), shell.mass()
    count = len(shell.places)
    entries = (COMPONENTS * np.arange(count)[:, None] + np.arange(DISPLACEMENTS)).ravel()
    at = (np.ones(len(entries)), (entries, np.arange(len(entries))))
    placed = csr_array(coo_array(at, shape=(COMPONENTS * count, DISPLACEMENTS * count)))
    stiffness = csr_array(shell.stiffness() + placed @ solid.stiffness() @ placed.T + rotations(solid, shell))
    return stiffness, csr_array(shell.mass() + placed @ solid.mass() @ placed.T)


def _shells_of_groups(
    kinds: Mapping[str, str], connected: Mapping[str, np.ndarray], groups: Mapping[str, dict[str, np.ndarray]], thickness: object
) -> tuple[dict[str, str], dict[str, np.ndarray], dict[str, dict[str, np.ndarray]]]:  # fmt: skip
    """Return kinds, elements and groups of a mesh with solids, whose surface elements are shells in groups with a thickness alone."""
    assert isinstance(thickness, Mapping)
    cells, of_kinds = dict(connected), dict(groups)
    for kind in [kind for kind, what in kinds.items() if what == SHELLS]:
        members = [groups[kind][name] for name in thickness if name in groups[kind]]
        kept = np.unique(np.concatenate([*members, np.empty(0, dtype=np.int64)]))
        cells[kind] = connected[kind][kept]
        of_kinds[kind] = {name: np.searchsorted(kept, np.intersect1d(own, kept)) for name, own in groups[kind].items()}
    used = {kind: what for kind, what in kinds.items() if len(cells[kind])}
    return used, {kind: cells[kind] for kind in used}, {kind: of_kinds[kind] for kind in used}


def _of_solids(nodes: np.ndarray, cells: Mapping[str, np.ndarray], materials: Mapping[str, ElementMaterials]) -> Solid:
    """Return checked solids; cells and materials by kinds of elements."""
    blocks = []
    for kind, own in cells.items():
        check_volumes(nodes, own, kind)
        check_repeated(own[:, : len(ELEMENTS[kind].shape.corners)])
        blocks.append(Block(kind, nodes, own.T, materials[kind]))
        check_jacobians(blocks[-1])
    check_shared(cells)
    return Solid(tuple(blocks))


def _kinds(mesh: meshio.Mesh, thickness: object) -> dict[str, str]:
    """Return solid or shell by the kinds of elements of a mesh; refuse others, and solids whose nodes do not meet."""
    found = dict.fromkeys(block.type for block in mesh.cells)
    solid = [kind for kind in found if kind in ELEMENTS]
    shells = [kind for kind in found if kind in DIVISION]
    listed = ", ".join(sorted(found)) or "none"
    if thickness is None and not solid and shells:
        raise InputError(f"found surfaces ({listed}) without a thickness, expected solids, or 'thickness' for shells")
    if thickness is not None and not solid:
        if not shells or found.keys() - DIVISION.keys() - HARMLESS:
            raise InputError(
                f"found elements of the types {listed}, expected shells of the types {', '.join([*DIVISION, *PARTS])}"
            )
        return dict.fromkeys(shells, SHELLS)
    if (
        not solid
        or found.keys() - ELEMENTS.keys() - HARMLESS
        or not any(together >= set(solid) for together in TOGETHER)
    ):
        raise InputError(
            f"found elements of the types {listed}, expected solids of the types "
            f"{'; '.join(', '.join(kind for kind in ELEMENTS if kind in together) for together in TOGETHER)}"
        )
    if thickness is None:
        return dict.fromkeys(solid, SOLIDS)
    if not shells:
        raise InputError(
            f"found a thickness of shells for a mesh of solids alone ({', '.join(sorted(solid))}), expected none for solids"
        )
    if not isinstance(thickness, Mapping):
        raise InputError(
            f"found one thickness for a mesh with solids ({', '.join(sorted(solid))}), expected 'thicknesses' by groups of its surface "
            "elements: those in other groups are faces of solids"
        )
    return dict.fromkeys(solid, SOLIDS) | dict.fromkeys(shells, SHELLS)


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
        from meshio.abaqus._abaqus import abaqus_to_meshio_type
    abaqus_to_meshio_type.update(ABAQUS_TYPES)
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
            else with_own_sets(_in_order(found, ABAQUS_ORDER), path)
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
    return _in_order(mesh, GMSH_ORDER)


def _in_order(mesh: meshio.Mesh, orders: Mapping[str, list[int]]) -> meshio.Mesh:
    """Return a mesh whose elements of some kinds have their nodes in another order."""
    for block in mesh.cells:
        if block.type in orders:
            block.data = block.data[:, orders[block.type]]
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
