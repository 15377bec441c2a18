"""Meshes of solid elements, read by meshio, with the shape functions of scikit-fem."""

from __future__ import annotations

import contextlib
import io
import logging
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import csr_array

from ..errors import InputError, needs
from ..reading.files.quoted import first_line
from .finite_elements import PRECISION, FiniteElements
from .materials import PHYSICAL, ElementMaterials, element_groups, of_elements, parts_of
from .mesh_files import for_reader, refuse_ignored, sets_of_sets
from .solid import Solid

if TYPE_CHECKING:
    import meshio
    import skfem

    from .description import Material

LOGGER = logging.getLogger(__name__)
SOLIDS = {
    "tetra": ("tetra", "ElementTetP1", 2),
    "tetra10": ("tetra10", "ElementTetP2", 4),
    "hexahedron": ("hexahedron", "ElementHex1", 3),
    "hexahedron20": ("hexahedron", "ElementHexS2", 5),
    "hexahedron27": ("hexahedron27", "ElementHex2", 5),
}
"""Geometry, element of scikit-fem and order of quadrature by element type of meshio."""
NODES = {"tetra": 4, "tetra10": 10, "hexahedron": 8, "hexahedron20": 20, "hexahedron27": 27}
CORNERS = {"tetra": 4, "tetra10": 4, "hexahedron": 8, "hexahedron20": 8, "hexahedron27": 8}
FLAT = 1e-9
"""Smallest volume of an element, relative to the product of its edges, and smallest density of volume relative to the largest."""
HARMLESS = {"vertex", "line", "line3", "triangle", "triangle6", "quad", "quad8", "quad9"}
"""Elements of a mesh that are not solids and are used only as groups."""


def from_mesh(
    path: Path, length: float, materials: Material | Mapping[str, Material],
    placed: Callable[[np.ndarray], np.ndarray] = lambda nodes: nodes,
) -> FiniteElements:  # fmt: skip
    """Return the model of a mesh of tetrahedra or hexahedra of first or second order.

    `path`: file of a format of meshio: Gmsh, Abaqus, Nastran, VTK. `length`: unit of the mesh, m. `materials`: one of all
    elements, or by groups of elements. `placed`: function of the positions of all nodes, shape (n, 3), m, that returns
    other ones. Raises InputError.
    """
    LOGGER.info("reading and assembling the mesh %s", path.name)
    mesh = _read(path)
    kinds = {block.type for block in mesh.cells}
    solid = kinds & SOLIDS.keys()
    if len(solid) != 1 or kinds - SOLIDS.keys() - HARMLESS:
        raise InputError(
            f"found elements of the types {', '.join(sorted(kinds)) or 'none'}, expected solids of one type of {', '.join(SOLIDS)}"
        )
    (kind,) = solid
    connected = np.vstack([block.data for block in mesh.cells if block.type == kind]).astype(np.int64)
    if not connected.size or connected.shape[1] != NODES[kind]:
        raise InputError(
            f"found {len(connected)} elements of {connected.shape[1]} nodes of the type {kind}, expected some of {NODES[kind]}"
        )
    if connected.min() < 0 or connected.max() >= len(mesh.points):
        raise InputError(
            f"found an element with a node outside the {len(mesh.points)} nodes of the mesh, expected only these"
        )
    groups = element_groups(mesh, kind)
    if PHYSICAL in mesh.cell_data:  # Gmsh repeats elements of several physical groups (format 2)
        _, first, unique = np.unique(connected, axis=0, return_index=True, return_inverse=True)
        kept = np.sort(first)
        connected, numbered = connected[kept], np.searchsorted(kept, first[unique.ravel()])
        groups = {name: np.unique(numbered[elements]) for name, elements in groups.items()}
    used, inverse = np.unique(connected, return_inverse=True)
    cells = inverse.reshape(connected.shape)
    nodes = np.asarray(mesh.points, dtype=float)[used] * length
    if nodes.shape[1] != 3:
        raise InputError(f"found nodes with {nodes.shape[1]} coordinates, expected x, y and z")
    if not np.isfinite(nodes).all():
        raise InputError("nodes: found a position that is not finite, expected numbers")
    nodes = placed(nodes)
    _check_volumes(nodes, cells, kind)
    _check_repeated(cells, kind)
    stiffness, mass, shapes = _assembled(nodes, cells, kind, of_elements(materials, groups, connected))
    numbers = np.full(len(mesh.points), -1)
    numbers[used] = np.arange(len(used))
    parts = "" if isinstance(materials, Mapping) else parts_of(path, mesh, groups)
    of_nodes = _groups(mesh, numbers, sets_of_sets(path))
    return FiniteElements(nodes, stiffness, mass, of_nodes, {kind: cells}, shapes, parts=parts)


