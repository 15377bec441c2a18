"""Flexible bodies in parts, mirrored or not, and in models built in Python, against those of plain scenes."""

import meshio
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import stiffmbs
from stiffmbs import load_scene, read_scene, spatial
from stiffmbs.analyses.run import run
from stiffmbs.errors import InputError
from stiffmbs.flexible_bodies.description import FlexibleBody
from stiffmbs.flexible_bodies.mirrored import mirrored
from stiffmbs.flexible_bodies.reduced import reduced_body
from stiffmbs.flexible_bodies.shapes import ELEMENTS
from stiffmbs.flexible_bodies.stress import stress_points
from stiffmbs.results.flexible_motion import FlexibleMotion
from stiffmbs.spatial import Body, Fixed, Marker, Model, Revolute, SpringDamper
from stiffmbs.spatial import FlexibleBody as BodyOfModel

from .bars import bar, mesh_of_bar
from .shells.meshes import surface

FIELDS = """mesh: arm.vtu
        units: {length: 1 m}
        material: {E: 70 GPa, nu: 0.3, density: 2700 kg/m^3}
        thickness: 20 mm
        modes: 4
        damping: 0.01
        position: [0, 0.2, 0]
        orientation: {z: [0, 0.1, 1]}
        omega: [0, 0, 0.5]
        interfaces: {root: {plane: {point: [0, 0, 0], normal: [1, 0, 0]}}, tip: {plane: {point: [1, 0, 0], normal: [1, 0, 0]}}}
"""
REST = """
    bodies:
      arm:
        type: flexible
        FIELDS      weight: {mass: 0.5, inertia: [0.001, 0.002, 0.003], position: [1.05, 0.35, 0.05]}
    joints:
      hinge:
        type: revolute
        i: {body: arm.root, orientation: {z: [0, 1, 0]}}
        j: {body: MOUNT, point: [0, 0.25, 0], orientation: {z: [0, 1, 0.1]}}
      end: {type: fixed, i: arm.tip, j: weight}
    forces:
      spring: {type: spring_damper, i: weight, j: {body: MOUNT, point: [1, 0.3, 1]}, stiffness: 3000, free_length: 0.9, damping: 2}
""".replace("FIELDS", FIELDS)
HEAD, TIMES = "dimensions: 3\n", "run: {duration: 0.1, points: 11, rtol: 1e-8, solver: radau}\n"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    found = tmp_path_factory.mktemp("parts")
    nodes, cells, _ = surface(8, 2, lambda a, b: (a, 0.1 * b + 0.1 * a, 0.02 * a * a))
    meshio.Mesh(nodes, list(cells.items())).write(found / "arm.vtu")
    return found


def solved(folder, text, name="scene"):
    path = folder / f"{name}.yaml"
    path.write_text(HEAD + text + TIMES)
    scene = load_scene(path)
    return scene, run(scene)


@pytest.fixture(scope="module")
def plain(folder):
    return solved(folder, REST.replace("MOUNT", "ground").replace("\n    ", "\n"), "plain")


def points(found, name):
    return np.array([found[f"{name}.{axis}"] for axis in "xyz"]).T


@pytest.mark.parametrize("use", ["{part: wing", "{part: outer"])
@pytest.mark.parametrize("mirror", ["", "x", "y", "z"])
def test_a_part_moves_as_the_plain_scene_or_its_mirror_image(folder, plain, mirror, use):
    """In any place: turned, mirrored, within another part that is mirrored too."""
    turn = Rotation.from_euler("z", 90, degrees=True).as_matrix()
    within = ", mirror: x" if "outer" in use else ""
    parts = f"parts:\n  wing:{REST.replace('MOUNT', 'mount')}  outer: {{use: {{own: {{part: wing{', mirror: y' if within else ''}}}}}}}\n"
    placed = f"use:\n  it: {use}, position: [1, 2, 3], orientation: {{z: [0, 0, 1], x: [0, 1, 0]}}"
    whole = np.diag([-1.0 if axis == mirror else 1.0 for axis in "xyz"])
    if within:
        whole, mirror = whole @ np.diag([1.0, -1.0, 1.0]), mirror
    text = parts + placed + (f", mirror: {mirror}" if mirror else "") + "}\n"
    scene, found = solved(folder, text)
    name = "it.own" if within else "it"
    _, expected = plain
    move = turn @ whole
    for body in ("arm.frame", "arm.tip", "weight"):
        np.testing.assert_allclose(
            points(found, f"{name}.{body}"), points(expected, body) @ move.T + [1, 2, 3], atol=1e-8
        )
    of_plain, of_part = (FlexibleMotion(*each).von_mises() for each in ((*plain, "arm"), (scene, found, f"{name}.arm")))
    np.testing.assert_allclose(of_part, of_plain, atol=1e-5 * of_plain.max())


