"""Drawings of models: every kind has a symbol, what is drawn is where the model has it, arrows are to scale."""

import json
from xml.etree import ElementTree

import numpy as np
import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs import Body, Force, InputError, Joint, Model, Prismatic, Revolute, SpringDamper, read_scene, spatial
from stiffmbs.commands.main import main
from stiffmbs.compile.quaternions import rotated
from stiffmbs.show.drawing.as_json import drawing_json, poses_json
from stiffmbs.show.drawing.deformed import interface_bodies, modal_bodies
from stiffmbs.show.drawing.derive import drawing_of
from stiffmbs.show.drawing.draw import state_drawn
from stiffmbs.show.drawing.painted import LONGEST_ARROW, extent, largest_force, painted, stretched
from stiffmbs.show.drawing.poses import Poses, described_poses, poses_of
from stiffmbs.show.drawing.scene_graph import LOAD, MARKS
from stiffmbs.show.drawing.view import from_angles, view_named

from ...conftest import EXAMPLE_SCENES, EXAMPLES
from ...random_parts import CASES, add_joints, random_element, refers_to_joints, three_bodies, three_bodies_in_space


def run(*arguments):
    return CliRunner().invoke(main, ["draw", *(str(argument) for argument in arguments)])


@pytest.mark.sampled(7)
@pytest.mark.parametrize(("dimensions", "kind", "form"), CASES, ids=lambda case: getattr(case, "kind", None))
def test_every_kind_is_drawn(dimensions, kind, form):
    """Something of it is shown, finite, on bodies of the model."""
    rng = np.random.default_rng(5)
    model = three_bodies(rng) if dimensions == 2 else three_bodies_in_space(rng)
    element = random_element(kind, rng, form, dimensions)
    if refers_to_joints(element):
        add_joints(model)
    (model.joints if isinstance(element, Joint) else model.forces)["it"] = element
    data = model.data_type.model_construct(**model._content())  # some kinds cannot act from anywhere
    drawing = drawing_of(data)
    shown = [part for part in (*drawing.parts, *drawing.links) if part.owner == "it"]
    assert shown
    patches = painted(drawing, described_poses(data), 0, view_named("", dimensions, drawing.gravity))
    assert all(np.isfinite(patch.points).all() for patch in patches)
    json.dumps(drawing_json(drawing), allow_nan=False)


CARS = ("truck", "hatchback", "formula_student", "leaf_sprung_car", "motorcycle")
"""Scenes of hundreds of bodies; `car` is one more of these."""


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    "scene", [pytest.param(name, marks=pytest.mark.long if name in CARS else ()) for name in EXAMPLE_SCENES]
)
def test_examples_are_drawn_as_they_are_described(scene):
    """Each body, and each element with a place, is on the picture, within the size that symbols are scaled to."""
    data = stiffmbs.load_scene(EXAMPLE_SCENES[scene])
    drawing, poses = state_drawn(data, described=True)
    hidden = modal_bodies(data) | set(interface_bodies(data))
    assert {part.body for part in drawing.parts} >= set(data.bodies) - hidden
    view = view_named("", data.dimensions, drawing.gravity)
    assert all(np.isfinite(patch.points).all() for patch in painted(drawing, poses, 0, view))
    low, high = extent(drawing, poses, view)  # without road and floor
    assert 0.2 * drawing.size < np.linalg.norm(high - low) < 4 * drawing.size


def pendulum():
    model = Model("pendulum", gravity=(0, -9.81))
    bar = model.add("bar", Body(mass=2, inertia=0.1, position=(0.5, 0)))
    model.add("hinge", Revolute(i=bar.at(-0.5, 0), j="ground"))
    return model, bar


def test_symbols_are_where_a_run_takes_their_markers():
    """A spring ends at its markers at every instant, and a pin turns about its own."""
    model, bar = pendulum()
    model.add(
        "spring", SpringDamper(i=bar.at(0.5, 0), j={"body": "ground", "point": (0, 1)}, stiffness=10, free_length=1)
    )
    solution = model.run(duration=1, points=7)
    drawing, poses = drawing_of(model.data()), poses_of(model.data(), solution.time, solution.channels)
    (link,) = drawing.links
    for k, angle in enumerate(solution["bar.angle"]):
        ends = [poses.pose(end.body, k)[0] + poses.pose(end.body, k)[1] @ end.point for end in (link.i, link.j)]
        points = stretched(link.profiles[0], *ends)
        assert points[0, :2] == pytest.approx([np.cos(angle), np.sin(angle)], abs=1e-6)
        assert points[-1, :2] == pytest.approx([0, 1])
    pin = next(part for part in drawing.parts if part.owner == "hinge" and part.role == "joint")
    origin, axes = poses.pose("bar", 3)
    middle = (origin + pin.solids[0].vertices @ axes.T).mean(axis=0)
    assert middle[:2] == pytest.approx([0, 0], abs=1e-6)


