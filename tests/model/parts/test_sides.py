"""Suspensions and tyres of the left on the right side of a car: refused, or noted, and nothing where the side is right."""

import json

import numpy as np
import pytest

import stiffmbs
from stiffmbs.elements.tyres.names import COEFFICIENTS_6, ONE_SIDED
from stiffmbs.errors import InputError
from stiffmbs.model.parts.hard_points import check_sides
from stiffmbs.model.parts.spatial_frame import SpatialFrame
from stiffmbs.model.scene import notes_of
from stiffmbs.model.wheels import Wheel
from stiffmbs.tyres import TyreProperties

from ...conftest import EXAMPLE_SCENES
from ...tyres.plain_magic_formula_6 import plain_wrench_6
from ...tyres.test_magic_formula_6_coefficients import random_states, random_tyre

CHASSIS = {"mass": 1000, "inertia": [300, 1000, 1000], "position": [0, 0, 0.5]}
ASKEW = {**CHASSIS, "position": [3, -20, 0.5], "orientation": {"euler": "zyx", "angles": [2.1, 0, 0]}}
SAE = {**CHASSIS, "orientation": {"euler": "xyz", "angles": ["180 deg", 0, 0]}}


def car(chassis=CHASSIS, **parts):
    return stiffmbs.read_scene(json.dumps({"dimensions": 3, "bodies": {"chassis": chassis}, "parts": parts}))


def corner(x=1.2, y=0.0, z=-0.5, part="double_wishbone", **words):
    return {"use": part, "on": "chassis", "position": [x, y, z], **words}


def test_a_left_suspension_twice_is_refused():
    with pytest.raises(
        stiffmbs.InputError, match=r"right.*found the wheel at \(1.2, 0.76, -0.2\) m on chassis, in the place"
    ) as error:
        car(left=corner(), right=corner())
    assert "mirror: 'y' makes a left suspension a right one" in str(error.value)


@pytest.mark.parametrize("chassis", [CHASSIS, ASKEW])
def test_a_suspension_on_the_outer_side_of_the_car_is_refused(chassis):
    for wrong in (corner(y=-1.5), corner(y=1.5, mirror="y")):
        with pytest.raises(stiffmbs.InputError, match=r"one.*with its suspension on the outer side of the car"):
            car(chassis, one=wrong)


def test_a_wheel_centre_on_the_right_of_a_left_part_is_refused():
    with pytest.raises(
        stiffmbs.InputError, match=r"right.parameters.wheel_centre: found \(0, -0.76, 0.3\) m, on the other side"
    ):
        car(right=corner(parameters={"wheel_centre": [0, -0.76, 0.3]}))


@pytest.mark.long
@pytest.mark.parametrize("chassis", [CHASSIS, ASKEW])
def test_mounts_on_the_other_sides_are_refused(chassis):
    """An anti-roll bar, and a driver's wheels; an inner differential may have its outputs along the car."""
    axle = {"left": corner(z=-0.5), "right": corner(z=-0.5, mirror="y")}
    arms = {"left": "left.lower.arm", "right": "right.lower.arm"}
    swapped = {"left": "right.lower.arm", "right": "left.lower.arm"}
    car(chassis, **axle, bar=corner(part="anti_roll_bar", mounts=arms))
    car(chassis, **axle, bar=corner(part="anti_roll_bar", mounts=swapped, mirror="y"))
    for mounts, words in ((swapped, {}), (arms, {"mirror": "y"})):
        with pytest.raises(InputError, match=r"bar.mounts.left: found '.*', to the right of '.*' of the mount right"):
            car(chassis, **axle, bar=corner(part="anti_roll_bar", mounts=mounts, **words))
    wheels = {"rear_left": "right.wheel", "rear_right": "left.wheel"}
    with pytest.raises(InputError, match=r"main.mounts.rear_left: found 'right.wheel', to the right of 'left.wheel'"):
        car(chassis, **axle, main=corner(part="driveline", drive="rear", mounts=wheels))
    outputs = {"left": "left.wheel", "right": "right.wheel"}
    first, behind = (corner(x, part="differential", mounts=outputs) for x in (1, -1))
    car(chassis, **axle, first=first, behind=behind,
        main=corner(part="differential", mounts={"left": "first.input", "right": "behind.input"}))  # fmt: skip


@pytest.mark.long
def test_suspensions_on_their_sides_are_read():
    for part in ("double_wishbone", "macpherson", "trailing_arm", "multi_link", "pushrod_wishbone"):
        for chassis in (CHASSIS, ASKEW):
            car(chassis, left=corner(part=part), right=corner(part=part, mirror="y"), behind=corner(-1.2, part=part))
    turned = {"orientation": {"euler": "xyz", "angles": ["180 deg", 0, 0]}}
    car(SAE, left=corner(z=0.5, **turned), right=corner(z=0.5, mirror="y", **turned))
    car(rear=corner(part="twist_beam"), front=corner(-1, part="rigid_axle"))
    car(front=corner(part="telescopic_fork"), rear=corner(-1, part="swingarm"))


ALIKE = "are on both sides of an axle and not mirrored to each other"


def notes_of_the_car(folder, text):
    """The car with a tyre of conicity."""
    data = EXAMPLE_SCENES["car"].with_suffix(".tir").read_text()
    (folder / "car.tir").write_text(data.replace("[LATERAL_COEFFICIENTS]", "[LATERAL_COEFFICIENTS]\nPVY1 = 0.02"))
    (folder / "car.yaml").write_text(text)
    return [note for note in notes_of(stiffmbs.load_scene(folder / "car.yaml")) if ALIKE in note]