def arm_like(**fields):
    """Return a body for a model built in Python."""
    described = {
        "mesh": "arm.vtu",
        "units": {"length": 1},
        "material": {"E": 7e10, "nu": 0.3, "density": 2700},
        "thickness": 0.02,
    }
    return BodyOfModel(**described, **fields)


def test_a_model_built_in_python_moves_as_the_scene(folder, plain, monkeypatch):
    monkeypatch.chdir(folder)
    model = Model("wing")
    plane = {"point": [0, 0, 0], "normal": [1, 0, 0]}
    arm = model.add("arm", arm_like(
        modes=4, damping=0.01, position=(0, 0.2, 0), orientation={"z": [0, 0.1, 1]}, omega=(0, 0, 0.5),
        interfaces={"root": {"plane": plane}, "tip": {"plane": plane | {"point": [1, 0, 0]}}},
    ))  # fmt: skip
    assert repr(arm) == "<FlexibleHandle arm: root, tip>"
    model.add("weight", Body(mass=0.5, inertia=(0.001, 0.002, 0.003), position=(1.05, 0.35, 0.05)))
    root = Marker(body="arm.root", orientation={"z": [0, 1, 0]})
    model.add("hinge", Revolute(i=root, j=Marker(body="ground", point=(0, 0.25, 0), orientation={"z": [0, 1, 0.1]})))
    model.add("end", Fixed(i=arm.tip, j="weight"))
    to = Marker(body="ground", point=(1, 0.3, 1))
    model.add("spring", SpringDamper(i="weight", j=to, stiffness=3000, free_length=0.9, damping=2))
    found = model.run(duration=0.1, points=11, rtol=1e-8, solver="radau")
    np.testing.assert_allclose(points(found, "arm.tip"), points(plain[1], "arm.tip"), atol=1e-9)
    with pytest.raises(AttributeError, match="arm: found no interface 'tips'"):
        _ = arm.tips
    known = list(model.bodies), list(model.joints)
    model.add("other.end", Body(mass=1, inertia=(1, 1, 1)))
    with pytest.raises(
        InputError, match=r"other\.end: found a name that is taken"
    ):  # no other part of the body remains
        model.add("other", arm_like(interfaces={"end": {"plane": plane}}))
    model.remove("other.end")
    assert (list(model.bodies), list(model.joints)) == known
    with pytest.raises(InputError, match=r"other: none\.vtu: "):
        model.add("other", BodyOfModel(mesh="none.vtu", units={"length": 1}, material={"E": 1, "nu": 0, "density": 1}))


PLANES = {
    "root": {"plane": {"point": [0, 0, 0], "normal": [1, 0, 0]}},
    "tip": {"plane": {"point": [1, 0, 0], "normal": [1, 0, 0]}},
}
ROOT, TIP = ({name: PLANES[name]} for name in PLANES)


def arm_with_weight(**fields):
    """Return a model with an arm that carries a weight, and the handle of the arm."""
    model = Model("wing", gravity=(0, 0, -9.81))
    model.add("base", Body(mass=2, inertia=(1, 1, 1)))
    model.add("foot", Fixed(i="base", j="ground"))
    arm = model.add("arm", arm_like(interfaces=PLANES, **fields))
    model.add("weight", Body(mass=0.5, inertia=(0.001, 0.002, 0.003), position=(1, 0.15, 0.02)))
    model.add("clamp", Fixed(i=arm.root, j="ground"))
    model.add("end", Fixed(i=arm.tip, j="weight"))
    model.request("height", "arm.tip.z")
    return model, arm


