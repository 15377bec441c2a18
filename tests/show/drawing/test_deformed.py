"""Flexible bodies in pictures: the surface of the mesh, moved by the modal coordinates."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.results.flexible_motion import FlexibleMotion
from stiffmbs.show.drawing.as_json import drawing_json
from stiffmbs.show.drawing.deformed import surface
from stiffmbs.show.drawing.derive import drawing_of
from stiffmbs.show.drawing.picture import Shown, picture
from stiffmbs.show.drawing.poses import poses_of, seen_from
from stiffmbs.show.drawing.view import view_named

from ...flexible_bodies.bars import HEIGHT, LENGTH, WIDTH, bar, mesh_of_bar

SCENE = """
name: Bar on a trolley
dimensions: 3
gravity: [0, 0, -9.81]
bodies:
  trolley: {mass: 20, inertia: [1, 1, 1], velocity: [50, 0, 0]}
  bar:
    type: flexible
    mesh: bar.vtu
    units: {length: 1 mm}
    material: {E: 0.2 GPa, nu: 0.3, density: 7850 kg/m^3}
    interfaces: {a: {plane: {point: [0, 0, 0], normal: [1, 0, 0]}}}
    modes: 4
    stiffening: false
    deformation_scale: 3
    stress_colors: true
    velocity: [50, 0, 0]
joints:
  rail: {type: prismatic, i: {body: trolley, orientation: {z: [1, 0, 0]}}, j: {body: ground, orientation: {z: [1, 0, 0]}}}
  clamp: {type: fixed, i: bar.a, j: {body: trolley, point: [0, 15 mm, 10 mm]}}
