"""The shapes that scenes give to bodies: read, written, mirrored, in space, and as solids."""

import math
import struct

import numpy as np
import pytest

from stiffmbs import Body, InputError, Model, read_scene, spatial
from stiffmbs.elements.spatial.body import Body as SpatialBody
from stiffmbs.show.drawing import solids
from stiffmbs.show.drawing.bodies import given_shapes, read_mesh
from stiffmbs.show.drawing.scene_graph import Solid
from stiffmbs.show.drawing.solids import triangles

SHAPES = """
      - {type: box, size: [100 mm, 0.2], point: [0.3, 0], angle: 90 deg}
      - {type: sphere, radius: 1 cm, color: "#a0B1c2"}
      - {type: cylinder, radius: 0.1}
      - {type: polyline, points: [[0, 0], [1, 0], [1, 1]], closed: true}
      - {type: mesh, file: part.stl, scale: 1e-3}
"""


def scene(shapes, dimensions=2):
    moments = "1" if dimensions == 2 else "[1, 1, 1]"
    return read_scene(
        f"dimensions: {dimensions}\nbodies:\n  a:\n    mass: 1\n    inertia: {moments}\n    geometry: {shapes}"
    )


def volume(solid):
    corners = solid.vertices[triangles(solid)]
    return float(np.einsum("nk,nk->n", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6)


@pytest.mark.long
@pytest.mark.parametrize(
    ("solid", "expected", "part"),
    [
        (solids.box((1, 2, 3)), 6, 1e-12),
        (solids.cylinder(0.5, 2, 200), math.pi / 2, 1e-3),
        (solids.sphere(0.5, 100), math.pi / 6, 2e-3),
    ],
    ids=["box", "cylinder", "sphere"],
)
def test_solids_enclose_their_volume_with_faces_turned_outwards(solid, expected, part):
    assert volume(solid) == pytest.approx(expected, rel=part)


def test_an_outline_with_a_notch_is_cut_into_triangles_of_its_area():
    notched = np.array([[0, 0, 0], [2, 0, 0], [2, 2, 0], [1, 0.5, 0], [0, 2, 0]], dtype=float)
    solid = solids.flat(notched)
    corners = solid.vertices[triangles(solid)]
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2] / 2
    assert (areas > 0).all()
    assert areas.sum() == pytest.approx(2.5)


@pytest.mark.parametrize("turned", [0, 1])
@pytest.mark.parametrize("corners", [3, 4])
def test_a_face_of_second_order_is_cut_at_the_middles_of_its_edges(corners, turned):
    """The first node may be a corner or a middle: each triangle lies at one corner, or between the middles."""
    angles = 2.0 * np.pi * np.arange(corners) / corners
    ends = np.column_stack([np.cos(angles), np.sin(angles), 0 * angles])
    nodes = np.stack([ends, (ends + np.roll(ends, -1, axis=0)) / 2], axis=1).reshape(-1, 3)
    nodes = np.roll(nodes, turned, axis=0)
    found = triangles(Solid(nodes, (np.arange(2 * corners),)))
    at_corners = [sum((k + turned) % 2 == 0 for k in triangle) for triangle in found]
    assert sorted(at_corners) == [0] * (corners - 2) + [1] * corners
    a, b, c = nodes[found].transpose(1, 0, 2)
    areas = np.cross(b - a, c - a)[:, 2] / 2
    assert (areas > 0).all() and areas.sum() == pytest.approx(corners / 2 * np.sin(2 * np.pi / corners))


def test_a_model_written_as_a_scene_keeps_its_shapes():
    read = scene(SHAPES)
    model = Model()
    model.add(
        "a", Body(mass=1, inertia=1, geometry=[s.model_dump(exclude_unset=True) for s in read.bodies["a"].geometry])
    )
    assert read_scene(model.to_scene()).bodies["a"].geometry == read.bodies["a"].geometry


def test_one_shape_may_stand_alone():
    assert (
        scene("{type: sphere, radius: 1}").bodies["a"].geometry
        == scene("[{type: sphere, radius: 1}]").bodies["a"].geometry
    )


def test_a_planar_scene_takes_its_shapes_to_space():
    found = spatial.in_space(scene(SHAPES)).bodies["a"].geometry
    assert [shape.type for shape in found] == ["box", "sphere", "cylinder", "polyline", "mesh"]
    assert found[0].size == (0.1, 0.2, 0.05)
    assert found[0].point == (0.3, 0, 0)
    assert found[3].points[2] == (1, 1, 0)


@pytest.mark.parametrize(
    ("shapes", "words"),
    [
        ("{type: ball, radius: 1}", "geometry.0: found the type 'ball', expected one of 'polyline', 'box'"),
        ("{radius: 1}", "found no type, expected one of"),
        ("{type: sphere, radius: 0}", "expected a length greater than 0 m"),
        ("{type: sphere, radius: 1 kg}", "which is in kg, expected a length"),
        ("{type: sphere, radius: 1, color: red}", "found 'red', expected a color such as '#336699'"),
        ("{type: mesh, file: part.step}", "found 'part.step', expected a file that ends in .stl or .obj"),
        ("{type: polyline, points: [[0, 0]]}", "found 1 values, expected 2"),
        ("{type: box, size: [1, 1], angle: 1 m}", "expected an angle"),
        ("nothing", "found 'nothing', expected a shape such as"),
    ],
)
def test_wrong_shapes_are_told_in_one_sentence(shapes, words):
    with pytest.raises(InputError) as error:
        scene(shapes)
    assert words in str(error.value)
    assert "\n" not in str(error.value)


