"""Several materials of a mesh: stiffness, mass and stress of each part, and what files without them are told."""

import meshio
import numpy as np
import pytest

from stiffmbs.errors import InputError
from stiffmbs.flexible_bodies.description import FlexibleBody, Material
from stiffmbs.flexible_bodies.mesh import from_mesh
from stiffmbs.flexible_bodies.reduced import reduced_body
from stiffmbs.flexible_bodies.reduction import rigid_body
from stiffmbs.flexible_bodies.stress import stress_points

from .bars import HEIGHT, LENGTH, STEEL, WIDTH, mesh_of_bar

STIFF, SOFT = Material(E=2e11, nu=0.0, density=8000.0), Material(E=1e9, nu=0.0, density=1200.0)
BOTH = {"left": STIFF, "right": SOFT}


def _halves(mesh):
    (block,) = mesh.cells
    middle = mesh.points[block.data][:, :, 0].mean(axis=1)
    left = np.flatnonzero(middle < 500 * LENGTH)
    return left, np.setdiff1d(np.arange(len(block.data)), left)


def _as_gmsh(mesh, path):
    left, right = _halves(mesh)
    tags = np.ones(len(left) + len(right), dtype=int)
    tags[right] = 2
    named = {"left": np.array([1, 3]), "right": np.array([2, 3])}
    data = {"gmsh:physical": [tags], "gmsh:geometrical": [tags]}
    meshio.Mesh(mesh.points, mesh.cells, cell_data=data, field_data=named).write(
        path, file_format="gmsh22", binary=False
    )


def _as_abaqus(mesh, path):
    left, right = _halves(mesh)
    meshio.Mesh(mesh.points, mesh.cells, cell_sets={"left": [left], "right": [right]}).write(path)


def _as_nastran(mesh, path):
    left, right = _halves(mesh)
    tags = np.ones(len(left) + len(right), dtype=int)
    tags[right] = 2
    meshio.Mesh(mesh.points, mesh.cells, cell_data={"nastran:ref": [tags]}).write(path)


FILES = {
    "bar.msh": (_as_gmsh, BOTH),
    "bar.inp": (_as_abaqus, BOTH),
    "bar.bdf": (_as_nastran, {"PSOLID 1": STIFF, "PSOLID 2": SOFT}),
}


@pytest.mark.parametrize("name", FILES)
def test_two_halves_of_a_bar_are_springs_in_series(tmp_path, name):
    write, materials = FILES[name]
    write(mesh_of_bar("hexahedron"), tmp_path / name)
    model = from_mesh(tmp_path / name, 1e-3, materials)
    model.check()
    x, area, half = model.nodes[:, 0], WIDTH * HEIGHT, LENGTH / 2
    pulled = np.repeat(np.minimum(x, half) / STIFF.E + np.maximum(x - half, 0.0) / SOFT.E, 3) * np.tile(
        [1.0, 0.0, 0.0], len(x)
    )
    force = (model.stiffness @ pulled).reshape(-1, 3)  # of a stress of 1 N/m^2
    np.testing.assert_allclose(force[x > LENGTH - 1e-9].sum(axis=0), [area, 0, 0], atol=1e-9 * area)
    np.testing.assert_allclose(force[(x > 1e-9) & (x < LENGTH - 1e-9)], 0.0, atol=1e-9 * area)
    mass, centre, _ = rigid_body(model)
    parts = np.array([STIFF.density, SOFT.density]) * area * half
    assert mass == pytest.approx(parts.sum(), rel=1e-6)
    assert centre[0] == pytest.approx(parts @ [half / 2, 1.5 * half] / parts.sum(), rel=1e-6)
    np.testing.assert_allclose(stress_points(model).stresses(pulled[:, None])[0, :, 0], 1.0, rtol=1e-9)


def test_a_stress_between_materials_is_that_of_the_stiffest(tmp_path):
    _as_gmsh(mesh_of_bar("hexahedron"), tmp_path / "bar.msh")
    model = from_mesh(tmp_path / "bar.msh", 1e-3, BOTH)
    stretched = (model.nodes * [1.0, 0.0, 0.0]).ravel()
    stress = stress_points(model).stresses(stretched[:, None])[0, :, 0]
    np.testing.assert_allclose(stress, np.where(model.nodes[:, 0] < LENGTH / 2 + 1e-9, STIFF.E, SOFT.E), rtol=1e-9)