run: {duration: 0.2, points: 6, rtol: 1e-7, solver: radau}
"""


@pytest.mark.parametrize("kind", ["tetra", "tetra10", "hexahedron", "hexahedron27"])
def test_the_surface_of_a_mesh_encloses_its_volume(tmp_path, kind):
    model = bar(tmp_path, kind, along=3, across=1)
    faces = surface(model)
    moments = np.zeros(2)
    for face in faces:
        points = model.nodes[face]
        parts = np.cross(points, np.roll(points, -1, axis=0)).sum(axis=0) / 2  # Newell's area vector
        moments += [np.linalg.norm(parts), points.mean(axis=0) @ parts / 3]
    area = 2 * (LENGTH * WIDTH + LENGTH * HEIGHT + WIDTH * HEIGHT)
    assert moments == pytest.approx([area, LENGTH * WIDTH * HEIGHT], rel=1e-6)


@pytest.fixture(scope="module")
def moving(tmp_path_factory):
    folder = tmp_path_factory.mktemp("bar")
    mesh_of_bar("hexahedron", along=6, across=1).write(folder / "bar.vtu")
    (folder / "scene.yaml").write_text(SCENE)
    scene = stiffmbs.load_scene(folder / "scene.yaml")
    solution = stiffmbs.run(scene)
    poses = poses_of(scene, solution.time, solution.channels)
    return scene, solution, drawing_of(scene, along=poses), poses


@pytest.mark.long
def test_vertices_are_the_nodes_with_their_magnified_displacements(moving):
    scene, solution, drawing, poses = moving
    motion = FlexibleMotion(scene, solution, "bar")
    (part,) = (part for part in drawing.parts if part.owner == "bar.frame")
    origin, axes = poses.pose("bar.frame", 5)
    shown = origin + poses.vertices(part.solids[0], 5) @ axes.T
    expected = motion.position()[5] + 2 * motion.displacement()[5] @ axes.T
    assert np.abs(motion.displacement()[5]).max() > 1e-3
    assert shown == pytest.approx(expected, abs=1e-6)  # all nodes of one layer of elements are on the surface


def test_a_view_that_follows_a_body_keeps_the_deformation(moving):
    _, _, drawing, poses = moving
    (solid,) = next(part.solids for part in drawing.parts if part.owner == "bar.frame")
    assert drawing.heaviest == "trolley"
    followed = seen_from("trolley", drawing, poses)
    assert followed.vertices(solid, 5) == pytest.approx(poses.vertices(solid, 5), abs=0)
    assert followed.points["trolley"][5] == pytest.approx(poses.points["trolley"][0])


def test_only_bodies_with_a_place_are_drawn_and_named(moving):
    _, _, drawing, _ = moving
    names = {name.text for name in drawing.names}
    assert names == {"trolley", "bar", "rail", "clamp"}
    assert {part.owner for part in drawing.parts if part.role == "body"} == {"trolley", "bar.frame", "rail"}
    assert drawing.size < 1.0


def test_matrices_without_elements_are_drawn_as_a_rod(tmp_path):
    model = bar(tmp_path, "hexahedron", along=3, across=1)
    np.savez(tmp_path / "bar.npz", nodes=model.nodes, K=model.stiffness.toarray(), M=model.mass.toarray())
    ends = "{a: {plane: {point: [0, 0, 0], normal: [1, 0, 0]}}, b: {plane: {point: [400 mm, 0, 0], normal: [1, 0, 0]}}}"
    body = f"{{type: flexible, matrices: bar.npz, units: {{length: 1 m}}, interfaces: {ends}, modes: 2}}"
    (tmp_path / "rod.yaml").write_text(f"name: Rod\ndimensions: 3\nbodies:\n  bar: {body}\nrun: {{duration: 1}}\n")
    (part,) = drawing_of(stiffmbs.load_scene(tmp_path / "rod.yaml")).parts
    assert part.owner == "bar.frame"
    assert np.ptp(part.solids[0].vertices[:, 0]) == pytest.approx(LENGTH)


def test_the_picture_and_the_page_state_the_scale(moving):
    pytest.importorskip("matplotlib")
    _, _, drawing, poses = moving
    sheet = picture(drawing, poses, view_named("", 3, drawing.gravity), Shown())
    assert [text.get_text() for text in sheet.axes[0].get_legend().get_texts()] == ["bar: deformation x 3"]
    page = drawing_json(drawing)
    assert page["deformations"] == {"bar": 3.0}
    (solid,) = next(part["solids"] for part in page["parts"] if part["owner"] == "bar.frame")
    assert np.shape(solid["modes"]["bar.modes1"]) == (3, len(solid["vertices"]), 3)


def test_stress_colors_are_the_von_mises_stresses_of_the_nodes(moving):
    scene, solution, drawing, poses = moving
    motion = FlexibleMotion(scene, solution, "bar")
    (solid,) = (solid for part in drawing.parts for solid in part.solids if solid.stresses)
    used = np.unique(np.concatenate(surface(motion.model)))
    np.testing.assert_allclose(poses.stresses(solid, np.arange(6)), motion.von_mises()[:, used], rtol=1e-9)
    assert drawing.stress == pytest.approx(motion.von_mises()[:, used].max())
    assert drawing_json(drawing)["stress"] == drawing.stress
    sheet = picture(drawing, poses.at(np.array([5])), view_named("", 3, drawing.gravity), Shown())
    assert [axes.get_ylabel() for axes in sheet.axes] == ["", "von Mises stress (MPa)"]
    colors = {tuple(np.round(color, 3)) for artist in sheet.axes[0].collections for color in artist.get_facecolor()}
    assert len(colors) > 20


def test_stress_colors_without_a_mesh_are_refused(tmp_path):
    model = bar(tmp_path, "hexahedron", along=2, across=1)
    cells = {name.replace("hexahedron", "hex8"): cells for name, cells in model.cells.items()}
    np.savez(tmp_path / "bar.npz", nodes=model.nodes, K=model.stiffness.toarray(), M=model.mass.toarray(), **cells)
    text = SCENE.replace("mesh: bar.vtu", "matrices: bar.npz").replace("1 mm}", "1 m}")
    (tmp_path / "scene.yaml").write_text("\n".join(line for line in text.splitlines() if "material" not in line))
    with pytest.raises(stiffmbs.InputError, match=r"bodies\.bar\.stress_colors: found a body described by matrices"):
        drawing_of(stiffmbs.load_scene(tmp_path / "scene.yaml"))