def sections(model):
    return [dict(section) for section in (model.bodies, model.joints, model.forces, model.requests)]


def test_a_flexible_body_is_replaced_with_the_parts_that_refer_to_it(folder, monkeypatch):
    """By one with other modes and dimensions; the model is the one that has it from the beginning."""
    monkeypatch.chdir(folder)
    model, arm = arm_with_weight(modes=2, damping=0.02)
    new = model.replace(arm, arm_like(interfaces=PLANES, modes=7, damping=0.01))
    assert repr(new) == "<FlexibleHandle arm: root, tip>"
    expected, _ = arm_with_weight(modes=7, damping=0.01)
    assert sections(model) == sections(expected)
    assert [list(section) for section in sections(model)] == [list(section) for section in sections(expected)]
    found, other = (each.run(duration=0.02, points=3) for each in (model, expected))
    np.testing.assert_array_equal(found["height"], other["height"])
    fewer = model.replace("arm", arm_like(interfaces=PLANES, modes=0))
    assert list(model.bodies) == ["base", "arm.frame", "arm.modes1", "arm.modes2", "arm.root", "arm.tip", "weight"]
    assert fewer.tip.position == pytest.approx((1, 0.15, 0.02))


def test_a_flexible_body_in_use_stays(folder, monkeypatch):
    monkeypatch.chdir(folder)
    model, arm = arm_with_weight(modes=2)
    before = sections(model)
    for change, words in [
        (lambda: model.remove(arm), r"arm: found it in use \(clamp\.i: found the unknown body 'arm\.root'"),
        (lambda: model.replace("arm", arm_like(interfaces=ROOT)), r"arm: found it in use \(end\.i: found the unknown body 'arm\.tip'"),
        (lambda: model.replace("arm", arm_like(interfaces={"frame": PLANES["tip"]})), r"interfaces: found 'frame', the name of a part"),
        (lambda: model.replace("arm", BodyOfModel(mesh="none.vtu", units={"length": 1}, material={"E": 1, "nu": 0, "density": 1})),
         r"arm: none\.vtu: "),
        (lambda: model.replace("arm", Body(mass=1, inertia=(1, 1, 1))), r"arm: found Body\(.* in place of FlexibleBody\(.*a flexible body for"),
        (lambda: model.replace("base", arm_like(interfaces=ROOT)), r"base: found FlexibleBody\(.* in place of Body\(.*a body for a body"),
        (lambda: model.replace("none", arm_like(interfaces=ROOT)), r"none: found no part of that name"),
        (lambda: model.add("arm", Body(mass=1, inertia=(1, 1, 1))), r"arm: found a name that is taken"),
        (lambda: model.add("arm", arm_like(interfaces=ROOT)), r"arm: found a name that is taken"),
        (lambda: model.remove("arm.tip"), r"arm\.tip: found a part of 'arm', which can only be changed as a whole: model\.remove\('arm'\)"),
        (lambda: model.remove("arm.modes1"), r"arm\.modes1: found a part of 'arm'"),
        (lambda: model.remove("arm.tip_interface"), r"arm\.tip_interface: found a part of 'arm'"),
        (lambda: model.replace("arm.tip", Body(mass=1, inertia=(1, 1, 1))), r"arm\.tip: .* as a whole: model\.replace\('arm', \.\.\.\)"),
        (lambda: setattr(arm.tip, "mass", 3), r"arm\.tip: found a part of 'arm'"),
        (lambda: model.replace("arm.tip_interface", Fixed(i="arm.tip", j="ground")), r"arm\.tip_interface: found a part of 'arm'"),
    ]:  # fmt: skip
        with pytest.raises(InputError, match=words):
            change()
        assert sections(model) == before
    model.run(duration=0.01, points=2)


