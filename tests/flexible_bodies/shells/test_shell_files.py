"""Meshes of shells in files: formats, groups with materials and thicknesses, and what is refused."""

import meshio
import numpy as np
import pytest

from stiffmbs.errors import InputError
from stiffmbs.flexible_bodies.areas import nodal_areas
from stiffmbs.flexible_bodies.description import FlexibleBody, Material
from stiffmbs.flexible_bodies.mesh import from_mesh
from stiffmbs.flexible_bodies.reduction import reduce, rigid_body

from ..bars import STEEL, mesh_of_bar
from .meshes import surface

SOFT = Material(E=1e9, nu=0.0, density=1200.0)
BOTH, THICKNESSES = {"left": STEEL, "right": SOFT}, {"left": 2e-3, "right": 5e-3}
UNITS = {"length": "1 mm"}


def plate(kind="quad"):
    """Return the nodes and elements of a plate of 400 mm x 100 mm; a number for each element: 1 on the left, 2 on the right."""
    nodes, cells, grid = surface(8, 2, lambda a, b: (400 * a, 100 * b, 0), "triangle" if kind == "triangle" else "quad")
    if kind == "both":
        quads = cells["quad"]
        cells = {"quad": quads[4:], "triangle": np.vstack([quads[:4, :3], quads[:4, [0, 2, 3]]])}
    tags = {name: 1 + (nodes[own][:, :, 0].mean(axis=1) > 200) for name, own in cells.items()}
    return nodes, cells, tags, grid


def _gmsh(path, nodes, cells, tags):
    named = {"left": np.array([1, 2]), "right": np.array([2, 2]), "root": np.array([3, 1])}
    root = np.flatnonzero(nodes[:, 0] == 0)
    data = [*tags.values(), np.array([3, 3])]
    meshio.Mesh(
        nodes, [*cells.items(), ("line", np.column_stack([root[:-1], root[1:]]))], field_data=named,
        cell_data={"gmsh:physical": data, "gmsh:geometrical": data},
    ).write(path, file_format="gmsh22", binary=False)  # fmt: skip


def _abaqus(path, nodes, cells, tags):
    sets = {name: [np.flatnonzero(own == k) for own in tags.values()] for k, name in ((1, "left"), (2, "right"))}
    meshio.Mesh(nodes, list(cells.items()), cell_sets=sets).write(path)


def _nastran(path, nodes, cells, tags):
    meshio.Mesh(nodes, list(cells.items()), cell_data={"nastran:ref": list(tags.values())}).write(path)


FILES = {
    "plate.msh": (_gmsh, "left", "right"), "plate.inp": (_abaqus, "left", "right"),
    "plate.bdf": (_nastran, "PSHELL 1", "PSHELL 2"),
}  # fmt: skip


@pytest.mark.parametrize("kind", ["quad", "triangle", "both"])
@pytest.mark.parametrize("name", FILES)
def test_groups_have_their_materials_and_thicknesses(tmp_path, name, kind):
    """Two halves are springs in series; mass and inertia are those of two blocks."""
    write, left, right = FILES[name]
    nodes, cells, tags, _ = plate(kind)
    write(tmp_path / name, nodes, cells, tags)
    model = from_mesh(tmp_path / name, 1e-3, {left: STEEL, right: SOFT}, thickness={left: 2e-3, right: 5e-3})
    model.check()
    mass, centre, inertia = rigid_body(model)
    parts = np.array([2e-3 * STEEL.density, 5e-3 * SOFT.density]) * 0.2 * 0.1
    assert mass == pytest.approx(parts.sum(), rel=1e-9)
    assert centre[0] == pytest.approx(parts @ [0.1, 0.3] / mass, rel=1e-9)
    assert inertia[0, 0] == pytest.approx(parts @ (0.1**2 + np.array([2e-3, 5e-3]) ** 2) / 12, rel=1e-9)
    one = from_mesh(tmp_path / name, 1e-3, {left: SOFT, right: SOFT}, thickness={left: 2e-3, right: 5e-3})
    x, pulled = one.nodes[:, 0], np.zeros((len(one.nodes), 6))
    pulled[:, 0] = np.minimum(x, 0.2) / (SOFT.E * 2e-3) + np.maximum(x - 0.2, 0) / (SOFT.E * 5e-3)  # of 1 N/m
    force = (one.stiffness @ pulled.ravel()).reshape(-1, 6)
    np.testing.assert_allclose(force[x > 0.4 - 1e-9].sum(axis=0)[:3], [0.1, 0, 0], atol=1e-9)
    np.testing.assert_allclose(force[(x > 1e-9) & (x < 0.4 - 1e-9)], 0.0, atol=1e-9)


