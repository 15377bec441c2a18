"""Simscape Multibody XML of CAD programs: freedoms, motions against equations by hand, and messages."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.cad.load import is_cad, load_cad
from stiffmbs.errors import InputError
from stiffmbs.model.read_scene import read_scene

from .simscape_files import BASE, CART, UNITS, constraint, document, instance, joint, part, shape

DOWN = [("gravity", "[0, -9.81, 0]")]


def _read(tmp_path, text, changes=()):
    path = tmp_path / "rig.xml"
    path.write_text(text, encoding="utf-8")
    return load_cad(path, changes)


def test_a_cart_with_a_pendulum_has_two_freedoms_and_redundant_mates(tmp_path):
    """14 equations of 4 mates, of rank 10, and 6 of the grounded base; four names of mates are reported."""
    report = stiffmbs.check(_read(tmp_path, CART))
    assert report.degrees_of_freedom == 2
    assert (report.equations, report.rank) == (20, 16)
    assert {joint for joint, _ in report.redundant} <= {"rail", "track", "pin", "face"}


def test_a_cart_with_a_pendulum_accelerates_as_by_hand(tmp_path):
    """A bob of 2 kg stands upright at 0.1 m above the pin; its moment is 0.03 kg m^2, and the cart accelerates by -1 m/s^2."""
    push = ("joints.push", "{type: drive, coordinate: cart.x, velocity: -t}")
    run = stiffmbs.run(_read(tmp_path, CART, [*DOWN, push]), duration=1e-6, points=2)
    assert run["bob.wdz"][0] == pytest.approx(-2 * 0.1 * 1 / (0.03 + 2 * 0.1**2), rel=1e-6)


def test_mates_are_held_and_energy_is_kept(tmp_path):
    """The bob falls over; the drawn cart moves along x alone, and the bob in its plane."""
    run = stiffmbs.run(_read(tmp_path, CART, [*DOWN, ("bodies.bob.omega", "[0, 0, 1]")]), duration=1, rtol=1e-8)
    assert max(run["constraint.position"]) < 1e-11
    np.testing.assert_allclose(run["cart.z"], 0.2, atol=1e-12)
    np.testing.assert_allclose(run["bob.z"], 0.2, atol=1e-12)
    assert np.ptp(run["cart.x"]) > 0.01
    np.testing.assert_allclose(run["energy.total"], run["energy.total"][0], rtol=1e-6)


def test_units_of_the_file_are_converted(tmp_path):
    """Without units of the data, those of the model count: g and mm here, as Creo writes kg and mm."""
    units = '<ModelUnits mass="gram" length="millimeter"/>'
    text = document(
        instance("bob", "arm", "100 0 0"),
        parts=part("arm", "2000", "100 0 0", "1e7 2e7 3e7 0 0 1e6", units),
        units=units,
    )
    body = _read(tmp_path, text).bodies["bob"]
    assert body.mass == pytest.approx(2) and tuple(body.position) == pytest.approx((0.1, 0, 0))
    assert tuple(body.center_of_mass) == pytest.approx((0.1, 0, 0))
    np.testing.assert_allclose(body.inertia, [[0.01, 0.001, 0], [0.001, 0.02, 0], [0, 0, 0.03]])


def test_products_of_inertia_are_entries_of_the_tensor_in_their_order(tmp_path):
    """yz, zx, xy, as in smimport's Product of Inertia."""
    text = document(instance("bob", "arm"), parts=part("arm", inertia="0.05 0.06 0.07 0.001 0.002 0.003"))
    np.testing.assert_allclose(
        _read(tmp_path, text).bodies["bob"].inertia, [[0.05, 0.003, 0.002], [0.003, 0.06, 0.001], [0.002, 0.001, 0.07]]
    )


SHAPES = {
    "point": ("0.1 0.2 0.3", ""), "sphere": ("0.1 0.2 0.3", ""), "line": ("0.1 0.2 0.3", "0 0 1"), "cylinder": ("0.1 0.2 0.3", "0 0 -1"),
    "cone": ("0.1 0.2 0.3", "0 0 1"), "plane": ("0.1 0.2 0.3", "0 0 1"), "across": ("0.1 0.2 0.3", "1 0 0"),
    "tilted": ("0.1 0.2 0.3", "0 0.6 0.8"), "circle": ("0.1 0.2 0.3", "0 0 1"), "above": ("0.1 0.2 0.7", "0 0 1"),
    "beside": ("0.4 0.6 0.9", "0 0 1"), "beside point": ("0.4 0.6 0.3", ""),
}  # fmt: skip
"""Shapes of a part at the origin; those that are no kind of the files are planes, lines or points."""
KINDS = {"across": "line", "tilted": "plane", "above": "plane", "beside": "line", "beside point": "point"}