def test_a_flexible_body_is_removed_and_added_again(folder, monkeypatch):
    monkeypatch.chdir(folder)
    model, arm = arm_with_weight(modes=2)
    before = sections(model)
    removed = ["clamp", "end", "height"]
    for name in removed:
        model.remove(name)
    model.remove(arm)
    assert (list(model.bodies), list(model.joints)) == (["base", "weight"], ["foot"])
    with pytest.raises(InputError, match=r"arm: found no part of that name"):
        model.remove("arm")
    with pytest.raises(InputError, match=r"arm\.tip: found a body that was removed"):
        _ = arm.tip.mass
    again = model.add("arm", arm_like(interfaces=PLANES, modes=2))
    model.add("clamp", Fixed(i=again.root, j="ground"))
    model.add("end", Fixed(i=again.tip, j="weight"))
    model.request("height", "arm.tip.z")
    assert sections(model) == before
    model.remove("end")
    model.remove("height")
    assert [*model.replace("arm", arm_like(interfaces=ROOT, modes=0))] == ["root"]


def test_markers_of_interfaces_are_added(folder, monkeypatch):
    monkeypatch.chdir(folder)
    model, arm = arm_with_weight(modes=2)
    arm.tip.markers = {"hole": {"point": (0, 0, 0.01)}}
    model.add("spring", SpringDamper(i="arm.tip.hole", j="ground", stiffness=1))
    assert model.run(duration=0.01, points=2).outcome
    with pytest.raises(InputError, match=r"arm: found it in use \(spring\.i: found 'arm\.tip\.hole'"):
        model.replace("arm", arm_like(interfaces=PLANES, modes=3))


@pytest.mark.parametrize("dimensions", [2, 3])
def test_beams_are_replaced_and_removed(dimensions):
    family = stiffmbs if dimensions == 2 else spatial
    end = (1, 0, 0)[:dimensions]
    section = {"type": "rectangle", "width": 0.02, "height": 0.01}
    steel = {"E": 2e11, "density": 7850, **({"nu": 0.3} if dimensions == 3 else {})}

    def beam(elements):
        return family.BeamBody(
            start=(0, 0, 0)[:dimensions], end=end, section=section, material=steel, elements=elements
        )

    def made(elements):
        model = family.Model()
        strip = model.add("strip", beam(elements))
        model.add("clamp", family.Fixed(i=strip.start, j="ground"))
        return model, strip

    model, strip = made(4)
    new = model.replace(strip, beam(6))
    assert sections(model) == sections(made(6)[0])
    assert list(new) == list(made(6)[1])
    with pytest.raises(InputError, match=r"strip: found it in use \(clamp\.i"):
        model.remove("strip")
    with pytest.raises(InputError, match=r"strip\.start: found a part of 'strip'"):
        model.remove("strip.start")
    model.remove("clamp")
    model.remove(new)
    assert not (model.bodies or model.forces)


@pytest.mark.parametrize("axes", ["x", "yz", "xyz"])
@pytest.mark.parametrize("kind", ELEMENTS)
def test_a_mirrored_mesh_of_solids(tmp_path, kind, axes):
    """Volumes stay positive; stiffness and mass are those of elements made from the mirrored nodes; stresses are mirrored."""
    model = bar(tmp_path, kind, along=2, across=1)
    signs = np.array([-1.0 if axis in axes else 1.0 for axis in "xyz"])
    image = mirrored(model, signs)
    image.check()
    for found, own in ((image.stiffness, image.solid.stiffness()), (image.mass, image.solid.mass())):
        assert abs(found - own).max() < 1e-12 * abs(own).max()
    displacement = np.random.default_rng(0).standard_normal((len(model.nodes), 3))
    stress, of_image = (
        stress_points(each).stresses(moved.reshape(-1, 1))[0]
        for each, moved in ((model, displacement), (image, displacement * signs))
    )
    of_components = [signs[a] * signs[b] for a, b in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))]
    np.testing.assert_allclose(of_image, stress * of_components, atol=1e-9 * np.abs(stress).max())