def arrows(drawing, poses):
    """Start and end of each force arrow, longest for 20 N."""
    patches = painted(drawing, poses, 0, view_named("", 2, drawing.gravity), 20.0)
    heads = [patch.points[0] for patch in patches if patch.face == LOAD]
    shafts = [patch.points[0] for patch in patches if patch.edge == LOAD]
    return list(zip(shafts, heads, strict=True))


def test_arrows_are_to_scale():
    """The guide of a block carries its weight, 2 kg times 9.81 m/s^2, upwards from its point."""
    model = Model(gravity=(0, -9.81))
    model.add("block", Body(mass=2, inertia=1, position=(0.2, 0)))
    model.add("far", Body(mass=1e-3, inertia=1, position=(3, 1)))
    model.add("guide", Prismatic(i="block", j="ground"))
    drawing, poses = state_drawn(model)
    ((start, end),) = arrows(drawing, poses)
    assert start == pytest.approx([0.2, 0])
    assert end - start == pytest.approx([0, LONGEST_ARROW * drawing.size * 2 * 9.81 / 20])


def test_forces_that_are_rounding_are_not_drawn():
    """A ball that falls along its guide is held by nothing; its guide's force of 1e-16 N is no arrow."""
    data = stiffmbs.load_scene(EXAMPLES / "bouncing_ball.yaml")
    drawing, poses = state_drawn(data)
    tiny = Poses(poses.time, poses.points, poses.orientations, {**poses.forces, "upright": np.array([[1e-16, 0, 0]])})
    assert largest_force(drawing, tiny) == 0
    assert stiffmbs.draw(data).axes[0].get_legend() is None


def test_an_isometric_view_shows_all_axes_equally_long():
    view = view_named("isometric", 3, np.array([0, 0, -9.81]))
    lengths = np.linalg.norm(view.seen(np.eye(3))[:, :2], axis=1)
    assert lengths == pytest.approx([np.sqrt(2 / 3)] * 3)
    assert view.seen(np.array([[0, 0, 1.0]]))[0, 1] > 0  # up is up
    assert view_named("isometric", 3, np.array([0, -9.81, 0])).seen(np.array([[0, 1.0, 0]]))[0, 1] > 0


@pytest.mark.parametrize("up", ["y", "z"])
def test_views_are_rotations(up):
    axes = from_angles(20, -35, up).axes
    assert axes @ axes.T == pytest.approx(np.eye(3))
    assert np.linalg.det(axes) == pytest.approx(1)


def test_what_is_redundant_has_a_color_of_its_own():
    drawing, _ = state_drawn(EXAMPLES / "door.yaml", checked=True)
    assert drawing.marks == {"upper_hinge": "not unique", "lower_hinge": "redundant"}
    poses = described_poses(stiffmbs.load_scene(EXAMPLES / "door.yaml"))
    edges = {patch.edge for patch in painted(drawing, poses, 0, view_named("", 3, drawing.gravity))}
    assert {MARKS["redundant"], MARKS["not unique"]} <= edges


def test_a_picture_names_everything_and_takes_no_markup_from_titles(tmp_path):
    text = (EXAMPLES / "cart_pendulum.yaml").read_text().replace("name: Cart-pendulum", "name: '<b>$x_2$ & </svg>'")
    scene = tmp_path / "scene.yaml"
    scene.write_text(text)
    result = run(scene, "-o", tmp_path / "x.svg", "--json")
    assert result.exit_code == 0, result.output
    told = json.loads(result.output)
    assert (told["bodies"], told["elements"]) == (2, 3)
    assert told["largest_force"] == pytest.approx(107, abs=1)
    ElementTree.parse(tmp_path / "x.svg")
    sheet = stiffmbs.draw(scene)
    words = {child.get_text() for child in sheet.axes[0].get_children() if hasattr(child, "get_text")}
    assert {"cart", "bar", "rail", "hinge", "spring", "<b>$x_2$ & </svg>"} <= words