@pytest.mark.parametrize(
    ("mate", "one", "other", "kinds", "freedoms"),
    [
        ("Coincident", "point", "point", ["spherical"], 3),
        ("Coincident", "line", "point", ["point_on_line"], 4),
        ("Coincident", "plane", "sphere", ["point_on_plane"], 5),
        ("Coincident", "line", "cylinder", ["cylindrical"], 2),
        ("Coincident", "across", "plane", ["point_on_plane", "perpendicular"], 4),
        ("Coincident", "plane", "plane", ["planar"], 3),
        ("Coincident", "plane", "circle", ["planar"], 3),
        ("Coincident", "circle", "circle", ["revolute"], 1),
        ("Concentric", "cone", "circle", ["cylindrical"], 2),
        ("Concentric", "cylinder", "sphere", ["point_on_line"], 4),
        ("Parallel", "plane", "plane", ["parallel"], 4),
        ("Parallel", "across", "plane", ["perpendicular"], 5),
        ("Perpendicular", "line", "plane", ["parallel"], 4),
        ("Perpendicular", "line", "across", ["perpendicular"], 5),
        ("Angle", "plane", "tilted", ["equation"], 5),
        ("Angle", "line", "cylinder", ["parallel"], 4),
        ("Angle", "line", "across", ["perpendicular"], 5),
        ("Distance", "plane", "above", ["planar"], 3),
        ("Distance", "point", "above", ["point_on_plane"], 5),
        ("Distance", "across", "above", ["point_on_plane", "perpendicular"], 4),
        ("Distance", "point", "beside point", ["distance"], 5),
        ("Distance", "point", "beside", ["equation"], 5),
        ("Distance", "line", "beside", ["equation", "parallel"], 3),
        ("Distance", "line", "cylinder", ["cylindrical"], 2),
    ],
)  # fmt: skip
def test_each_mate_is_the_joint_that_it_is(tmp_path, mate, one, other, kinds, freedoms):
    """The drawn pose satisfies the joints, and the part has the freedoms that the mate leaves."""
    ends = [shape(KINDS.get(name, name), uid, *SHAPES[name]) for name, uid in ((one, "base"), (other, "bob"))]
    text = document(BASE + instance("bob", "arm"), constraint(mate, "m", *ends), parts=part("block") + part("arm"))
    scene = _read(tmp_path, text)
    assert [found.kind for name, found in scene.joints.items() if name.startswith("m")] == kinds
    report = stiffmbs.check(scene)
    assert report.degrees_of_freedom == freedoms
    assert not any("assembly changed" in line for line in report.messages)


@pytest.mark.parametrize(
    ("kind", "freedoms"),
    [
        ("Weld", 0),
        ("Revolute", 1),
        ("Prismatic", 1),
        ("Cylindrical", 2),
        ("Spherical", 3),
        ("Planar", 3),
        ("PinSlot", 2),
    ],
)
def test_joints_of_onshape_leave_their_freedoms(tmp_path, kind, freedoms):
    text = document(
        BASE + instance("bob", "arm", "0.1 0 0"),
        joints=joint(kind, "j", "base", "bob", "0.1 0.2 0", "0 0.2 0"),
        parts=part("block") + part("arm"),
    )
    scene = _read(tmp_path, text)
    assert stiffmbs.check(scene).degrees_of_freedom == freedoms
    if kind == "PinSlot":
        run = stiffmbs.run(scene, duration=1e-6, points=2)  # the slot along x carries the weight along z
        assert run["bob.az"][0] == pytest.approx(0, abs=1e-9)


NESTED = instance(
    "hand",
    "gripper",
    "0 0 1",
    "0 -1 0 1 0 0 0 0 1",
    instance("palm", "arm", "0.1 0 0", grounded="true") + instance("tip", "arm", "0.1 0.2 0"),
)
GRIPPER = '<Assembly name="gripper" uid="gripper"><Constraints/><Joints>' + joint("Revolute", "knuckle", "palm", "tip", "0 0.2 0", "0 0 0") + "</Joints></Assembly>"  # fmt: skip


