"""Mutated meshes and matrices are refused with one sentence, or give a finite body: no traceback."""

import meshio
import numpy as np
import pytest

from stiffmbs.errors import InputError
from stiffmbs.flexible_bodies.description import FlexibleBody, InterfaceOfNodes, Material, Units
from stiffmbs.flexible_bodies.reduced import reduced_body

from .bars import bar, mesh_of_bar

STEEL = Material(E=2.1e11, nu=0.3, density=7850)
ENDS = {
    "a": InterfaceOfNodes(plane={"point": [0, 0, 0], "normal": [1, 0, 0]}),
    "b": InterfaceOfNodes(plane={"point": [0.4, 0, 0], "normal": [1, 0, 0]}, type="average"),
}
FORMATS = {"msh": "gmsh", "inp": "abaqus", "vtk": "vtk", "bdf": "nastran"}


def outcome(body, folder):
    """Return the message of a refused body, or None for a finite one."""
    try:
        found = reduced_body(body, folder)
    except InputError as error:
        message = str(error)
        assert message and "\n" not in message and len(message) < 600
        return message
    assert found.mass > 0 and np.isfinite(found.modes).all() and np.isfinite(found.frequencies).all()
    return None


def _changed_text(text, random):
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


@pytest.mark.long
@pytest.mark.parametrize("suffix", FORMATS)
def test_damaged_mesh_files(tmp_path, suffix):
    path = tmp_path / f"bar.{suffix}"
    options = {"binary": False} if suffix in ("msh", "vtk") else {}
    meshio.write(path, mesh_of_bar("tetra", along=3, across=1), FORMATS[suffix], **options)
    text, random = path.read_text(), np.random.default_rng(len(suffix))
    body = FlexibleBody(mesh=path.name, units=Units(length=1e-3), material=STEEL, interfaces=ENDS, modes=2)
    assert outcome(body, tmp_path) is None
    for _ in range(25):
        path.write_text(_changed_text(text, random))
        outcome(body, tmp_path)


def _changed_mesh(mesh, random):
    points, cells = mesh.points.copy(), mesh.cells[0].data.copy()
    k, n = int(random.integers(len(cells))), int(random.integers(len(points)))
    match random.integers(7):
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
        case _:
            points[n] *= random.choice([0, -1, 1e9])
    return meshio.Mesh(points, [(mesh.cells[0].type, cells)])


@pytest.mark.long
@pytest.mark.parametrize("kind", ["tetra", "hexahedron"])
def test_damaged_meshes(tmp_path, kind):
    mesh, random = mesh_of_bar(kind, along=3, across=1), np.random.default_rng(1)
    body = FlexibleBody(mesh="bar.vtu", units=Units(length=1e-3), material=STEEL, interfaces=ENDS, modes=2)
    for _ in range(25):
        _changed_mesh(mesh, random).write(tmp_path / "bar.vtu")
        outcome(body, tmp_path)


def _changed_arrays(arrays, random):
    found = {name: array.copy() for name, array in arrays.items()}
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
            found[name] = array + 1e-3 * np.abs(array).max() * random.standard_normal(array.shape)
    return found


@pytest.mark.long
def test_damaged_matrices(tmp_path):
    model, random = bar(tmp_path, "tetra", along=3, across=1), np.random.default_rng(2)
    arrays = {"nodes": model.nodes, "K": model.stiffness.toarray(), "M": model.mass.toarray()}
    body = FlexibleBody(matrices="bar.npz", units=Units(length=1.0), interfaces=ENDS, modes=2)
    refused = 0
    for _ in range(60):
        np.savez(tmp_path / "bar.npz", **_changed_arrays(arrays, random))
        refused += outcome(body, tmp_path) is not None
    assert refused > 40