def _read(path: Path) -> meshio.Mesh:
    with needs("meshio", "flexible"):
        import meshio
    if not path.is_file():  # a pipe or a device may not end
        raise InputError("found no such file, expected a mesh")
    refuse_ignored(path)
    said = io.StringIO()
    try:
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            return meshio.read(*for_reader(path))
    except SystemExit:
        reason = said.getvalue().partition("\n")[0] or "unknown format"
    except Exception as error:  # readers raise many types
        reason = "reference to the unknown number " * isinstance(error, KeyError) + first_line(error)
    raise InputError(f"found no mesh ({reason}), expected Gmsh .msh, Abaqus .inp, Nastran .bdf, VTK .vtu or .vtk")


def _check_volumes(nodes: np.ndarray, cells: np.ndarray, kind: str) -> None:
    """Refuse inverted and flat elements, by the volume at the corners."""
    corner = nodes[cells[:, : CORNERS[kind]]]
    neighbours = ((0, 1, 2, 3),) if CORNERS[kind] == 4 else (
        (0, 1, 3, 4), (1, 2, 0, 5), (2, 3, 1, 6), (3, 0, 2, 7), (4, 7, 5, 0), (5, 4, 6, 1), (6, 5, 7, 2), (7, 6, 4, 3),
    )  # fmt: skip
    for here, *others in neighbours:
        edges = corner[:, others] - corner[:, [here]]
        volume = np.linalg.det(edges)
        scale = np.prod(np.linalg.norm(edges, axis=2), axis=1)
        bad = np.flatnonzero(volume <= FLAT * scale)
        _refuse(bad, "inverted or flat elements", cells[:, : CORNERS[kind]], "elements of positive volume")


def _check_repeated(cells: np.ndarray, kind: str) -> None:
    """Refuse elements between the same nodes as others: their mass and stiffness would count twice."""
    corners = np.sort(cells[:, : CORNERS[kind]], axis=1)
    _, first = np.unique(corners, axis=0, return_index=True)
    repeated = np.setdiff1d(np.arange(len(cells)), first)
    _refuse(repeated, "elements between the same nodes as others", cells[:, : CORNERS[kind]], "each element once")


def _refuse(bad: np.ndarray, what: str, nodes: np.ndarray, expected: str) -> None:
    """Refuse elements by their numbers, if there are any; the message names the nodes of the first."""
    if len(bad):
        raise InputError(
            f"found {len(bad)} {what}, the first with nodes {', '.join(map(str, nodes[bad[0]]))}, expected {expected}"
        )


def _check_jacobians(mesh: skfem.Mesh, element: skfem.Element, order: int, cells: np.ndarray) -> None:
    """Refuse elements with curved edges that are inverted in parts: at a node or a point of the quadrature."""
    from skfem.quadrature import get_quadrature

    places = np.column_stack([element.doflocs.T, get_quadrature(element.refdom, order)[0]])
    slopes = np.moveaxis(mesh.mapping().DF(places), (0, 1), (-2, -1))
    volumes = np.broadcast_to(np.linalg.det(slopes), (len(cells), places.shape[1]))
    largest = np.abs(volumes).max(axis=1) * np.where(volumes[:, 0] < 0, -1.0, 1.0)  # hexahedra are reflected here
    ratios = volumes / np.where(largest == 0, 1.0, largest)[:, None]
    expected = "elements of positive volume; are nodes on their edges misplaced?"
    bad = np.flatnonzero(~(ratios > FLAT).all(axis=1))
    _refuse(bad, "elements that are inverted or flat in places", cells, expected)