def body(**changes):
    described = {
        "mesh": "plate.vtu", "units": UNITS, "material": STEEL.model_dump(), "thickness": "2 mm", "modes": 2,
        "stiffening": False,
    }  # fmt: skip
    return FlexibleBody.model_validate({**described, **changes})


def test_a_curve_is_a_group_of_nodes(tmp_path):
    nodes, cells, tags, _ = plate()
    _gmsh(tmp_path / "plate.msh", nodes, cells, tags)
    described = body(mesh="plate.msh", interfaces={"root": {"group": "root"}})
    model = described.model(tmp_path)
    (root,) = described.interfaces_on(model)
    assert len(root.nodes) == 3
    assert reduce(model, [root], 2).fixed_frequencies[0] > 1


@pytest.mark.parametrize("kind", ["quad", "triangle", "both"])
def test_weights_are_areas_of_the_shells_between_the_nodes(tmp_path, kind):
    nodes, cells, _, grid = plate(kind)
    meshio.Mesh(nodes, list(cells.items())).write(tmp_path / "plate.vtu")
    model = body().model(tmp_path)
    inside = grid[4:].ravel()
    areas = nodal_areas(model, inside)
    assert areas.sum() == pytest.approx(0.2 * 0.1)
    assert areas @ model.nodes[inside, 0] == pytest.approx(0.2 * 0.1 * 0.3)
    assert nodal_areas(model, grid[0]).sum() == 0


def test_solids_with_surfaces_are_read_as_before(tmp_path):
    bricks = mesh_of_bar("hexahedron", 3, 2)
    faces = ("quad", bricks.cells[0].data[:, :4])
    meshio.Mesh(bricks.points, [bricks.cells[0], faces]).write(tmp_path / "both.vtu")
    meshio.Mesh(bricks.points, [bricks.cells[0]]).write(tmp_path / "bricks.vtu")
    expected, found = (from_mesh(tmp_path / name, 1e-3, STEEL) for name in ("bricks.vtu", "both.vtu"))
    assert (expected.stiffness != found.stiffness).nnz == 0 and found.components == 3
    with pytest.raises(
        InputError, match=r"found one thickness for a mesh with solids \(hexahedron\), expected 'thicknesses' by groups"
    ):
        from_mesh(tmp_path / "both.vtu", 1e-3, STEEL, thickness=2e-3)
    with pytest.raises(InputError, match="found a thickness of shells for a mesh of solids alone"):
        from_mesh(tmp_path / "bricks.vtu", 1e-3, STEEL, thickness=2e-3)


def _refused(tmp_path, cells, nodes=None, **changes):
    meshio.Mesh(plate()[0] if nodes is None else nodes, cells).write(tmp_path / "plate.vtu")
    with pytest.raises(InputError) as error:
        body(**changes).model(tmp_path)
    return str(error.value)


def test_elements_that_are_no_shells_are_refused_in_a_sentence(tmp_path):
    nodes, cells, _, _ = plate()
    quads = cells["quad"]
    turned, folded = quads.copy(), nodes.copy()
    turned[3] = turned[3][[0, 2, 1, 3]]
    folded[quads[0, 0], 2] = 60
    collapsed = nodes.copy()
    collapsed[quads[0, 0]] = nodes[quads[0, 1]]
    cases = {
        "found surfaces (quad) without a thickness, expected solids, or 'thickness' for shells": ([("quad", quads)], nodes, {"thickness": None}),
        "found 1 shells without an area, the first with nodes": ([("quad", quads)], collapsed, {}),
        "found 1 concave or crossed quadrilaterals, the first with nodes": ([("quad", turned)], nodes, {}),
        "found 1 warped quadrilaterals, the first with nodes": ([("quad", quads)], folded, {}),
        "found 2 elements between the same nodes as others": ([("quad", quads), ("triangle", quads[:2, :3]), ("triangle", quads[:2, 2::-1])], nodes, {}),
        "found 1 triangles on quadrilaterals, the first with nodes": ([("quad", quads), ("triangle", quads[1:2, [3, 0, 1]])], nodes, {}),
        "found 2 parts of shells that are not connected by edges": ([("quad", quads[[0, 3]])], nodes, {}),
        "found elements of the types line, expected shells of the types triangle, quad, triangle6, quad8, quad9": ([("line", quads[:, :2])], nodes, {}),
        "thicknesses.lid: found no group of shell elements 'lid', expected one of the file (none)": ([("quad", quads)], nodes, {"thickness": None, "thicknesses": {"lid": 1e-3}}),
    }  # fmt: skip
    for expected, (own, points, changes) in cases.items():
        assert expected in _refused(tmp_path, own, points, **changes)


