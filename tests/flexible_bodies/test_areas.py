"""Average interfaces with the areas of their nodes: integrals over the surface, on graded and curved meshes."""

import numpy as np
import pytest

from stiffmbs.errors import InputError
from stiffmbs.flexible_bodies.areas import nodal_areas
from stiffmbs.flexible_bodies.description import InterfaceOfNodes
from stiffmbs.flexible_bodies.mesh import from_mesh
from stiffmbs.flexible_bodies.shapes import ELEMENTS

from .bars import HEIGHT, LENGTH, STEEL, WIDTH, bar, mesh_of_bar

END = {"plane": {"point": [LENGTH, 0, 0], "normal": [1, 0, 0]}, "type": "average"}


def _graded(tmp_path, kind):
    """Nodes of the end lie closer together on one side."""
    mesh = mesh_of_bar(kind, along=2, across=4)
    side = mesh.points[:, 1] / (1000 * WIDTH)
    if kind in ("hexahedron20", "tetra10", "hexahedron27", "wedge15", "wedge18"):
        corners = np.unique(mesh.cells[0].data[:, : len(ELEMENTS[kind].shape.corners)])
        moved = mesh.points.copy()
        moved[corners, 1] = 1000 * WIDTH * side[corners] ** 2
        for k, between in enumerate(ELEMENTS[kind].middles, len(ELEMENTS[kind].shape.corners)):
            cells = mesh.cells[0].data
            moved[cells[:, k]] = moved[cells[:, list(between)]].mean(axis=1)
        mesh.points = moved
    else:
        mesh.points[:, 1] = 1000 * WIDTH * side**2
    mesh.write(tmp_path / "bar.vtu")
    return from_mesh(tmp_path / "bar.vtu", 1e-3, STEEL)


@pytest.mark.parametrize("kind", ELEMENTS)
def test_a_mean_is_the_integral_over_the_face(tmp_path, kind):
    model = _graded(tmp_path, kind)
    interface = InterfaceOfNodes.model_validate({**END, "weights": "area"}).on("end", model)
    areas = nodal_areas(model, interface.nodes)
    _, y, z = model.nodes[interface.nodes].T
    assert areas.sum() == pytest.approx(WIDTH * HEIGHT)
    assert areas @ y == pytest.approx(WIDTH**2 * HEIGHT / 2)
    if len(ELEMENTS[kind].powers) > 8:
        assert areas @ (y * z) == pytest.approx((WIDTH * HEIGHT) ** 2 / 4)
        assert areas @ y**2 == pytest.approx(WIDTH**3 * HEIGHT / 3)
    np.testing.assert_allclose(interface.point, [LENGTH, WIDTH / 2, HEIGHT / 2])
    mean = interface.mean(model)
    motion = np.random.default_rng(1).standard_normal(6)
    np.testing.assert_allclose(mean @ interface.rigid(model) @ motion, motion)
    pressed = np.zeros((len(areas), 3))
    pressed[:, 0] = y
    assert (mean @ pressed.ravel())[0] == pytest.approx(WIDTH / 2)
    equal = InterfaceOfNodes.model_validate(END).on("end", model).mean(model)
    assert abs((equal @ pressed.ravel())[0] / (WIDTH / 2) - 1) > 0.02


def test_the_area_of_a_curved_face(tmp_path):
    mesh = mesh_of_bar("hexahedron20", along=2, across=4)
    x, y, z = mesh.points.T
    angle = z / (1000 * HEIGHT)
    mesh.points = np.column_stack([x, (20 + y) * np.sin(angle), -(20 + y) * np.cos(angle)])
    mesh.write(tmp_path / "bar.vtu")
    model = from_mesh(tmp_path / "bar.vtu", 1e-3, STEEL)
    radius = np.linalg.norm(model.nodes[:, 1:], axis=1)
    assert nodal_areas(model, np.flatnonzero(abs(radius - 0.02) < 1e-6)).sum() == pytest.approx(0.02 * LENGTH, rel=1e-5)


def test_faces_within_the_body_do_not_count(tmp_path):
    model = bar(tmp_path, "hexahedron")
    areas = nodal_areas(model, np.arange(len(model.nodes)))
    assert areas.sum() == pytest.approx(2 * (LENGTH * WIDTH + WIDTH * HEIGHT + HEIGHT * LENGTH))


def test_what_has_no_areas_is_refused(tmp_path):
    model = bar(tmp_path, "hexahedron")
    three = InterfaceOfNodes.model_validate({"nodes": [0, 5, 9], "type": "average", "weights": "area"})
    with pytest.raises(InputError, match=r"interfaces.end.weights: found no face of an element between the nodes"):
        three.on("end", model)
    with pytest.raises(ValueError, match="found weights: area with type: rigid, expected them with type: average"):
        InterfaceOfNodes.model_validate({"nodes": [0, 5, 9], "weights": "area"})
