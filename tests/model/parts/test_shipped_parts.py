"""Parts that come with the package, and what they are made with: vectors, options, further mounts."""

import json

import jsonschema
import numpy as np
import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs.commands.main import main
from stiffmbs.errors import InputError
from stiffmbs.model.parts.definitions import shipped_part, shipped_parts

CORNERS = ("double_wishbone", "macpherson", "trailing_arm", "multi_link")
LEVER = {
    "parameters": {"foot": [0, "0.1 m", 0], "head": [0, "0.3 m", "0.2 m"], "middle": "(foot + head)/2", "length": "0.1*head_y"},
    "mounts": {"other": "mount"},
    "bodies": {"bar": {"mass": 1, "inertia": [1, 1, 1], "center_of_mass": "middle"}},
    "joints": {"end": {"type": "spherical", "i": {"body": "bar", "point": "head"}, "j": {"body": "other", "point": "head"}}},
    "options": {
        "hold": {
            "soft": {"forces": {"foot_bush": {"type": "bushing", "i": {"body": "bar", "point": "foot"}, "j": {"body": "mount", "point": "foot"}, "stiffness": [1] * 6}}},
            "hard": {"joints": {"pin": {"type": "spherical", "i": {"body": "bar", "point": "foot"}, "j": {"body": "mount", "point": "foot"}}}},
        }
    },
}  # fmt: skip


def lever(use, changes=(), **sections):
    bodies = {
        "base": {"mass": 1, "inertia": [1, 1, 1]},
        "far": {"mass": 1, "inertia": [1, 1, 1], "position": [5, 6, 7], "orientation": {"euler": "zyx", "angles": [0.3, -0.2, 0.5]}},
    }  # fmt: skip
    found = {"dimensions": 3, "bodies": bodies, "parts": {"lever": LEVER}, "use": use, **sections}
    return stiffmbs.read_scene(json.dumps(found), changes)


def axle(part, word):
    entry = {"use": part, "compliance": word}
    parts = {"left": entry, "right": {**entry, "mirror": "y"}}
    return stiffmbs.read_scene(json.dumps({"dimensions": 3, "gravity": [0, 0, -9.81], "parts": parts}))


def test_a_vector_is_its_components():
    found = lever({"a": {"part": "lever", "parameters": {"head": [0.1, "400 mm", 0.2]}}})
    assert found.bodies["a.bar"].center_of_mass == pytest.approx((0.05, 0.25, 0.1))
    one = lever({"a": {"part": "lever", "parameters": {"head_y": "400 mm"}}})
    assert one.point(one.joints["a.end"].i) == pytest.approx((0, 0.4, 0.2))


@pytest.mark.parametrize(
    ("changed", "sentence"),
    [
        ({"parameters": {"head": 3}}, r"use\.a\.parameters\.head: found 3, expected a list of 3 numbers"),
        ({"parameters": {"head": [1, 2]}}, r"expected a list of 3 numbers"),
        ({"mounts": {"third": "base"}}, r"found no such mount of 'lever', expected one of other"),
        ({"mounts": {"other": "nothing"}}, r"mounts\.other: found 'nothing', expected mount, ground, a body"),
        ({"hold": "medium"}, r"use\.a\.hold: found 'medium', expected one of soft, hard"),
        (
            {"part": "leever"},
            r"found 'leever' \(did you mean 'lever'\?\), expected one of parts \(lever\), or of those that come with",
        ),
    ],
)
def test_what_a_use_gets_wrong_is_told(changed, sentence):
    with pytest.raises(InputError, match=sentence):
        lever({"a": {"part": "lever", **changed}})


@pytest.mark.parametrize("formula", ["foot*head", "foot + 1", "foot/head", "sin(foot)"])
def test_what_is_no_vector_is_refused(formula):
    with pytest.raises(InputError, match=r"parts\.lever\.parameters\.middle: found '.*', expected"):
        parts = {"lever": {**LEVER, "parameters": {**LEVER["parameters"], "middle": formula}}}
        lever({"a": {"part": "lever"}}, parts=parts)


def test_a_mount_that_stands_askew_carries_points_of_the_parts_frame():
    """The joint is closed as described: both markers are at the same place, mirrored or not."""
    for mirror in ({}, {"mirror": "y"}):
        found = lever({"a": {"part": "lever", "on": "base", "mounts": {"other": "far"}, **mirror}})
        joint = found.joints["a.end"]
        assert joint.j.body == "far"
        assert found.point(joint.i) == pytest.approx(found.point(joint.j), abs=1e-14)


def test_words_are_chosen_by_a_use_by_the_scene_and_from_outside():
    assert "a.foot_bush" in lever({"a": {"part": "lever"}}).forces
    assert "a.pin" in lever({"a": {"part": "lever", "hold": "hard"}}).joints
    both = {"a": {"part": "lever"}, "b": {"part": "lever", "hold": "soft"}}
    assert {"a.pin", "b.end"} <= lever(both, choose={"hold": "hard"}).joints.keys()
    assert "a.pin" in lever({"a": {"part": "lever"}}, [("choose.hold", "hard")]).joints
    assert "a.pin" in lever({"a": {"part": "lever"}}, [("use.a.hold", "hard")]).joints
    with pytest.raises(
        InputError, match=r"choose\.hald: found no such choice \(did you mean 'hold'\?\), expected one of hold"
    ):
        lever({"a": {"part": "lever"}}, choose={"hald": "hard"})


