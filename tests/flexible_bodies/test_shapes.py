"""Kinds of solid elements: linear fields on distorted and mixed meshes, curved edges, and neighbours that do not fit together."""

import meshio
import numpy as np
import pytest

from stiffmbs.errors import InputError
from stiffmbs.flexible_bodies.mesh import from_mesh
from stiffmbs.flexible_bodies.reduction import rigid_body
from stiffmbs.flexible_bodies.shapes import ELEMENTS
from stiffmbs.flexible_bodies.stress import stress_points
from stiffmbs.show.drawing.deformed import surface

from .bars import HEIGHT, LENGTH, MASS, NU, STEEL, WIDTH, E, mesh_of_bar, split, with_middles

MIXED = "hexahedron, wedge and pyramid", "hexahedron20 and wedge15", "hexahedron27 and wedge18"


def _mixed(name, along=3, across=4):
    """Return a bar whose bricks are wedges on one side, and pyramids in one place on the other."""
    kinds = name.replace(" and", ",").split(", ")
    bricks = mesh_of_bar("hexahedron", along, across)
    cells, points = bricks.cells[0].data, bricks.points
    middle = points[cells].mean(axis=1)
    on_side = middle[:, 2] < 500 * HEIGHT  # the triangles of wedges are across y
    blocks, first = {"hexahedron": cells[~on_side], "wedge": split("wedge", points, cells[on_side])[1]}, cells[~on_side]
    if "pyramid" in kinds:
        points, blocks["pyramid"] = split("pyramid", points, first[:1])
        blocks["hexahedron"] = first[1:]
    parts = [with_middles(points, kind.rstrip("0123456789"), blocks[kind.rstrip("0123456789")], kind) for kind in kinds]
    return _joined(parts)


def _joined(parts):
    points = np.vstack([part.points for part in parts])
    _, first, place = np.unique(points.round(6), axis=0, return_index=True, return_inverse=True)
    starts = np.cumsum([0, *(len(part.points) for part in parts)])
    cells = [
        (part.cells[0].type, place.ravel()[part.cells[0].data + start])
        for part, start in zip(parts, starts, strict=False)
    ]
    return meshio.Mesh(points[first], cells)


def _bent(mesh):
    """Move all nodes but those of the surface: elements have curved edges and faces within the bar."""
    x, y, z = mesh.points.T / (1000 * np.array([[LENGTH], [WIDTH], [HEIGHT]]))
    bubble = np.prod([s * (1 - s) for s in (x, y, z)], axis=0)
    mesh.points = mesh.points + 1000 * np.outer(bubble, [0.3 * LENGTH, 0.6 * WIDTH, -0.6 * HEIGHT])
    return mesh


def _model(tmp_path, mesh):
    mesh.write(tmp_path / "bar.vtu")
    model = from_mesh(tmp_path / "bar.vtu", 1e-3, STEEL)
    model.check()
    return model


@pytest.mark.parametrize("kind", [*ELEMENTS, *MIXED])
def test_a_linear_field_has_one_stress_on_any_mesh(tmp_path, kind):
    """The patch test, on elements of which the inner ones are distorted and curved; stress as Hooke's law has it."""
    model = _model(tmp_path, _bent(_mixed(kind) if " and " in kind else mesh_of_bar(kind, 3, 4)))
    gradient = 1e-3 * np.random.default_rng(2).standard_normal((3, 3))
    displaced = (model.nodes @ gradient.T).ravel()
    strain = (gradient + gradient.T) / 2
    stress = E / (1 + NU) * (strain + NU / (1 - 2 * NU) * np.trace(strain) * np.eye(3))
    found = stress_points(model).stresses(displaced[:, None])[0]
    expected = [stress[a, b] for a, b in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))]
    np.testing.assert_allclose(found, np.tile(expected, (len(found), 1)), atol=1e-9 * np.abs(stress).max())
    energy = displaced @ (model.stiffness @ displaced) / 2
    assert energy == pytest.approx((stress * strain).sum() / 2 * LENGTH * WIDTH * HEIGHT, rel=1e-9)
    inner = np.all((model.nodes > 1e-9) & (model.nodes < np.array([LENGTH, WIDTH, HEIGHT]) - 1e-9), axis=1)
    force = (model.stiffness @ displaced).reshape(-1, 3)
    assert np.abs(force[inner]).max() < 1e-9 * np.abs(force).max()
    mass, centre, _ = rigid_body(model)
    assert mass == pytest.approx(MASS, rel=1e-9)
    np.testing.assert_allclose(centre, [LENGTH / 2, WIDTH / 2, HEIGHT / 2], rtol=1e-9)


