"""Meshes and matrices of a flexible body with something changed in their text or arrays: reduced, or refused.

What is accepted must have the mass of its elements, by quadrature of their nodes alone, or of its mass matrix, and no
frequency below those of the full matrices.
"""

from __future__ import annotations

import tempfile
from itertools import product
from pathlib import Path

import meshio
import numpy as np
from scipy.io import mmread, mmwrite
from scipy.linalg import eigh
from scipy.special import roots_jacobi

from stiffmbs.errors import StiffmbsError
from stiffmbs.flexible_bodies.description import FlexibleBody, InterfaceOfNodes, Material, Matrices, Units
from stiffmbs.flexible_bodies.mesh_files import for_reader
from stiffmbs.flexible_bodies.reduced import reduced_body
from stiffmbs.flexible_bodies.reduction import ReducedBody
from tests.flexible_bodies.bars import bar, mesh_of_bar, with_middles
from tests.flexible_bodies.shells.meshes import surface

from ..case import Outcome, Verdict
from .files import told

WHAT = "meshes and matrices with lines, numbers, nodes, elements or entries changed: refused in a sentence, or of right mass"
STEEL = Material(E=2.1e11, nu=0.3, density=7850)
ENDS = {
    "a": InterfaceOfNodes(plane={"point": [0, 0, 0], "normal": [1, 0, 0]}),
    "b": InterfaceOfNodes(plane={"point": [0.4, 0, 0], "normal": [1, 0, 0]}, type="average"),
}
FORMATS = {"msh": "gmsh", "inp": "abaqus", "vtk": "vtk", "bdf": "nastran"}
COLLAPSED = {"hexahedron": [*range(8)], "wedge": [0, 1, 2, 2, 3, 4, 5, 5], "pyramid": [0, 1, 2, 3, 4, 4, 4, 4]}
"""Corners of hexahedra with the same volume."""
THICKNESS = 2e-3
"""Of shells, m."""
SAME = 1e-6
"""Relative error of masses and frequencies."""


def trial(seed: int) -> Verdict:
    """One body made from the seed, and what came of it."""
    random = np.random.default_rng(seed)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        body, judge = (_of_text, _of_mesh, _of_arrays, _of_matrix_market, _of_shells, _of_curved_shells, _of_both)[
            int(random.integers(7))
        ](folder, random)
        try:
            return judge(reduced_body(body, folder))
        except StiffmbsError as error:
            return told(str(error))
        except Exception as error:  # whatever it is, no user should have seen it
            return Verdict(Outcome.WRONG, detail=f"{type(error).__name__}: {str(error)[:200]}")


def _mesh_body(name):
    return FlexibleBody(mesh=name, units=Units(length=1e-3), material=STEEL, interfaces=ENDS, modes=2)


def _of_text(folder, random):
    """A mesh file with changes of its text."""
    suffix = str(random.choice(list(FORMATS)))
    path = folder / f"bar.{suffix}"
    options = {"binary": False} if suffix in ("msh", "vtk") else {}
    meshio.write(path, mesh_of_bar("tetra", along=3, across=1), FORMATS[suffix], **options)
    path.write_text(changed_text(path.read_text(), random))
    return _mesh_body(path.name), lambda found: _of_volume(found, path)


def changed_text(text, random):
    """Return a text with one of the usual kinds of damage."""
    lines = text.split("\n")
    k = int(random.integers(len(lines)))
    match random.integers(7):
        case 0:
            return "\n".join(lines[:k])
        case 1:
            del lines[k]
        case 2:
            lines.insert(k, lines[int(random.integers(len(lines)))])
        case 3:
            lines[k] = lines[k].replace("1", "nan", 1)
        case 4:
            words = lines[k].split()
            random.shuffle(words)
            lines[k] = " ".join(words)
        case 5:
            place = int(random.integers(max(1, len(text))))
            return text[:place] + chr(int(random.integers(32, 127))) + text[place + 1 :]
        case _:
            lines[k] = lines[k].replace("0", "9", 1)
    return "\n".join(lines)