def test_a_change_of_what_an_alias_stands_for_changes_it_in_one_place():
    text = "dimensions: 3\nbodies:\n  a: &body {mass: 1, inertia: &i [1, 1, 1]}\n  b: {<<: *body}\n  c: *body\n"
    found = stiffmbs.read_scene(text, [("bodies.b.inertia.0", "1.5"), ("bodies.a.mass", "2")])
    assert [body.mass for body in found.bodies.values()] == [2, 1, 1]
    assert [body.inertia[0][0] for body in found.bodies.values()] == [1, 1.5, 1]


def test_options_of_a_scene_are_chosen_by_words():
    options = {"push": {"weak": {"forces": {"f": {"type": "force", "i": "base", "force": [1, 0, 0]}}}, "none": None}}
    assert "f" in lever({}, options=options).forces
    assert "f" not in lever({}, options=options, choose={"push": "none"}).forces
    twice = {"push": {"weak": {"bodies": {"base": {"mass": 1}}}}}
    with pytest.raises(InputError, match=r"options\.push\.weak\.bodies\.base: found a name that stands outside"):
        lever({}, options=twice)


@pytest.mark.parametrize("word", ["rigid", "bushing"])
@pytest.mark.parametrize("part", CORNERS)
def test_left_and_right_are_mirror_images(part, word):
    found = axle(part, word)
    left = {name.removeprefix("left."): body for name, body in found.bodies.items() if name.startswith("left.")}
    for name, body in left.items():
        right = found.bodies[f"right.{name}"]
        assert np.multiply(body.position, (1, -1, 1)) == pytest.approx(right.position)
    for elements in (found.joints, found.forces):
        for name, element in elements.items():
            if name.startswith("left."):
                there = elements[f"right.{name.removeprefix('left.')}"]
                for here, other in ((element.i, there.i), (element.j, there.j)):
                    assert np.multiply(found.point(here), (1, -1, 1)) == pytest.approx(found.point(other), abs=1e-14)
    for joint in found.joints.values():  # drawn closed
        assert found.point(joint.i) == pytest.approx(found.point(joint.j), abs=1e-12) or joint.kind == "cylindrical"


@pytest.mark.long
@pytest.mark.parametrize("part", CORNERS)
def test_a_rigid_corner_has_its_travel_and_the_wheels_spin(part):
    report = stiffmbs.check(axle(part, "rigid"))
    assert report.degrees_of_freedom == 4
    assert not report.redundant


@pytest.mark.long
def test_every_part_is_a_valid_scene_by_itself_and_is_listed():
    for name in shipped_parts():
        mounts = {mount: f"of_{mount}" for mount in shipped_part(name).get("mounts") or {}}
        for word in ("rigid", "bushing") if "compliance" in (shipped_part(name).get("options") or {}) else (None,):
            entry = {"use": name, "on": "base", "mounts": mounts, **({"compliance": word} if word else {})}
            bodies = {body: {"mass": 1, "inertia": [1, 1, 1]} for body in ("base", "rack", *mounts.values())}
            steering = mounts.get("steering", "free")  # the mount of this name is a joint
            bodies.pop(steering, None)
            joints = {steering: {"type": "prismatic", "i": "rack", "j": "base"}}
            stiffmbs.read_scene(
                json.dumps({"dimensions": 3, "bodies": bodies, "joints": joints, "parts": {"one": entry}})
            )
    listed = json.loads(CliRunner().invoke(main, ["parts", "--json"]).output)["parts"]
    assert listed.keys() == set(shipped_parts())
    assert "lower_ball" in CliRunner().invoke(main, ["parts", "double_wishbone"]).output
    assert CliRunner().invoke(main, ["parts", "wishbones"]).exit_code == 2


def test_the_schema_knows_parts_that_are_placed_at_once():
    schema = jsonschema.Draft202012Validator(stiffmbs.scene_schema())
    scene = {
        "dimensions": 3,
        "parts": {"left": {"use": "strut", "compliance": "rigid", "parameters": {"seat": [0, 0, 0.1]}}},
    }
    schema.validate(scene)
    assert not schema.is_valid({**scene, "parts": {"left": {"use": "strut", "position": "here"}}})


PLACED_AT_ONCE = """
dimensions: 3
bodies: {car: {mass: 1, inertia: [1, 1, 1]}}
parts:
  left:
    use: double_wishbone
    on: car
    compliance: rigid
"""


@pytest.mark.parametrize(
    ("old", "new", "changes", "message"),
    [
        ("rigid", "soft", (), r"line 8, parts\.left\.compliance: found 'soft', expected one of bushing, rigid"),
        (
            "compliance",
            "complianc",
            (),
            r"line 5, parts\.left: found the unknown key 'complianc' \(did you mean 'compliance'\?\), .*, compliance",
        ),
        ("rigid", "rigid", (("parts.left.compliance", "soft"),), r"--set parts\.left\.compliance: found 'soft'"),
    ],
)
def test_what_is_wrong_in_a_part_that_is_placed_at_once_is_told_with_its_line(old, new, changes, message):
    with pytest.raises(InputError, match=message):
        stiffmbs.read_scene(PLACED_AT_ONCE.replace(old, new), changes)


@pytest.mark.parametrize("steering", ["none", "kingpins"])
def test_a_rigid_axle_on_rigid_leaf_springs_is_no_singular_mechanism(steering):
    """It heaves, rolls, winds up, and moves sideways against the axial stiffness of the eyes; wheels spin, a pitman arm steers."""
    entry = {"rear": {"use": "rigid_axle", "compliance": "rigid", "steering": steering}}
    report = stiffmbs.check(stiffmbs.read_scene(json.dumps({"dimensions": 3, "parts": entry})))
    assert report.degrees_of_freedom == (4 if steering == "none" else 5) + 2
    assert not report.redundant
    assert not [message for message in report.messages if "singular" in message]
