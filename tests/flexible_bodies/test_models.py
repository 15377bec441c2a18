"""Meshes and matrices give the mass and stiffness of the body; bad files are refused with one sentence."""

import io

import meshio
import numpy as np
import pytest

from stiffmbs.errors import InputError
from stiffmbs.flexible_bodies.finite_elements import FiniteElements
from stiffmbs.flexible_bodies.matrices import from_archive
from stiffmbs.flexible_bodies.mesh import from_mesh
from stiffmbs.flexible_bodies.reduction import rigid_body
from stiffmbs.flexible_bodies.shapes import ELEMENTS

from .bars import HEIGHT, LENGTH, MASS, NU, REFERENCES, STEEL, WIDTH, E, bar, mesh_of_bar


@pytest.mark.parametrize("kind", ELEMENTS)
def test_a_stretched_bar_has_the_energy_of_its_strain(tmp_path, kind):
    model = bar(tmp_path, kind)
    model.check()
    x, y, z = model.nodes.T
    strain = 1e-3
    displaced = np.column_stack([strain * x, -NU * strain * y, -NU * strain * z]).ravel()
    energy = displaced @ (model.stiffness @ displaced) / 2
    assert energy == pytest.approx(E * strain**2 / 2 * LENGTH * WIDTH * HEIGHT, rel=1e-9)
    mass, centre, _ = rigid_body(model)
    assert mass == pytest.approx(MASS, rel=1e-9)
    np.testing.assert_allclose(centre, [LENGTH / 2, WIDTH / 2, HEIGHT / 2], rtol=1e-9)


@pytest.mark.skipif(not (REFERENCES / "a_bar_hex20.npz").exists(), reason="without the reference data")
def test_hexahedra_of_20_nodes_have_the_matrices_of_the_reference(tmp_path):
    reference = from_archive((REFERENCES / "a_bar_hex20.npz").read_bytes(), 1.0, 1.0, 1.0)
    meshio.Mesh(reference.nodes, [("hexahedron20", reference.cells["hexahedron20"])]).write(tmp_path / "bar.vtu")
    model = from_mesh(tmp_path / "bar.vtu", 1.0, STEEL)
    for found, expected in ((model.stiffness, reference.stiffness), (model.mass, reference.mass)):
        assert np.abs((found - expected).data).max() < 1e-12 * np.abs(expected.data).max()


@pytest.mark.parametrize("suffix", [".msh", ".inp", ".bdf", ".vtk"])
def test_formats_of_meshes(tmp_path, suffix):
    path = tmp_path / f"bar{suffix}"
    mesh_of_bar("tetra10" if suffix != ".bdf" else "tetra").write(
        path, **({"file_format": "gmsh"} if suffix == ".msh" else {})
    )
    assert rigid_body(from_mesh(path, 1e-3, STEEL))[0] == pytest.approx(MASS, rel=1e-5)


def test_groups_of_nodes_and_of_elements(tmp_path):
    mesh = mesh_of_bar("hexahedron")
    ends = np.flatnonzero(mesh.points[:, 0] == 0)
    named = meshio.Mesh(mesh.points, mesh.cells, point_sets={"end": ends})
    named.write(tmp_path / "bar.inp")
    model = from_mesh(tmp_path / "bar.inp", 1e-3, STEEL)
    np.testing.assert_allclose(model.nodes[model.groups["end"], 0], 0.0)
    assert len(model.groups["end"]) == len(ends)


def test_nodes_without_an_element_are_left_out(tmp_path):
    mesh = mesh_of_bar("hexahedron")
    meshio.Mesh(np.vstack([mesh.points, [[9e3, 9e3, 9e3]]]), mesh.cells).write(tmp_path / "bar.vtu")
    assert len(from_mesh(tmp_path / "bar.vtu", 1e-3, STEEL).nodes) == len(mesh.points)


def _changed(model, **parts):
    return FiniteElements(**{"nodes": model.nodes, "stiffness": model.stiffness, "mass": model.mass, **parts})


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda m: {"nodes": m.nodes[:-1]}, "stiffness: found .* entries for .* nodes, expected"),
        (lambda m: {"stiffness": m.stiffness + _one(m, 0, 7, 1e9)}, "differ from those across the diagonal"),
        (lambda m: {"stiffness": m.stiffness + _one(m, 4, 4, 1e9)}, "the free body without supports"),
        (lambda m: {"stiffness": -m.stiffness}, "are its elements inverted"),
        (lambda m: {"stiffness": m.stiffness * np.nan}, "not finite"),
        (lambda m: {"mass": m.mass * 0}, "mass: found only zeros"),
        (lambda m: {"nodes": m.nodes * [1, 1, 1.1]}, "under a rigid rotation"),
    ],
)
def test_matrices_of_no_free_body_are_refused(tmp_path, change, message):
    model = bar(tmp_path, "hexahedron")
    with pytest.raises(InputError, match=message):
        _changed(model, **change(model)).check()