def _of_mesh(folder, random):
    """A mesh with changed nodes or elements."""
    mesh = mesh_of_bar(str(random.choice(["tetra", "hexahedron", "tetra10", "wedge", "pyramid"])), along=3, across=1)
    points, cells = mesh.points.copy(), mesh.cells[0].data.copy()
    k, n = int(random.integers(len(cells))), int(random.integers(len(points)))
    match random.integers(8):
        case 0:
            cells[k, [0, 1]] = cells[k, [1, 0]]  # inverted
        case 1:
            points[n] = points[(n + 1) % len(points)]
        case 2:
            points[n] = np.nan
        case 3:
            cells = np.vstack([cells, cells[k]])
        case 4:
            cells = np.delete(cells, k, axis=0)
        case 5:
            points, cells = np.vstack([points, points + 1e4]), np.vstack([cells, cells + len(points)])  # loose part
        case 6:
            cells = cells[::-1]
        case _:
            points[n] *= random.choice([0, -1, 1e9])
    meshio.Mesh(points, [(mesh.cells[0].type, cells)]).write(folder / "bar.vtu")
    return _mesh_body("bar.vtu"), lambda found: _of_volume(found, folder / "bar.vtu")


def _of_volume(found: ReducedBody, path: Path) -> Verdict:
    """Compare the mass with the volume of the elements, by the shape functions of their corners."""
    mesh = meshio.read(*for_reader(path))
    volume = 0.0
    for block in mesh.cells:
        corners = mesh.points[block.data]
        if block.type == "tetra":
            volume += (np.linalg.det(corners[:, 1:4] - corners[:, :1]) / 6).sum()
        elif block.type == "tetra10":
            volume += _curved_tetrahedra(corners)
        elif block.type in COLLAPSED:
            volume += _hexahedra(corners[:, COLLAPSED[block.type]])
    return _judged(found, 1e-9 * STEEL.density * volume, 0.0)


def _curved_tetrahedra(nodes):
    """Return the volume of tetrahedra of 10 nodes by Gauss-Jacobi points: the determinant is a cubic polynomial."""
    rules = [roots_jacobi(3, power, 0) for power in (2, 1, 0)]
    total = 0.0
    for (a, u), (b, v), (c, w) in product(*(list(zip(*rule, strict=True)) for rule in rules)):
        x = (1 + a) / 2
        y = (1 + b) / 2 * (1 - x)
        z = (1 + c) / 2 * (1 - x - y)
        L, dL = np.array([1 - x - y - z, x, y, z]), np.vstack([-np.ones(3), np.eye(3)])
        edges = [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]
        slopes = np.vstack([(4 * L - 1)[:, None] * dL, *(4 * (L[i] * dL[j] + L[j] * dL[i]) for i, j in edges)])
        total += u * v * w / 64 * np.linalg.det(np.einsum("eni,na->eia", nodes, slopes)).sum()
    return total


def _hexahedra(corners):
    """Return the volume of trilinear hexahedra by 2 x 2 x 2 points of Gauss."""
    signs = np.array(
        [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]]
    )
    total = 0.0
    for x in signs / np.sqrt(3):
        factors = 1 + signs * x
        slopes = np.stack([signs[:, a] * np.delete(factors, a, 1).prod(axis=1) / 8 for a in range(3)], axis=1)
        total += np.linalg.det(np.einsum("eni,na->eia", corners, slopes)).sum()
    return total


