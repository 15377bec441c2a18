"""Measures of axles in closed form, cases that do not apply, and wheels that are found by their tyres."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs.commands.main import main
from stiffmbs.errors import InputError
from stiffmbs.show.suspension import kc_text
from stiffmbs.studies.suspension.axle import axle_of
from stiffmbs.studies.suspension.vehicle import VehicleOptions, vehicle_of

NONE = dict.fromkeys(
    ("bump", "roll", "steer", "lateral", "lateral_parallel", "brake", "traction", "aligning", "aligning_parallel"), 0
)
STRAIGHT = {"pivot_outer": [0.42, 0.66, 0.28], "pivot_inner": [0.42, 0.36, 0.28]}


def scene(parts, **sections):
    return stiffmbs.read_scene(json.dumps({"dimensions": 3, "gravity": [0, 0, -9.81], "parts": parts, **sections}))


def corner(part, word="rigid", **parameters):
    return {"use": part, "compliance": word, "parameters": parameters}


def measures(read, *arguments, **named):
    return stiffmbs.kinematics_and_compliance(read, *arguments, **{**NONE, **named}).measures


@pytest.mark.long
def test_anti_lift_and_anti_squat_of_a_trailing_arm():
    """Geometric support is the slope from the contact, or from the centre of the wheel, to the pivot: 0.28 and -0.02 over 0.42."""
    chassis = {"chassis": {"mass": 1000, "inertia": [300, 1000, 1000], "position": [1, 0, 0.5]}}
    entry = {**corner("trailing_arm", **STRAIGHT), "on": "chassis", "position": [-1, 0, -0.5]}
    front = {**entry, "position": [1.4, 0, -0.5]}
    parts = {f"{name}.{side}": {**each, **({"mirror": "y"} if side == "right" else {})} for name, each in (("front", front), ("rear", entry)) for side in ("left", "right")}  # fmt: skip
    given = {"wheelbase": 2.5, "cg_height": 0.5}
    found = measures(
        scene(parts, bodies=chassis), "rear", vehicle=stiffmbs.VehicleOptions(**given, brake_share=0.4, drive_share=1)
    )
    assert found["left.anti_lift"] == pytest.approx(100 * 0.4 * 0.28 / 0.42 * 2.5 / 0.5, rel=1e-9)
    assert found["left.anti_squat"] == pytest.approx(100 * -0.02 / 0.42 * 2.5 / 0.5, rel=1e-9)
    assert found["left.brake_angle"] == pytest.approx(-np.degrees(np.arctan(0.28 / 0.42)))
    assert found["axle.roll_centre_height"] == pytest.approx(0, abs=1e-9)
    rate = found["left.wheel_rate"] * 1e3
    assert found["axle.roll_rate"] == pytest.approx(np.radians(rate * 1.52**2 / 2), rel=1e-9)
    own = measures(scene(parts, bodies=chassis), "rear")
    assert own["left.anti_squat"] / own["left.anti_lift"] == pytest.approx(-0.02 / (0.4 * 0.28)), (
        "wheelbase of the scene"
    )
    inboard = stiffmbs.VehicleOptions(**given, brake_share=0.4, inboard_brakes=True, outboard_drive=True)
    found = measures(scene(parts, bodies=chassis), "rear", vehicle=inboard)
    assert found["left.anti_lift"] == pytest.approx(100 * 0.4 * -0.02 / 0.42 * 5)
    assert found["left.anti_squat"] == pytest.approx(100 * 0.28 / 0.42 * 5)


def test_bodies_that_are_not_connected_do_not_change_the_centre_of_mass():
    """A heavy barrier on the ground, high above the wheels, is no part of the vehicle; ballast on its body is."""
    chassis = {"mass": 1000, "inertia": [300, 1000, 1000], "position": [1, 0, 0.5]}
    other = {"mass": 5000, "inertia": [1, 1, 1], "position": [50, 30, 4]}
    entry = {**corner("trailing_arm", **STRAIGHT), "on": "chassis", "position": [-1, 0, -0.5]}
    parts = {"rear.left": entry, "rear.right": {**entry, "mirror": "y"}}

    def height(bodies, joints):
        read = scene(parts, bodies={"chassis": chassis, **bodies}, joints=joints)
        return vehicle_of(read, axle_of(read, "rear"), VehicleOptions()).height

    alone, at = height({}, {}), {"point": [49, 30, 3.5]}
    weld = {"i": "other", "j": {"body": "chassis", **at}, "type": "fixed"}
    assert height({"other": other}, {"base": {**weld, "j": {"body": "ground", "point": [50, 30, 4]}}}) == alone
    assert height({"other": other}, {"base": weld}) > alone + 1


@pytest.mark.long
def test_an_axle_alone_has_its_anti_measures_by_its_name():
    """Wheelbase and height were given, and the message said that there was 'no wheelbase and height'."""
    chassis = {"chassis": {"mass": 1000, "inertia": [300, 1000, 1000], "position": [1, 0, 0.5]}}
    entry = {**corner("trailing_arm", **STRAIGHT), "on": "chassis", "position": [-1, 0, -0.5]}

    def measured(name, **given):
        parts = {f"{name}.left": entry, f"{name}.right": {**entry, "mirror": "y"}}
        model, vehicle = scene(parts, bodies=chassis), stiffmbs.VehicleOptions(**given)
        return stiffmbs.kinematics_and_compliance(model, name, vehicle=vehicle, **NONE)

    rear = measured("rear", wheelbase=2.5, cg_height=0.5)
    assert rear.measures["left.anti_squat"] == pytest.approx(100 * -0.02 / 0.42 * 2.5 / 0.5, rel=1e-9)
    assert rear.vehicle.assumed[0] == "the rear axle"
    assert "wheelbase 2.5 m, centre of mass at 0.5 m; assumed: the rear axle, brake share 0.4" in kc_text("car", rear)
    assert "left.anti_dive" in measured("front", wheelbase=2.5, cg_height=0.5).measures
    text = kc_text("car", measured("middle", wheelbase=2.5, cg_height=0.5))
    assert "as these are unknown: position as front or rear axle" in text
    assert "wheelbase (" not in text
    assert "as these are unknown: wheelbase (--wheelbase)\n" in kc_text("car", measured("rear"))


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize("part", ["double_wishbone", "multi_link"])
def test_compliance_is_symmetric_and_contains_the_wheel_rate(part):
    """Maxwell and Betti; both wheels under 1 N go down by the inverse of the wheel rate in bump."""
    parts = {"left": corner(part, "bushing"), "right": {**corner(part, "bushing"), "mirror": "y"}}
    found = stiffmbs.kinematics_and_compliance(scene(parts), "", **{**NONE, "bump": 1, "lateral": 0.1})
    for matrix in (found.compliance.centre, found.compliance.contact):
        assert np.allclose(matrix, matrix.T, rtol=1e-6, atol=1e-12)
        assert np.all(np.linalg.eigvalsh(matrix) > -1e-12)
    contact = found.compliance.contact
    bump, lateral = found.sweeps["bump"], found.sweeps["lateral"]
    middle = bump.channels["left.wheel_rate"][5] * np.gradient(bump.channels["left.travel"])[5] / 0.2
    assert 1e-3 / (contact[2, 2] + contact[2, 8]) == pytest.approx(middle, rel=1e-6)
    held = contact[1, 1] - contact[1, 2] * contact[2, 1] / contact[2, 2]  # the pad holds the height
    assert lateral.slope("left.lateral") == pytest.approx(1e6 * held, rel=1e-3)


@pytest.mark.long
def test_a_single_corner_has_no_measures_of_an_axle():
    found = stiffmbs.kinematics_and_compliance(scene({"front.left": corner("macpherson")}), points=5)
    assert set(found.sweeps) == {"bump", "lateral", "brake", "traction", "aligning"}
    assert not [name for name in found.measures if name.startswith(("axle.", "right."))]
    both = {"front.left": corner("macpherson"), "front.right": {**corner("macpherson"), "mirror": "y"}}
    two = measures(scene(both))
    for name, value in found.measures.items():
        assert two[name] == pytest.approx(value, rel=1e-9, abs=1e-9)
    assert "left.caster" not in two, "nothing steers"


TYRE = {"type": "fiala_tyre", "radius": 0.30, "stiffness": 2e5, "slip_stiffness": 6e4, "cornering_stiffness": 5e4,
        "mu_static": 1, "mu_sliding": 0.8}  # fmt: skip


@pytest.mark.long
def test_wheels_are_found_by_their_tyres():
    """Suspensions whose bodies have other names: the same measures from tyres and hubs, and from the names of the wheels."""
    parts = {"front.left": corner("double_wishbone"), "front.right": {**corner("double_wishbone"), "mirror": "y"}}
    forces = {f"{side}_tyre": {**TYRE, "i": f"front.{side}.wheel"} for side in ("left", "right")}
    text = json.dumps({"dimensions": 3, "gravity": [0, 0, -9.81], "parts": parts, "forces": forces})
    named = measures(stiffmbs.read_scene(text))
    other = {
        f"nose.{name.removeprefix('front.')}" if name.startswith("front.") else name: each
        for name, each in parts.items()
    }
    renamed = json.dumps({"dimensions": 3, "gravity": [0, 0, -9.81], "parts": other, "forces": {name: {**each, "i": each["i"].replace("front.", "nose.")} for name, each in forces.items()}})  # fmt: skip
    for arguments in ({"axle": "front"}, {"wheels": ["nose.left.wheel", "nose.right.wheel"]}):
        found = measures(stiffmbs.read_scene(renamed), **arguments)
        for name, value in found.items():
            if "motion_ratio" not in name:
                assert value == pytest.approx(named[name], rel=1e-9, abs=1e-9)
        assert found["left.motion_ratio.nose.left.strut.strut"] == pytest.approx(named["left.motion_ratio.strut.strut"])


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"wheels": ["hull"]}, r"found no body 'hull', expected the body of a wheel"),
        ({"wheels": ["front.left.upright"]}, r"expected the radius of the wheel|found . revolute joints"),
        ({"wheels": ["front.left.wheel"], "radius": "0.3 m"}, r"radius: found '0\.3 m', expected a length above zero"),
        ({"wheels": ["front.left.wheel"], "radius": -0.3}, r"radius: found -0\.3, expected a length above zero"),
        ({"wheels": ["front.left.wheel"]}, r"front\.left\.wheel: found no tyre with a radius"),
        ({"steering": "front.right.hub", "wheels": ["front.left.wheel"], "radius": 0.3}, r"found the joint 'front\.right\.hub' on other bodies"),
    ],
)  # fmt: skip
def test_wheels_that_are_not_there_are_told(given, sentence):
    parts = {"front.left": corner("macpherson"), "front.right": {**corner("macpherson"), "mirror": "y"}}
    with pytest.raises(InputError, match=sentence):
        measures(scene(parts), **given)


@pytest.mark.parametrize("given", [{"wheelbase": -1}, {"cg_height": float("nan")}, {"brake_share": 1.5}])
def test_numbers_of_the_vehicle_are_checked(given):
    with pytest.raises(InputError, match=f"{next(iter(given))}: found"):
        stiffmbs.VehicleOptions(**given)


def test_a_wheel_that_points_elsewhere_is_refused():
    turned = {"orientation": {"euler": "zyx", "angles": [1.5, 0, 0]}}
    parts = {f"front.{side}": {**corner("macpherson"), **turned, **({"mirror": "y"} if side == "right" else {})} for side in ("left", "right")}  # fmt: skip
    with pytest.raises(InputError, match="expected it along y, to the left"):
        measures(scene(parts))


@pytest.mark.long
def test_the_command_prints_one_object_with_all_measures(tmp_path):
    parts = {"front.left": corner("macpherson"), "front.right": {**corner("macpherson"), "mirror": "y"}}
    file = tmp_path / "axle.yaml"
    file.write_text(json.dumps({"dimensions": 3, "parts": parts}))
    arguments = ["kc", str(file), "--points", "5", "--wheelbase", "2.6", "--cg-height", "0.5", "--json"]
    for name in NONE:
        arguments += ["--case", f"{name}={5 if name == 'bump' else 0}"]
    found = json.loads(CliRunner().invoke(main, arguments).output)
    assert found["vehicle"]["wheelbase"] == 2.6
    assert found["measures"]["left.fvsa_length"]["unit"] == "mm"
    assert np.shape(found["compliance"]["contact"]) == (12, 12)
    assert CliRunner().invoke(main, [*arguments, "--brake-share", "3"]).exit_code == 2


@pytest.mark.long
def test_the_radius_follows_from_a_property_file(examples):
    found = measures(examples / "car.yaml", wheels=["front.left.wheel", "front.right.wheel"], bump=5)
    assert found["axle.track"] == pytest.approx(1520, abs=1)
    assert found["left.brake_angle"] != found["left.drive_angle"]
