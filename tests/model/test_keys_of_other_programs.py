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