TETRAHEDRON = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
FACES = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]


def binary_stl(path):
    facets = b"".join(
        struct.pack("<12fH", 0, 0, 0, *(float(x) for k in face for x in TETRAHEDRON[k]), 0) for face in FACES
    )
    path.write_bytes(bytes(80) + struct.pack("<I", len(FACES)) + facets)


def text_stl(path):
    corners = ("".join(f"vertex {x} {y} {z}\n" for x, y, z in TETRAHEDRON[list(face)]) for face in FACES)
    path.write_text("solid t\n" + "".join(f"facet normal 0 0 0\nouter loop\n{c}endloop\nendfacet\n" for c in corners))


def obj(path):
    vertices = "".join(f"v {x} {y} {z}\n" for x, y, z in TETRAHEDRON)
    path.write_text("# a comment\n" + vertices + "".join(f"f {a + 1}/1 {b + 1}//2 {c - 4}\n" for a, b, c in FACES))


@pytest.mark.parametrize(("name", "write"), [("a.stl", binary_stl), ("b.stl", text_stl), ("c.obj", obj)])
def test_meshes_are_read_with_their_volume(tmp_path, name, write):
    write(tmp_path / name)
    assert volume(read_mesh(tmp_path / name, "here")) == pytest.approx(1 / 6)


@pytest.mark.parametrize("content", [b"", b"solid nothing", b"vertex a b c", bytes(90), b"f 1 2 3"])
@pytest.mark.parametrize("ending", [".stl", ".obj"])
def test_a_file_that_is_no_mesh_is_told(tmp_path, content, ending):
    path = tmp_path / f"x{ending}"
    path.write_bytes(content)
    with pytest.raises(InputError, match="found no triangles"):
        read_mesh(path, "bodies.a.geometry.0")


def test_a_mesh_is_looked_for_beside_its_scene(tmp_path):
    (tmp_path / "parts").mkdir()
    binary_stl(tmp_path / "parts" / "t.stl")
    text = "{bodies: {a: {mass: 1, inertia: 1, geometry: {type: mesh, file: parts/t.stl, scale: 2}}}}"
    read = read_scene(text, file=tmp_path / "scene.yaml")
    (part,) = given_shapes("a", read.bodies["a"], 2)
    assert volume(part.solids[0]) == pytest.approx(8 / 6)


def test_shapes_in_space_are_placed_from_the_centre_of_mass():
    body = SpatialBody(
        mass=1, inertia=(1, 1, 1), center_of_mass=(0, 0, 1),
        geometry={"type": "box", "size": (2, 4, 6), "point": (1, 0, 0), "orientation": {"z": (1, 0, 0)}},
    )  # fmt: skip
    (part,) = given_shapes("a", body, 3)
    corners = part.solids[0].vertices
    assert corners.mean(axis=0) == pytest.approx([1, 0, -1])
    assert np.ptp(corners[:, 0]) == pytest.approx(6)


@pytest.mark.parametrize("dimensions", [2, 3])
def test_mirrored_parts_have_mirrored_shapes(tmp_path, dimensions):
    """Each corner of the left body's shapes is that of the right one with x turned round, and faces still look outwards."""
    binary_stl(tmp_path / "t.stl")
    moments, turn = (
        ("1", "angle: 0.3") if dimensions == 2 else ("[1, 1, 1]", "orientation: {euler: xyz, angles: [0.3, 0.2, 0.1]}")
    )
    z = "" if dimensions == 2 else ", 0.3"
    size = f"[1, 2{z}]"
    text = f"""
dimensions: {dimensions}
parts:
  p:
    bodies:
      a:
        mass: 1
        inertia: {moments}
        position: [1, 0.5{z}]
        {turn}
        geometry:
          - {{type: box, size: {size}, point: [0.4, 0.1{z}], {turn}}}
          - {{type: mesh, file: t.stl, point: [0.4, 0.1{z}], {turn}}}
          - {{type: polyline, points: [[0, 0{z}], [1, 0.2{z}], [0.5, 1{z}]]}}
use: {{right: {{part: p}}, left: {{part: p, mirror: x}}}}
"""
    read = read_scene(text, file=tmp_path / "scene.yaml")
    found = {}
    for side in ("right", "left"):
        body = read.bodies[f"{side}.a"]
        turned = spatial_axes(body)
        origin = np.zeros(3)
        origin[:dimensions] = body.position
        parts = given_shapes("a", body, dimensions)
        solids_found = [Solid(origin + s.vertices @ turned.T, s.faces, s.closed) for part in parts for s in part.solids]
        points = [origin + line.points @ turned.T for part in parts for line in part.lines]
        found[side] = solids_found, np.vstack([*(s.vertices for s in solids_found), *points])
    right, left = found["right"][1] * (-1, 1, 1), found["left"][1]
    assert all(np.linalg.norm(left - point, axis=1).min() < 1e-12 for point in right)
    assert volume(found["left"][0][1]) == pytest.approx(volume(found["right"][0][1]))


def spatial_axes(body):
    if hasattr(body, "orientation"):
        from stiffmbs.elements.spatial.orientation import matrix

        return matrix(body.orientation)
    c, s = math.cos(body.angle), math.sin(body.angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