def test_joints_of_a_subassembly_are_in_each_of_its_instances(tmp_path):
    """A hand turned by 90 deg about z at z = 1, with a tip on its palm; a joint to the hand is one to its palm."""
    second = NESTED.replace('"hand"', '"other"').replace("<Translation>0 0 1<", "<Translation>0 0 2<")
    text = document(
        BASE + NESTED + second, joints=joint("Weld", "wrist", "base", "hand", "0 0 1", "0 0 0"),
        parts=part("block") + part("arm"), assemblies=GRIPPER,
    )  # fmt: skip
    with pytest.raises(InputError, match=r"wrist.*degrees apart"):
        _read(tmp_path, text)
    scene = _read(tmp_path, text.replace("Weld", "Spherical"))
    assert tuple(scene.bodies["hand_tip"].position) == pytest.approx((-0.2, 0.1, 1))
    assert scene.joints["hand_knuckle"].kind == scene.joints["other_knuckle"].kind == "revolute"
    assert stiffmbs.check(scene).degrees_of_freedom == 3 + 1 + 6 + 1


@pytest.mark.parametrize("how", ["rigid", "group", "grounded"])
def test_instances_of_one_rigid_body_are_fixed_to_each_other(tmp_path, how):
    attributes = {"rigidGroup": "g"} if how == "group" else {"grounded": "true"} if how == "grounded" else {}
    below = instance("a", "arm", "0.1 0 0", **attributes) + instance("b", "arm", "0.1 0.2 0", **attributes)
    whole = {"rigid": "true"} if how == "rigid" else {}
    scene = _read(tmp_path, document(instance("sub", "assembly", below=below, **whole), parts=part("arm")))
    assert stiffmbs.check(scene).degrees_of_freedom == 6
    assert [one.kind for one in scene.joints.values()] == ["fixed"]


@pytest.mark.parametrize(
    ("mates", "joints", "words"),
    [
        (constraint("Tangent", "cam", shape("plane", "base", "0 0 0", "0 0 1"), shape("cylinder", "bob", "0 0 0", "1 0 0")), "", "left out (Tangent of line and plane is not supported): cam"),
        ('<UnknownConstraint name="Lock3"><ConstraintGeometry geomType="Unknown"/></UnknownConstraint>', "", "left out (the export does not describe them): Lock3"),
        (constraint("Coincident", "own", shape("point", "bob", "0 0 0"), shape("point", "bob", "0 0 0")), "", "left out (both ends are on one rigid body): own"),
        ("", joint("Gear", "mesh", "base", "bob"), "left out (Gear joints are not supported): mesh"),
    ],
)  # fmt: skip
def test_mates_that_are_not_held_are_noted(tmp_path, mates, joints, words):
    text = document(BASE + instance("bob", "arm"), mates, joints, part("block") + part("arm"))
    assert any(words in note for note in _read(tmp_path, text).notes)


def test_parts_without_mass_and_mates_are_left_out(tmp_path):
    skeleton = part("skeleton", "0", "0 0 0", "0 0 0 0 0 0")
    text = document(BASE + instance("planes", "skeleton"), parts=part("block") + skeleton)
    scene = _read(tmp_path, text)
    assert list(scene.bodies) == ["base"]
    assert "parts with neither mass nor mates are left out: planes" in scene.notes


def test_names_without_letters_of_scenes_have_a_word(tmp_path):
    text = CART.replace('"rail"', '"同心1"').replace('"cart"', '"小车"').replace("<Uid>cart<", "<Uid>小车<")
    scene = _read(tmp_path, text)
    assert any(name.startswith("part_") for name in scene.bodies) and any(
        name.startswith("Concentric_") for name in scene.joints
    )


def test_instances_of_one_label_are_different_parts(tmp_path):
    """A slash in a name, and names with the uid of another instance."""
    named = [
        ("a", "1", "1 0 0"),
        ("a_2", "9", "2 0 0"),
        ("a", "2", "3 0 0"),
        ("s/a", "5", "4 0 0"),
        ("s", "6", "5 0 0"),
    ]
    alike = "".join(
        instance(uid, "arm", place).replace(f'name="{uid}"', f'name="{name}"') for name, uid, place in named[:4]
    )
    nested = instance("s", "assembly", "5 0 0", below=instance("a", "arm"))
    scene = _read(tmp_path, document(alike + nested, parts=part("arm")))
    assert [body.position[0] for body in scene.bodies.values()] == [1, 2, 3, 4, 5]