@pytest.mark.long
def test_tyres_that_are_not_mirrored_are_noted_by_axle(tmp_path):
    text = EXAMPLE_SCENES["car"].read_text()
    assert notes_of_the_car(tmp_path, text) == []
    (note,) = notes_of_the_car(tmp_path, text.replace("i: front.right.wheel, hand: -1", "i: front.right.wheel"))
    assert note.startswith("front.left.tyre and front.right.tyre are on both sides of an axle")
    assert "(PVY1)" in note and "hand: -1 mirrors one of them" in note
    assert len(notes_of_the_car(tmp_path, text.replace(", hand: -1", ""))) == 2


@pytest.mark.parametrize(
    "name", ["car", "hatchback", "formula_student", "truck", "motorcycle", "leaf_sprung_car", "quarter_car"]
)
def test_shipped_vehicles_have_their_tyres_on_the_right_sides(name):
    assert [note for note in notes_of(stiffmbs.load_scene(EXAMPLE_SCENES[name])) if ALIKE in note] == []


def axle(places, hands, **coefficients):
    """Wheels on one axle, from left to right, of a vehicle that heads along y."""
    numbers = {"FNOMIN": 4e3, "UNLOADED_RADIUS": 0.3, "VERTICAL_STIFFNESS": 2e5, "PCX1": 1.6, "PDX1": 1, "PKX1": 20,
               "PCY1": 1.3, "PDY1": 1, "PKY1": -15, "PKY2": 1.5, **coefficients}  # fmt: skip
    bodies = {f"w{k}": {"mass": 20, "inertia": [1, 1, 1], "position": [-y, 0, 0.3], "orientation": {"euler": "zyx", "angles": ["90 deg", 0, 0]}}
              for k, y in enumerate(places)}  # fmt: skip
    forces = {f"t{k}": {"type": "magic_formula_tyre", "i": f"w{k}", "properties": {"coefficients": numbers}, "hand": hand}
              for k, hand in enumerate(hands)}  # fmt: skip
    scene = stiffmbs.read_scene(json.dumps({"dimensions": 3, "bodies": bodies, "forces": forces}))
    return [note for note in notes_of(scene) if ALIKE in note]


def test_twin_wheels_have_the_hand_of_their_side_and_symmetric_tyres_none():
    assert axle((0.9, 0.6, -0.6, -0.9), (1, 1, -1, -1), PHY1=0.002) == []
    (note,) = axle((0.9, 0.6, -0.6, -0.9), (1, 1, 1, 1), PHY1=0.002)
    assert note.startswith("t0 and t3 are")
    assert axle((0.9, -0.9), (1, 1)) == axle((0.9, -0.9), (1, 1), PHY1=0.002, LHY=0) == []
    assert axle((0.0,), (1,), PHY1=0.002) == []


@pytest.mark.sampled(7)
@pytest.mark.parametrize("name", COEFFICIENTS_6)
def test_the_coefficients_that_differ_between_sides_are_those_that_break_the_symmetry(name):
    numbers = random_tyre(5) | dict.fromkeys((other for other in ONE_SIDED if other != name), 0.0)
    states = random_states(6, turning=False, count=30)

    def forces(sign):
        state = {**states, "alpha": sign * states["alpha"], "gamma": sign * states["gamma"]}
        rows = []
        for i in range(30):
            one = {key: None if x is None else float(x[i]) for key, x in state.items()}
            rows.append(plain_wrench_6(numbers, {**one, "mu": 1.0, "Re": 0.32}))
        return rows

    different = max(
        abs(right[of] - sign * left[of]) / (abs(left[of]) + 1)
        for left, right in zip(forces(1), forces(-1), strict=True)
        for of, sign in {"Fx": 1, "Fy": -1, "Mx": -1, "My": 1, "Mz": -1}.items()
    )
    assert (
        (different > 1e-6)
        == (name in ONE_SIDED)
        == (name in TyreProperties(coefficients=numbers, version="6.2").one_sided)
    )


def test_wheels_are_on_one_axle_up_to_a_tenth_of_their_distance():
    """Of the offset from the axis, and of the cosine of the angle between the axes."""

    def seen(offset, cosine):
        sine = (1 - cosine**2) ** 0.5
        wheels = ((0.0, 0.0, (0.0, 1.0, 0.0)), (offset, 1.0, (sine, cosine, 0.0)))
        other, one = (Wheel(np.array([x, y, 0.0]), np.array(axis), "left") for x, y, axis in wheels)
        return one.to_the_left_of(other) > 0

    assert seen(0.07, 1.0) and not seen(0.14, 1.0)
    assert seen(0.0, 1 - 0.07) and not seen(0.0, 1 - 0.14)


def test_wheels_are_in_one_place_up_to_a_millimetre():
    """Of two suspensions that are mounted on one body."""

    def check(apart):
        frame = SpatialFrame()
        check_sides((name, (0.0, 0.7 + shift, 0.3), "chassis", frame) for name, shift in (("a", 0.0), ("b", apart)))

    check(1.4e-3)
    with pytest.raises(InputError, match="in the place of the wheel of a"):
        check(0.7e-3)