def test_a_mirrored_body_has_the_interfaces_of_its_file(tmp_path):
    mesh_of_bar("hexahedron").write(tmp_path / "bar.vtu")
    plane = {"plane": {"point": [0.4, 0, 0], "normal": [1, 0, 0]}}
    described = {
        "mesh": "bar.vtu", "units": {"length": 1e-3}, "material": {"E": 1e9, "nu": 0.3, "density": 1e3}, "modes": 3,
        "interfaces": {"end": plane},
    }  # fmt: skip
    one, other = (reduced_body(FlexibleBody(**described, mirror=mirror), tmp_path) for mirror in (None, "x"))
    np.testing.assert_allclose(other.points, one.points * [-1, 1, 1])
    np.testing.assert_allclose(other.centre, one.centre * [-1, 1, 1])
    np.testing.assert_allclose(other.frequencies, one.frequencies, rtol=1e-6)
    with pytest.raises(InputError, match="mirror: found 'w', expected"):
        FlexibleBody(**described, mirror="w")


def test_mistakes_in_parts_name_the_part(folder):
    wing = f"parts:\n  wing:{REST.replace('MOUNT', 'mount')}use: {{left: {{part: wing}}}}\n"
    (folder / "wrong.yaml").write_text(HEAD + wing.replace("arm.vtu", "other.vtu") + TIMES)
    with pytest.raises(InputError, match=r"parts\.wing\.bodies\.arm: .*other\.vtu"):
        load_scene(folder / "wrong.yaml")
    with pytest.raises(InputError, match=r"parts\.wing\.bodies\.arm\.modes"):
        read_scene(HEAD + wing.replace("modes: 4", "modes: -4") + TIMES)
    thick = wing.replace("thickness: 20 mm", "thickness: h").replace("wing:", "wing:\n    parameters: {h: 20 mm}")
    for part, message in (
        (
            thick.replace("{left: {part: wing}}", "{left: {part: wing}, right: {part: wing, parameters: {h: -1 mm}}}"),
            r"thickness: found h, .* \(in right\)",
        ),
        (wing.replace("arm.tip", "arm.tap"), r"found the unknown body 'arm\.tap', expected left\.arm\.root"),
    ):
        (folder / "wrong.yaml").write_text(HEAD + part + TIMES)
        with pytest.raises(InputError, match=message):
            load_scene(folder / "wrong.yaml")
    with pytest.raises(InputError, match=r"parts\.wing\.bodies: found a flexible body, expected dimensions: 3"):
        read_scene("parts: {wing: {bodies: {arm: {type: flexible}}}}\nuse: {left: {part: wing}}\n" + TIMES)


@pytest.mark.parametrize("body", ["arm.frame", "arm.modes1", "{body: arm.frame, point: [0.1, 0, 0]}"])
def test_forces_on_the_frame_and_the_modes_are_refused(folder, body):
    """They would move the whole body, or its modal coordinates, without regard to its shapes."""
    text = REST.replace("MOUNT", "ground").replace("\n    ", "\n").replace("i: weight", f"i: {body}")
    (folder / "frame.yaml").write_text(HEAD + text + TIMES)
    with pytest.raises(
        InputError, match=r"forces\.spring\.i: found 'arm\.(frame|modes1)', .*interfaces \(arm\.root, arm\.tip\)"
    ):
        load_scene(folder / "frame.yaml")


@pytest.mark.parametrize("taken", ["frame", "modes1", "modes12"])
def test_an_interface_with_the_name_of_the_frame_or_of_modes_is_refused(folder, taken):
    """Its body would take the place of the modal coordinates, and the motion would be another one without a word."""
    text = (
        REST.replace("MOUNT", "ground")
        .replace("\n    ", "\n")
        .replace("tip: {", f"{taken}: {{")
        .replace("arm.tip", f"arm.{taken}")
    )
    (folder / "taken.yaml").write_text(HEAD + text + TIMES)
    with pytest.raises(InputError, match=rf"bodies\.arm\.interfaces: found '{taken}', the name of a part"):
        load_scene(folder / "taken.yaml")