def test_materials_of_the_same_values_are_one_material(tmp_path):
    _as_gmsh(mesh_of_bar("tetra10"), tmp_path / "bar.msh")
    units = {"length": "1 mm"}
    one = {"E": STEEL.E, "nu": STEEL.nu, "density": STEEL.density}
    bodies = ({"material": one}, {"materials": {"left": one, "right": one}})
    found = [
        reduced_body(FlexibleBody.model_validate({"mesh": "bar.msh", "units": units, "modes": 3, **body}), tmp_path)
        for body in bodies
    ]
    np.testing.assert_array_equal(found[0].frequencies, found[1].frequencies)
    assert found[0].mass == found[1].mass


def test_frequencies_follow_the_values_of_all_materials(tmp_path):
    _as_gmsh(mesh_of_bar("tetra10"), tmp_path / "bar.msh")
    found = []
    for factor in (1.0, 4.0):
        materials = {
            name: {"E": factor * each.E, "nu": each.nu, "density": each.density} for name, each in BOTH.items()
        }
        body = {"mesh": "bar.msh", "units": {"length": "1 mm"}, "modes": 3, "materials": materials}
        found.append(reduced_body(FlexibleBody.model_validate(body), tmp_path).frequencies)
    np.testing.assert_allclose(found[1], 2 * found[0], rtol=1e-12)


@pytest.mark.parametrize(
    ("materials", "message"),
    [
        (
            {"left": STIFF, "rigth": SOFT},
            r"materials.rigth: found no group of solid elements 'rigth' \(did you mean 'right'\?\), expected",
        ),
        ({"left": STIFF}, "materials: found 16 elements in none of the groups left, the first with nodes"),
    ],
)
def test_each_element_has_one_material(tmp_path, materials, message):
    _as_gmsh(mesh_of_bar("hexahedron"), tmp_path / "bar.msh")
    with pytest.raises(InputError, match=message):
        from_mesh(tmp_path / "bar.msh", 1e-3, materials)


def test_elements_of_two_groups_are_refused(tmp_path):
    mesh = mesh_of_bar("hexahedron")
    left, right = _halves(mesh)
    meshio.Mesh(mesh.points, mesh.cells, cell_sets={"left": [left], "right": [np.append(right, 0)]}).write(
        tmp_path / "bar.inp"
    )
    with pytest.raises(InputError, match="found 1 elements of the group right in another group as well"):
        from_mesh(tmp_path / "bar.inp", 1e-3, BOTH)


@pytest.mark.parametrize("name", FILES)
def test_one_material_of_a_file_with_several_is_told(tmp_path, name):
    write, _ = FILES[name]
    path = tmp_path / name
    write(mesh_of_bar("hexahedron"), path)
    sections = {
        "bar.inp": "*SOLID SECTION, ELSET=left, MATERIAL=steel\n1.,\n*Solid Section, elset=right, material=rubber\n",
        "bar.bdf": "PSOLID,1,7\nPSOLID         2       8\n",
    }
    text = path.read_text()
    ended = (
        text.replace("ENDDATA", sections.get(name, "") + "ENDDATA")
        if name == "bar.bdf"
        else text + sections.get(name, "")
    )
    path.write_text(ended)
    body = {"mesh": name, "units": {"length": "1 mm"}, "modes": 3, "material": {"E": 1e9, "nu": 0.3, "density": 1e3}}
    told = {"bar.msh": "left and right", "bar.inp": "STEEL and RUBBER", "bar.bdf": "MAT 7 and MAT 8"}[name]
    assert any(
        f"tells apart {told}" in note for note in reduced_body(FlexibleBody.model_validate(body), tmp_path).notes
    )


def test_a_description_has_material_or_materials():
    body = {"mesh": "bar.msh", "units": {"length": "1 mm"}, "material": STEEL, "materials": BOTH}
    with pytest.raises(
        ValueError, match="found material and materials, expected E, nu and density for a mesh, in one of them"
    ):
        FlexibleBody.model_validate(body)
