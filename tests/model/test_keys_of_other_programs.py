"""Keys that other programs have, for axes and centres of mass: the message says what is written here."""

import pytest

import stiffmbs

SCENE = """
dimensions: 3
bodies: {{b: {{mass: 1, inertia: [1, 1, 1]}}}}
joints: {{pin: {{type: {kind}, i: b, j: {{body: ground{marker}}}{joint}}}}}
run: {{duration: 0.1}}
"""


@pytest.mark.parametrize("kind", ["revolute", "prismatic", "cylindrical"])
@pytest.mark.parametrize("key", ["axis", "direction"])
def test_an_axis_of_a_joint(kind, key):
    message = rf"joints.pin: found '{key}', expected the axis as z of the markers, such as j: .*z: \[0, 1, 0\]"
    with pytest.raises(stiffmbs.InputError, match=message):
        stiffmbs.read_scene(SCENE.format(kind=kind, marker="", joint=f", {key}: [0, 0, 1]"))


@pytest.mark.parametrize("key", ["axis", "z", "z_axis", "x_axis"])
def test_an_axis_of_a_marker(key):
    message = rf"joints.pin.j: found '{key}', expected orientation: {{[xz]: \[0, 1, 0\]}} or another direction"
    with pytest.raises(stiffmbs.InputError, match=message):
        stiffmbs.read_scene(SCENE.format(kind="revolute", marker=f", {key}: [0, 0, 1]", joint=""))


@pytest.mark.parametrize("key", ["center_of_mass", "centre_of_mass"])
def test_the_centre_of_mass_of_a_planar_body(key):
    with pytest.raises(
        stiffmbs.InputError, match=f"bodies.b: found '{key}', expected points of joints and forces relative"
    ):
        stiffmbs.read_scene(f"bodies: {{b: {{mass: 1, inertia: 1, {key}: [0.1, 0]}}}}")


@pytest.mark.parametrize(
    ("section", "name", "kind"),
    [
        ("joints", "hinge", "revolute"),
        ("joints", "translational", "prismatic"),
        ("joints", "weld", "fixed"),
        ("joints", "motor", "drive"),
        ("forces", "rotational_damper", "torsion_spring"),
        ("forces", "damper", "spring_damper"),
    ],
)
def test_kinds_that_other_programs_call_otherwise(section, name, kind):
    text = f"bodies: {{b: {{mass: 1, inertia: 1}}}}\n{section}: {{e: {{type: {name}, i: b, j: ground}}}}"
    with pytest.raises(stiffmbs.InputError, match=rf"found the type '{name}' \(did you mean '{kind}'\?\)"):
        stiffmbs.read_scene(text)


def test_an_initial_condition_within_a_joint():
    with pytest.raises(
        stiffmbs.InputError, match="found 'at_start', expected a drive of the joint in the section at_start"
    ):
        stiffmbs.read_scene(SCENE.format(kind="revolute", marker="", joint=", at_start: {rate: 1}"))