def test_parts_that_move_as_one_are_fixed_once(tmp_path):
    """A rigid subassembly in a rigid one; and grounded parts of one group. Loops of fixed joints have no unique reactions."""
    inner = instance("in", "I", below=instance("a", "arm") + instance("b", "arm", "0 1 0"), rigid="true")
    nested = instance("out", "O", below=inner + instance("c", "arm", "1 0 0"), rigid="true")
    both = {"grounded": "true", "rigidGroup": "g"}
    grounded = instance("base", "block", **both) + instance("lid", "block", "0 0 1", **both)
    for instances, bodies, freedoms in ((nested, 3, 6), (grounded, 2, 0)):
        scene = _read(tmp_path, document(instances, parts=part("arm") + part("block")))
        assert len(scene.bodies) == bodies and stiffmbs.check(scene).degrees_of_freedom == freedoms
        assert len(scene.joints) == 2


@pytest.mark.parametrize("how", [{"grounded": "true"}, {"rigidGroup": "g"}])
def test_a_subassembly_without_a_fixed_part_is_not_fixed_and_said_to_be_free(tmp_path, how):
    below = instance("a", "arm") + instance("b", "arm", "0 1 0")
    fixed = instance("base", "arm", rigidGroup="g")
    free, held = (
        _read(tmp_path, document(fixed + instance("out", "O", below=below, **how, **more), parts=part("arm")))
        for more in ({}, {"rigid": "true"})
    )
    assert any("no part is fixed" in note and "out" in note for note in free.notes)
    assert not any("no part is fixed" in note for note in held.notes)


def test_a_path_is_that_of_an_instance_before_the_assembly(tmp_path):
    """An instance with the uid of the assembly in which it is."""
    instances = BASE + instance("rig", "arm")
    scene = _read(
        tmp_path, document(instances, joints=joint("Revolute", "j", "base", "rig"), parts=part("block") + part("arm"))
    )
    assert stiffmbs.check(scene).degrees_of_freedom == 1


@pytest.mark.parametrize("text", ["true", "True", "1"])
def test_a_grounded_instance_is_fixed_however_it_is_written(tmp_path, text):
    scene = _read(tmp_path, document(instance("base", "block", grounded=text), parts=part("block")))
    assert [one.kind for one in scene.joints.values()] == ["fixed"]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('grounded="true"', 'grounded="yes"', "instance base: found grounded='yes', expected true or false"),
        ("</InstanceTree>", "<Instance uid='x'>" * 1500 + "</Instance>" * 1500 + "</InstanceTree>", "nested too deeply"),
        ("<Uid>bob</Uid>", "<Uid>bab</Uid>", "constraint pin: found the path bab, expected the uids of an instance"),
        ("SimscapeMultibodyImportXML", "PhysicalModelingXMLFile", "of the first generation, which is not supported; export the assembly again"),
        ("<Mass>2</Mass>", "<Mass>two</Mass>", "part arm: found <Mass> 'two', expected a number"),
        ("<Mass>2</Mass>", "<Mass>-2</Mass>", "part arm: found a mass of -2 kg"),
        ("0.01 0.02 0.03 0 0 0", "-0.01 0.02 0.03 0 0 0", "part block: found the principal moments"),
        ("<Axis>-2 0 0</Axis>", "<Axis>0 0 0</Axis>", "constraint rail: found an axis of length 0"),
        ("0 -1 0 1 0 0 0 0 1", "0 1 0 1 0 0 0 0 1", "instance bob: found .* expected a rotation matrix"),
        ('length="meter"', 'length="parsec"', "the file: found the unit of length 'parsec', expected one of meter"),
        ('uid="cart"', 'uid="bob"', "instance bob: found the uid 'bob' twice, expected a unique one"),
        ("</Parts>", "", "no well-formed XML"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_named(tmp_path, old, new, message):
    assert old in CART
    with pytest.raises(InputError, match=message):
        _read(tmp_path, CART.replace(old, new))


def test_a_converted_file_is_the_same_scene(tmp_path):
    from stiffmbs.cad.load import convert_cad

    scene = _read(tmp_path, CART)
    assert read_scene(convert_cad(tmp_path / "rig.xml")).bodies == scene.bodies


def test_other_xml_files_are_robots(tmp_path):
    (tmp_path / "robot.xml").write_text("<mujoco/>")
    (tmp_path / "rig.xml").write_text(CART)
    assert is_cad(tmp_path / "rig.xml") and not is_cad(tmp_path / "robot.xml")
    assert stiffmbs.load_scene(tmp_path / "rig.xml").name == "rig"
    assert UNITS in CART