@pytest.mark.parametrize("ending", ["png", "pdf", "json"])
def test_drawings_are_written(tmp_path, ending):
    path = tmp_path / f"x.{ending}"
    assert run(EXAMPLES / "bricard.yaml", "-o", path, "--described", "--view", "30,20").exit_code == 0
    head = {"png": b"\x89PNG", "pdf": b"%PDF", "json": b'{"drawing"'}[ending]
    assert path.read_bytes().startswith(head)


def test_shapes_as_numbers_place_a_body_in_space():
    """The numbers of the JSON file rebuild a corner: the quaternion turns it, the point moves it."""
    data = stiffmbs.load_scene(EXAMPLES / "door.yaml")
    drawing, poses = drawing_of(data), described_poses(data)
    content = json.loads(json.dumps({"drawing": drawing_json(drawing), "poses": poses_json(poses)}))
    part = next(part for part in content["drawing"]["parts"] if part["owner"] == "door")
    corners = np.array(part["solids"][0]["vertices"])
    x, y, z, w, a, b, c = content["poses"]["bodies"]["door"][0]
    turned = np.array([x, y, z]) + rotated(np.array([w, a, b, c]), corners)
    assert np.ptp(turned, axis=0) == pytest.approx([0.04, 0.9, 2], abs=1e-6)
    assert turned[:, 1].min() == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("-o", "x.bmp"), "found the ending '.bmp', expected one of .svg, .png, .pdf, .json"),
        (("--view", "behind"), "--view: found 'behind', expected isometric"),
        (("--view", "1,inf"), "expected finite angles"),
        (("-o", "nowhere/x.svg"), "found no folder"),
    ],
)
def test_wrong_input_is_told(tmp_path, monkeypatch, arguments, words):
    monkeypatch.chdir(tmp_path)
    result = run(EXAMPLES / "four_bar.yaml", *arguments)
    assert result.exit_code == 2
    assert words in result.stderr
    assert result.stderr.count("\n") == 1


def test_a_mesh_that_is_missing_is_told(tmp_path):
    scene = tmp_path / "scene.yaml"
    scene.write_text("bodies: {a: {mass: 1, inertia: 1, geometry: {type: mesh, file: gone.stl}}}")
    result = run(scene, "-o", tmp_path / "x.svg", "--described")
    assert result.exit_code == 2
    assert "bodies.a.geometry.0" in result.stderr
    assert "gone.stl: No such file" in result.stderr


def test_results_of_another_model_are_refused():
    model, _ = pendulum()
    with pytest.raises(InputError, match=r"found results without the channel 'bar\.x'"):
        poses_of(model.data(), np.zeros(1), {})


def test_elements_of_ones_own_are_drawn_as_they_say():
    class Latch(Revolute):
        kind = "latch_for_drawing"
        symbol = "revolute"

    class Plain(Revolute):
        kind = "plain_for_drawing"

    shapes = {}
    for made in (Latch, Plain, Revolute):
        model = Model()
        model.add("a", Body(mass=1, inertia=1))
        model.joints["pin"] = made(i="a", j="ground")
        drawing = drawing_of(model.data_type.model_construct(**model._content()))
        shapes[made] = [len(line.points) for part in drawing.parts if part.owner == "pin" for line in part.lines]
    assert shapes[Latch] == shapes[Revolute] != shapes[Plain]
    assert issubclass(Latch, Joint) and not issubclass(Latch, Force)


def test_a_body_alone_is_drawn_as_large_as_its_moments_tell():
    model = spatial.Model()
    model.add("a", spatial.Body(mass=1, inertia=(0.1, 0.2, 0.3)))
    drawing = drawing_of(model.data())
    poses = Poses(np.zeros(1), {"a": np.zeros((1, 3))}, {"a": np.array([[1.0, 0, 0, 0]])})
    points = np.vstack([patch.points for patch in painted(drawing, poses, 0, view_named("top", 3, drawing.gravity))])
    assert np.ptp(points[:, 0]) > np.ptp(points[:, 1]) > 0


def test_a_scene_with_requests_and_equations_alone_is_drawn():
    text = "{bodies: {a: {mass: 1, inertia: 1}}, joints: {e: {type: equation, zero: a.x}}}"
    drawing = drawing_of(read_scene(text))
    assert any(part.owner == "e" for part in drawing.parts)