def _one(model, row, column, value):
    from scipy.sparse import csr_array

    return csr_array(([value], ([row], [column])), shape=model.stiffness.shape)


def test_a_mass_that_differs_by_direction_is_refused(tmp_path):
    model = bar(tmp_path, "hexahedron")
    along_x = np.where(np.arange(len(model.nodes) * 3) % 3 == 0, 2.0, 1.0)
    from scipy.sparse import diags_array

    scale = diags_array(np.sqrt(along_x))
    with pytest.raises(InputError, match="along x, y and z, expected one positive mass"):
        rigid_body(_changed(model, mass=scale @ model.mass @ scale))


def test_loose_parts_are_refused(tmp_path):
    mesh = mesh_of_bar("hexahedron")
    cells = mesh.cells_dict["hexahedron"]
    there = mesh.points + np.array([0, 100, 0])
    two = meshio.Mesh(np.vstack([mesh.points, there]), [("hexahedron", np.vstack([cells, cells + len(there)]))])
    two.write(tmp_path / "two.vtu")
    with pytest.raises(InputError, match="found 2 parts that are not connected"):
        from_mesh(tmp_path / "two.vtu", 1e-3, STEEL).check()


def test_inverted_elements_and_shells_are_refused(tmp_path):
    mesh = mesh_of_bar("hexahedron")
    points = mesh.points.copy()
    middle = np.argmin(np.abs(points - points.mean(axis=0)).sum(axis=1))
    points[middle, 0] += 200
    meshio.Mesh(points, mesh.cells).write(tmp_path / "bar.vtu")
    with pytest.raises(InputError, match="inverted or flat elements, the first with nodes"):
        from_mesh(tmp_path / "bar.vtu", 1e-3, STEEL)
    meshio.Mesh(mesh.points, [("quad", mesh.cells_dict["hexahedron"][:, :4])]).write(tmp_path / "shell.vtu")
    with pytest.raises(InputError, match=r"found surfaces \(quad\) without a thickness, expected solids, or"):
        from_mesh(tmp_path / "shell.vtu", 1e-3, STEEL)


@pytest.mark.parametrize("content", [b"", b"$MeshFormat\nnonsense", b"PK\x03\x04", b"*HEADING\n*NODE\n1, a\n"])
@pytest.mark.parametrize("suffix", [".msh", ".inp", ".vtu", ".xyz"])
def test_files_that_are_no_mesh_are_refused(tmp_path, suffix, content):
    path = tmp_path / f"part{suffix}"
    path.write_bytes(content)
    with pytest.raises(InputError, match="found"):
        from_mesh(path, 1e-3, STEEL)


@pytest.mark.long
def test_200_damaged_archives_are_refused_or_read(tmp_path):
    model = bar(tmp_path, "hexahedron", along=3, across=1)
    whole = {"nodes": model.nodes, "K": model.stiffness.toarray(), "M": model.mass.toarray(), "end": np.arange(4)}
    random = np.random.default_rng(3)
    for _ in range(100):
        arrays = {name: array.copy() for name, array in whole.items()}
        name = random.choice(list(arrays))
        match random.integers(5):
            case 0:
                del arrays[name]
            case 1:
                arrays[name] = arrays[name][: random.integers(len(arrays[name]))]
            case 2:
                arrays[name].flat[random.integers(arrays[name].size)] = -(10.0 ** random.integers(9))
            case 3:
                arrays[name] = arrays[name].astype(str)
            case 4:
                arrays[name] = arrays[name].ravel()
        out = io.BytesIO()
        np.savez(out, **arrays)
        _refused_or_read(out.getvalue())
    out = io.BytesIO()
    np.savez_compressed(out, **whole)
    for _ in range(100):
        content = bytearray(out.getvalue())
        content[random.integers(len(content))] ^= 1 << random.integers(8)
        _refused_or_read(bytes(content))


def _refused_or_read(content):
    try:
        model = from_archive(content, 1.0, 1.0, 1.0)
        model.check()
        rigid_body(model)
    except InputError as error:
        assert "found" in str(error)
        assert "\n" not in str(error)