@pytest.mark.parametrize("kind", [*ELEMENTS, *MIXED])
def test_the_surface_is_that_of_the_bar(tmp_path, kind):
    model = _model(tmp_path, _mixed(kind) if " and " in kind else mesh_of_bar(kind))
    area, volume = 0.0, 0.0
    for face in surface(model):
        points = model.nodes[face]
        normal = sum(np.cross(points[k - 1], points[k]) for k in range(len(points))) / 2
        area += np.linalg.norm(normal)
        volume += normal @ points.mean(axis=0) / 3
    assert area == pytest.approx(2 * (LENGTH * WIDTH + WIDTH * HEIGHT + HEIGHT * LENGTH), rel=1e-9)
    assert volume == pytest.approx(LENGTH * WIDTH * HEIGHT, rel=1e-9)


@pytest.mark.parametrize(
    ("kind", "error"), [("hexahedron20", 2e-4), ("wedge15", 2e-4), ("hexahedron27", 2e-4), ("hexahedron", 0.03)]
)
def test_curved_edges_follow_a_ring(tmp_path, kind, error):
    """A quarter of a ring in four elements: 30 times its mass error remains with straight edges."""
    mesh = mesh_of_bar(kind, along=4, across=2)
    angle, radius = np.pi / 2 * mesh.points[:, 0] / (1000 * LENGTH), 50 + mesh.points[:, 1]
    mesh.points = np.column_stack([radius * np.sin(angle), radius * np.cos(angle), mesh.points[:, 2]])
    for block in mesh.cells:
        corners = mesh.points[block.data[:, :4]]
        if np.linalg.det(corners[:, 1:4] - corners[:, :1])[0] < 0:
            mesh.points[:, 0] *= -1
    mass = rigid_body(_model(tmp_path, mesh))[0]
    outer = 0.05 + WIDTH
    expected = np.pi / 4 * (outer**2 - 0.05**2) * HEIGHT * STEEL.density
    assert abs(mass / expected - 1) < error
    assert abs(mass / expected - 1) > error / 30


def test_triangles_on_quadrilaterals_are_refused(tmp_path):
    bricks = mesh_of_bar("hexahedron", 3, 2)
    cells = bricks.cells[0].data
    upper = bricks.points[cells].mean(axis=1)[:, 1] > 500 * WIDTH
    blocks = [("hexahedron", cells[~upper]), ("wedge", split("wedge", bricks.points, cells[upper])[1])]
    meshio.Mesh(bricks.points, blocks).write(tmp_path / "bar.vtu")
    with pytest.raises(
        InputError, match="found 12 triangular faces of elements on quadrilateral ones of others, expected pyramids"
    ):
        from_mesh(tmp_path / "bar.vtu", 1e-3, STEEL)


def test_elements_of_two_orders_are_refused(tmp_path):
    mesh = _joined([mesh_of_bar("hexahedron20", 3, 2), mesh_of_bar("wedge", 3, 2)])
    mesh.write(tmp_path / "bar.vtu")
    with pytest.raises(
        InputError,
        match="found elements of the types hexahedron20, wedge, expected solids of the types tetra, hexahedron,",
    ):
        from_mesh(tmp_path / "bar.vtu", 1e-3, STEEL)