def _of_shells(folder, random):
    """A mesh of shells with changes of its text."""
    suffix, kind = str(random.choice(list(FORMATS))), str(random.choice(["quad", "triangle"]))
    path = folder / f"plate.{suffix}"
    options = {"binary": False} if suffix in ("msh", "vtk") else {}
    nodes, cells, _ = surface(4, 2, lambda a, b: (400 * a, 100 * b, 20 * a * b), kind)
    meshio.write(path, meshio.Mesh(nodes, list(cells.items())), FORMATS[suffix], **options)
    path.write_text(changed_text(path.read_text(), random))
    ends = {"a": InterfaceOfNodes(nodes=(0,)), "b": InterfaceOfNodes(nodes=(7,), type="point")}
    body = FlexibleBody(
        mesh=path.name, units=Units(length=1e-3), material=STEEL, thickness=THICKNESS, interfaces=ends, modes=2
    )
    return body, lambda found: _of_area(found, path)


def _of_curved_shells(folder, random):
    """A mesh of shells of second order with changes of its text."""
    suffix, kind = str(random.choice(["inp", "vtk", "bdf"])), str(random.choice(["quad8", "triangle6"]))
    path, linear = folder / f"plate.{suffix}", kind.rstrip("0123456789")
    nodes, cells, _ = surface(3, 2, lambda a, b: (400 * a, 100 * b, 20 * a * b), linear)
    mesh = with_middles(nodes, linear, cells[linear], kind)
    meshio.write(path, mesh, FORMATS[suffix], **({"binary": False} if suffix == "vtk" else {}))
    path.write_text(changed_text(path.read_text(), random))
    ends = {"a": InterfaceOfNodes(nodes=(0,)), "b": InterfaceOfNodes(nodes=(7,), type="point")}
    body = FlexibleBody(
        mesh=path.name, units=Units(length=1e-3), material=STEEL, thickness=THICKNESS, interfaces=ends, modes=2
    )
    return body, lambda found: _of_area(found, path)


def _of_both(folder, random):
    """A mesh of bricks with a skin, as bulk data of Nastran with changes of its text."""
    path, bricks = folder / "both.bdf", mesh_of_bar("hexahedron", along=3, across=1)
    nodes, cells = bricks.points, bricks.cells[0].data
    skin = cells[:, [4, 5, 6, 7]]
    properties = {"nastran:ref": [np.ones(len(cells), dtype=int), np.full(len(skin), 2)]}
    meshio.write(path, meshio.Mesh(nodes, [("hexahedron", cells), ("quad", skin)], cell_data=properties), "nastran")
    path.write_text(changed_text(path.read_text(), random))
    body = FlexibleBody(
        mesh=path.name, units=Units(length=1e-3), material=STEEL, thicknesses={"PSHELL 2": THICKNESS}, interfaces=ENDS, modes=2
    )  # fmt: skip
    return body, lambda found: _of_skinned(found, path)


def _of_skinned(found: ReducedBody, path: Path) -> Verdict:
    """Compare the mass with the volume of bricks and the area of quadrilaterals of property 2."""
    mesh = meshio.read(*for_reader(path))
    mass = 0.0
    for block, tags in zip(mesh.cells, mesh.cell_data["nastran:ref"], strict=True):
        if block.type == "hexahedron":
            mass += 1e-9 * STEEL.density * _hexahedra(mesh.points[block.data])
        elif block.type == "quad":
            mass += 1e-6 * STEEL.density * THICKNESS * _area(mesh.points, block.data[tags == 2], HALVES["quad"])
    return _judged(found, mass, 0.0)


def _area(points, cells, halves):
    """Return the area of triangles of elements; with four of them for each part, these are along both diagonals."""
    sides = ((points[cells[:, k]] for k in corners) for corners in halves)
    return sum(
        np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2 * halves[corners]
        for corners, (a, b, c) in zip(halves, sides, strict=True)
    )


BOTH_DIAGONALS = dict.fromkeys([(0, 1, 2), (0, 2, 3), (0, 1, 3), (1, 2, 3)], 0.5)
HALVES = {
    "triangle": {(0, 1, 2): 1.0}, "quad": BOTH_DIAGONALS,
    "triangle6": dict.fromkeys([(0, 3, 5), (1, 3, 4), (2, 4, 5), (3, 4, 5)], 1.0),
    "quad8": dict.fromkeys([(0, 4, 7), (1, 4, 5), (2, 5, 6), (3, 6, 7)], 1.0)
    | dict.fromkeys([(4, 5, 6), (4, 6, 7), (4, 5, 7), (5, 6, 7)], 0.5),
}  # fmt: skip
"""Triangles of an element by their corners, with the share of their areas."""