@pytest.mark.parametrize("given", [0, "-2 mm", "2 kg"])
def test_a_thickness_is_a_length_above_zero(given):
    with pytest.raises(ValueError, match="expected a length"):
        body(thickness=given)


def test_a_group_without_a_thickness_is_refused(tmp_path):
    nodes, cells, tags, _ = plate()
    _gmsh(tmp_path / "plate.msh", nodes, cells, tags)
    with pytest.raises(InputError, match="thicknesses: found 8 elements in none of the groups left"):
        from_mesh(tmp_path / "plate.msh", 1e-3, STEEL, thickness={"left": 2e-3})


def test_thickness_and_thicknesses_or_matrices_are_refused():
    with pytest.raises(ValueError, match="found thickness and thicknesses, expected one of them"):
        body(thicknesses={"left": 1e-3})
    with pytest.raises(ValueError, match="found a thickness with matrices, expected a mesh"):
        body(mesh=None, material=None, matrices="a.npz")


def test_a_mean_of_nodes_on_a_line_needs_a_rigid_interface(tmp_path):
    nodes, cells, _, _ = plate()
    meshio.Mesh(nodes, list(cells.items())).write(tmp_path / "plate.vtu")
    described = body(interfaces={"a": {"nodes": [0, 1, 2], "type": "average"}})
    model = described.model(tmp_path)
    with pytest.raises(InputError, match=r"found 3 nodes on one line, expected .* or type: rigid"):
        reduce(model, described.interfaces_on(model), 2)


CARDS = """GRID,1,,0.,0.,0.
GRID,2,,1.,0.,0.
GRID,3,,1.,1.,0.
GRID,4,,0.,1.,0.
GRID,5,,2.,1.,0.
{quad}
CTRIA3         2       2       2       5       3    45.0
PSHELL,1,1,0.1
ENDDATA
"""


def test_angles_of_nastran_are_no_nodes_and_offsets_are_refused(tmp_path):
    path = tmp_path / "plate.bdf"
    for quad in (
        "CQUAD4,1,1,1,2,3,4,0.0,0.0",
        "CQUAD4         1       1       1       2       3       4       7",
        "CQUAD4,1,1,1,2,3,4,,,+\n+,,",
    ):
        path.write_text(CARDS.format(quad=quad))
        model = from_mesh(path, 1.0, STEEL, thickness=0.1)
        assert {kind: own.shape for kind, own in model.cells.items()} == {"quad": (1, 4), "triangle": (1, 3)}
    for quad, message in (
        ("CQUAD4,1,1,1,2,3,4,0.0,0.5", "found CQUAD4 1 with an offset of 0.5, expected nodes in the middle surface"),
        ("CQUAD4,1,1,1,2,3,4,,,+\n+,,.1,.1,.2,.2", "found CQUAD4 1 with thicknesses at its nodes"),
    ):  # fmt: skip
        path.write_text(CARDS.format(quad=quad))
        with pytest.raises(InputError, match=message):
            from_mesh(path, 1.0, STEEL, thickness=0.1)


def test_offsets_of_abaqus_are_refused(tmp_path):
    nodes, cells, tags, _ = plate()
    path = tmp_path / "plate.inp"
    _abaqus(path, nodes, cells, tags)
    text = path.read_text()
    for offset in ("0.5", "SPOS"):
        path.write_text(f"{text}*SHELL SECTION, ELSET=left, MATERIAL=STEEL, OFFSET={offset}\n2.0\n")
        with pytest.raises(
            InputError, match="expected shells whose nodes are in the middle surface, without an offset"
        ):
            from_mesh(path, 1e-3, STEEL, thickness=2e-3)
    path.write_text(
        f"{text}*SHELL SECTION, ELSET=left, MATERIAL=STEEL, OFFSET=0.0\n2.0\n*SHELL SECTION, ELSET=right, MATERIAL=FOAM\n2.0\n"
    )
    assert from_mesh(path, 1e-3, STEEL, thickness=2e-3).parts == "STEEL and FOAM"