def _assembled(
    nodes: np.ndarray, cells: np.ndarray, kind: str, materials: ElementMaterials
) -> tuple[csr_array, csr_array, Solid]:
    with needs("skfem", "flexible"):
        import skfem
        from skfem.io.meshio import from_meshio
    import meshio

    geometry, element, order = SOLIDS[kind]
    corners = np.unique(cells[:, : CORNERS[kind]])
    if geometry == kind:
        mesh = meshio.Mesh(nodes, [(kind, cells)])
    else:
        number = np.full(len(nodes), -1)
        number[corners] = np.arange(len(corners))
        mesh = meshio.Mesh(nodes[corners], [(geometry, number[cells[:, : CORNERS[kind]]])])
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        try:
            of_skfem, scalar = from_meshio(mesh), getattr(skfem, element)()
        except IndexError:  # it numbers edges by their corners
            raise InputError(
                "found elements that share nodes on edges or faces but not their corners, expected both or neither"
            ) from None
        _check_jacobians(of_skfem, scalar, order, cells)
        basis = skfem.Basis(of_skfem, scalar, intorder=order)
    of_shapes = _nodes_of_shapes(nodes, cells, basis.doflocs.T[basis.element_dofs], kind)
    of_dofs = np.empty(basis.N, dtype=np.int64)
    of_dofs[basis.element_dofs] = of_shapes
    _check_edges(of_dofs[basis.element_dofs], of_shapes)
    solid = Solid(of_skfem, scalar, order, of_shapes, materials.modulus, materials.poisson)
    return solid.stiffness(), solid.mass(materials.density), solid


def _nodes_of_shapes(nodes: np.ndarray, cells: np.ndarray, places: np.ndarray, kind: str) -> np.ndarray:
    """Return the nodes of the shape functions, shape (functions, elements), by place among those of each element.

    Nodes of different elements may coincide, as at a slit. `places`: of the functions, shape (functions, elements, 3), m.
    """
    found, own = np.empty(places.shape[:2], dtype=np.int64), nodes[cells]
    for k, place in enumerate(places):
        distance = np.linalg.norm(own - place[:, None], axis=2)
        nearest = distance.argmin(axis=1)
        off = distance.min(axis=1).max()
        if off > PRECISION * np.ptp(nodes, axis=0).max():
            raise InputError(
                f"found a node {off:.3g} m off the straight edge of its element, expected elements of type "
                f"{kind} with straight edges, or hexahedron27"
            )
        found[k] = np.take_along_axis(cells, nearest[:, None], axis=1)[:, 0]
    return found


def _check_edges(of_dofs: np.ndarray, of_shapes: np.ndarray) -> None:
    """Refuse elements that share an edge or face but not the nodes on it."""
    bad = np.argwhere(of_dofs != of_shapes)
    if len(bad):
        one, other = sorted((int(of_dofs[tuple(bad[0])]), int(of_shapes[tuple(bad[0])])))
        raise InputError(
            f"found the nodes {one} and {other} at the same place of an edge or face that elements share, expected one node"
        )


def _groups(mesh: skfem.Mesh, numbers: np.ndarray, within: Mapping[str, Sequence[str]]) -> dict[str, np.ndarray]:
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
    for name, members in within.items():
        found[name] = [*found.get(name, []), *(part for member in members for part in found.get(member, []))]
    groups = {
        name: numbers[np.unique(np.concatenate([*parts, np.empty(0, dtype=np.int64)]))] for name, parts in found.items()
    }
    return {name: nodes[nodes >= 0] for name, nodes in groups.items()}
