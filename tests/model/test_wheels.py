"""Wheels of a described vehicle: sides, axles, corners, carriers; the same for all studies of cars."""

import json
import math

import numpy as np
import pytest

import stiffmbs
from stiffmbs.model.wheels import angular_of_joints, axle_at, corners, marked_or_tyred, wheel_of, wheels_of
from stiffmbs.studies.handling.car import car_of
from stiffmbs.studies.suspension.axle import axle_of
from stiffmbs.studies.suspension.vehicle import VehicleOptions, vehicle_of

TYRE = {"type": "fiala_tyre", "radius": 0.3, "stiffness": 2e5, "slip_stiffness": 6e4, "cornering_stiffness": 5e4,
        "mu_static": 1, "mu_sliding": 0.8}  # fmt: skip
AXIS_ALONG_Y = {"euler": "xyz", "angles": ["-90 deg", 0, 0]}


def cart(places, shafts=()):
    """Return a car without suspension: wheels on revolute joints at places, and those of some on a shaft too."""
    body = {"mass": 20, "inertia": [1, 1, 1]}
    joints, forces = {}, {}
    bodies = {"chassis": {**body, "mass": 900, "position": [0, 0, 0.5]}, "shaft": {**body, "position": [0, 0, 0.3]}}
    for name, (x, y) in places.items():
        bodies[name] = {**body, "position": [x, y, 0.3]}
        for carrier in ("chassis", *(["shaft"] if name in shafts else [])):
            joints[f"{name}_on_{carrier}"] = {
                "type": "revolute", "i": {"body": name, "orientation": AXIS_ALONG_Y},
                "j": {"body": carrier, "point": [x, y, 0.3 - bodies[carrier]["position"][2]], "orientation": AXIS_ALONG_Y},
            }  # fmt: skip
        forces[f"{name}_tyre"] = {**TYRE, "i": name}
    joints["guide"] = {"type": "prismatic", "i": "shaft", "j": {"body": "chassis", "point": [0, 0, -0.2]}}
    return stiffmbs.read_scene(json.dumps({"dimensions": 3, "bodies": bodies, "joints": joints, "forces": forces}))


CAR = {"d": (-1.3, -0.7), "b": (1.3, -0.75), "a": (1.3, 0.75), "c": (-1.3, 0.7)}


@pytest.mark.parametrize("scale", [1.0, 0.1])
def test_corners_are_those_of_the_places_of_any_size(scale):
    scene = cart({name: (scale * x, scale * y) for name, (x, y) in CAR.items()})
    found = corners(wheels_of(scene))
    names = {corner: wheel.body for corner, wheel in found.items()}
    assert names == {"front_left": "a", "front_right": "b", "rear_left": "c", "rear_right": "d"}
    assert {wheel.carrier for wheel in found.values()} == {"chassis"}
    assert all(
        wheel.contact[2] == pytest.approx(0.0) and wheel.tyre == f"{wheel.body}_tyre" for wheel in found.values()
    )
    assert {name: wheel.body for name, wheel in car_of(scene, steering="guide").wheels.items()} == names
    assert angular_of_joints(scene) == {**{f"{name}_on_chassis": True for name in CAR}, "guide": False}


def test_both_studies_have_the_same_wheels():
    scene = cart(CAR)
    of_car = car_of(scene, steering="guide").wheels
    for end in ("front", "rear"):
        of_axle = axle_of(scene, end).wheels
        assert [wheel.side for wheel in of_axle] == ["left", "right"]
        for wheel in of_axle:
            other = of_car[f"{end}_{wheel.side}"]
            assert (wheel.body, wheel.carrier, wheel.tyre) == (other.body, other.carrier, other.tyre)
            np.testing.assert_allclose(wheel.contact, other.contact, atol=1e-15)


def test_the_left_wheel_of_an_axle_is_first_in_any_order():
    """In another order, the roll angle was that of a vehicle upside down."""
    assert [wheel.body for wheel in axle_of(cart(CAR), "", wheels=["d", "c"]).wheels] == ["c", "d"]


def test_wheels_of_one_axle_are_next_to_each_other():
    places = {**CAR, "a": (1.3 + 0.2, 0.75)}
    scene = cart(places)
    assert [wheel.body for wheel in axle_at(wheels_of(scene), "front")] == ["a"]
    with pytest.raises(stiffmbs.InputError, match=r"found 1 tyres on the front axle \(a_tyre\), expected 2"):
        corners(wheels_of(scene))
    assert len(axle_at(wheels_of(cart({**CAR, "a": (1.3 + 0.1, 0.75)})), "front")) == 2
    two = {name: CAR[name] for name in "ab"}
    with pytest.raises(stiffmbs.InputError, match=r"found 2 tyres \(b_tyre, a_tyre\), expected the 4 of a car"):
        corners(wheels_of(cart({name: two[name] for name in "ba"})))


def test_a_wheel_on_two_bodies_has_the_first_as_carrier_and_no_place_on_the_rig():
    scene = cart(CAR, shafts="a")
    assert wheel_of(scene, "a").carriers == ("chassis", "shaft")
    assert car_of(scene, steering="guide").wheels["front_left"].carrier == "chassis"
    with pytest.raises(stiffmbs.InputError, match=r"bodies.a: found 2 revolute joints \(a_on_chassis, a_on_shaft\)"):
        axle_of(scene, "front")


def test_wheels_at_markers_are_counted_once(examples):
    scene = stiffmbs.load_scene(examples / "car.yaml")
    wheels = marked_or_tyred(scene)
    assert len(wheels) == 4 == len(wheels_of(scene))
    for wheel in wheels:
        other = next(one for one in wheels_of(scene) if one.carrier == wheel.carrier)
        assert math.dist(wheel.centre, other.centre) < 1e-9
        assert wheel.side == other.side


@pytest.mark.parametrize(("place", "front"), [(-2.7, True), (2.7, False)])
def test_a_marker_on_the_road_alone_is_a_wheel_of_another_axle(place, front):
    """The other axle may be a marker; without it, the position of the axle is an assumption."""
    chassis = {"mass": 900, "inertia": [1, 1, 1], "position": [0, 0, 0.5]}
    suspension = {"use": "macpherson", "on": "chassis", "position": [0, 0, -0.5]}
    content = {"dimensions": 3, "bodies": {"chassis": {**chassis, "markers": {"patch": {"point": [place, 0, -0.5]}}}}, "parts": {"front.left": suspension}}  # fmt: skip
    scene = stiffmbs.read_scene(json.dumps(content))
    found = vehicle_of(scene, axle_of(scene, "front"), VehicleOptions())
    assert (found.front, found.wheelbase) == (front, pytest.approx(2.7, abs=0.05))
    assert not any("axle" in one for one in found.assumed)