def _of_area(found: ReducedBody, path: Path) -> Verdict:
    """Compare the mass with the area of the triangles; of quadrilaterals, the mean of those along both diagonals."""
    mesh = meshio.read(*for_reader(path))
    area = 0.0
    for block in mesh.cells:
        if block.type in HALVES:
            area += _area(mesh.points, block.data, HALVES[block.type])
    return _judged(found, area * 1e-6 * THICKNESS * STEEL.density, 0.0)


def _of_arrays(folder, random):
    """A NumPy archive with changed arrays."""
    model = bar(folder, "tetra", along=3, across=1)
    found = {"nodes": model.nodes, "K": model.stiffness.toarray(), "M": model.mass.toarray()}
    name = str(random.choice(list(found)))
    array = found[name]
    match random.integers(9):
        case 0:
            array.flat[int(random.integers(array.size))] = np.nan
        case 1:
            array.flat[int(random.integers(array.size))] *= -1e3
        case 2:
            found[name] = array[:-1]
        case 3:
            found[name] = array * 0
        case 4:
            found[name] = -array
        case 5:
            del found[name]
        case 6:
            found[name] = array.astype(complex)
        case 7:
            found[name] = np.array(["x"])
        case _:
            found[name] = array + 10.0 ** random.integers(-12, -2) * np.abs(array).max() * random.standard_normal(
                array.shape
            )
    np.savez(folder / "bar.npz", **found)
    body = FlexibleBody(matrices="bar.npz", units=Units(length=1.0), interfaces=ENDS, modes=2)
    return body, lambda reduced: _of_matrices(reduced, found["K"], found["M"])


def _of_matrix_market(folder, random):
    """Matrices as text with changes of one of the files."""
    model = bar(folder, "tetra", along=3, across=1)
    mmwrite(folder / "K.mtx", model.stiffness, precision=17)
    mmwrite(folder / "M.mtx", model.mass, precision=17)
    np.savetxt(folder / "nodes.csv", model.nodes, delimiter=",", fmt="%.17g")
    path = folder / str(random.choice(["K.mtx", "M.mtx", "nodes.csv"]))
    path.write_text(changed_text(path.read_text(), random))
    files = Matrices(stiffness="K.mtx", mass="M.mtx", nodes="nodes.csv")
    body = FlexibleBody(matrices=files, units=Units(length=1.0), interfaces=ENDS, modes=2)
    dense = [mmread(folder / f"{name}.mtx").toarray() for name in "KM"] if path.suffix == ".csv" else None
    return body, lambda found: _of_matrices(
        found, *(dense or (mmread(folder / f"{name}.mtx").toarray() for name in "KM"))
    )


def _of_matrices(found: ReducedBody, K: np.ndarray, M: np.ndarray) -> Verdict:
    """Compare with the sum of the mass matrix, and with the frequencies of the full matrices as lower bounds."""
    squares = eigh((K + K.T) / 2, (M + M.T) / 2, eigvals_only=True)
    return _judged(found, float(M[::3, ::3].sum()), np.sqrt(squares[6]) / (2 * np.pi))


def _judged(found: ReducedBody, mass: float, lowest: float) -> Verdict:
    finite = np.isfinite(found.modes).all() and np.isfinite(found.frequencies).all()
    error = abs(found.mass - mass) / mass
    if not finite or error > SAME or found.frequencies[0] < lowest * (1 - SAME):
        detail = f"{found.mass:.6g} kg for {mass:.6g} kg, {found.frequencies[0]:.6g} Hz for at least {lowest:.6g} Hz"
        return Verdict(Outcome.WRONG, float(error), SAME, detail)
    return Verdict(Outcome.RIGHT, float(error), SAME)
