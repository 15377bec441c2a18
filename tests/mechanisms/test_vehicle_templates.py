"""Complete vehicles from the shipped parts: rest, lane change, three solvers, and kinematics in closed form."""

import json
from typing import NamedTuple

import numpy as np
import pytest
from scipy.optimize import brentq

import stiffmbs

from ..conftest import EXAMPLE_SCENES
from ..studies.suspension.geometry import Corner, slope

STEER = '{steer: {type: drive, joint: front.steering, position: "4 deg*(step5(t, 0.5, 0, 1, 1) - 2*step5(t, 1, 0, 2, 1) + step5(t, 2, 0, 2.5, 1))"}}'
KINGPINS = [("parts.front.steering", "kingpins"), ("joints", STEER)]
AT_80_KM_H = [("choose.manoeuvre", "lane_change"), ("V", "80/3.6")]


class Template(NamedTuple):
    """Scene and changes, duration of the comparison (s), axles on the rig, sideways displacement and duration of the lane change."""

    scene: str
    changes: list
    duration: float
    axles: str
    aside: float
    lane_change: float | None = None


TEMPLATES = {
    "double_wishbone": Template("car", AT_80_KM_H, 3.5, "front", 3.7, 4),
    "macpherson": Template("hatchback", [], 2.2, "front", 3.9),
    "five_link": Template("hatchback", [("choose.rear", "five_link")], 2.2, "rear", 3.3),
    "twist_beam": Template("hatchback", [("choose.rear", "twist_beam")], 2.2, "rear", 3.9),
    "trailing_arm": Template("hatchback", [("choose.rear", "trailing_arm")], 2.2, "rear", 3.7),
    "leaf_springs": Template(
        "leaf_sprung_car", [*KINGPINS, ("roads", "{bumps: {type: flat}}")], 2.5, "front rear", 1.7
    ),
    "truck_and_trailer": Template("truck", [], 3.0, "front rear", 3.6),
    "motorcycle": Template("motorcycle", [], 3.5, "front rear", 3.2),
    "formula_student": Template("formula_student", [], 1.8, "front rear", 2.7),
}
NONE = dict.fromkeys(
    ("bump", "roll", "steer", "lateral", "lateral_parallel", "brake", "traction", "aligning", "aligning_parallel"), 0
)


def scene(name, *changes):
    return stiffmbs.load_scene(EXAMPLE_SCENES[name], [*changes])


ALLOWED = (
    "at the start was not checked", "auto chose", "the steady motion is stable: no disturbance grows", "no force determines", "between output times"
)  # fmt: skip


def unexpected(notes):
    return [note for note in notes if not any(sentence in note for sentence in ALLOWED)]


@pytest.mark.sampled(14)
@pytest.mark.long
@pytest.mark.parametrize("name", TEMPLATES)
def test_three_solvers_agree(name):
    """Order 5, an implicit and an explicit Runge-Kutta method, at rtol 1e-7: 1e-5 m in every coordinate."""
    template = TEMPLATES[name]
    given = scene(template.scene, *template.changes)
    runs = [
        stiffmbs.run(given, rtol=1e-7, duration=template.duration, output=0.02, **solver)
        for solver in ({"solver": "bdf"}, {"solver": "radau"}, {"solver": "projected", "scheme": "dop853"})
    ]
    places = [f"{body}.{axis}" for body in given.bodies for axis in "xyz"]
    for run in runs:
        assert run.success
        assert [note for note in run.notes if "at the start was not checked" not in note] == []
        assert max(np.max(np.abs(run[place] - runs[0][place])) for place in places) < 1e-5


@pytest.mark.sampled(7)
@pytest.mark.long
@pytest.mark.parametrize("name", TEMPLATES)
def test_it_rests_on_its_tyres_and_changes_the_lane(name):
    template = TEMPLATES[name]
    given = scene(template.scene, *template.changes)
    rest = stiffmbs.equilibrium(given)
    assert unexpected(rest.notes) == []
    weight = 9.81 * sum(body.mass for body in given.bodies.values())
    tyres = [force for force in given.forces if force.endswith("tyre")]
    lift = rest.channels.get("air.air.fz", 0.0)
    assert sum(rest.channels[f"{tyre}.fz"] for tyre in tyres) + lift == pytest.approx(weight, rel=1e-9)
    body = "frame" if name == "motorcycle" else "chassis"
    found = stiffmbs.run(given, **({"duration": template.lane_change} if template.lane_change else {}))
    assert unexpected(found.notes) == []
    assert found[f"{body}.y"][-1] == pytest.approx(template.aside, abs=0.15)
    assert abs(found[f"{body}.vy"][-1]) < 0.06 * found[f"{body}.vx"][-1], "it goes on along its path"


@pytest.mark.sampled(7)
@pytest.mark.long
@pytest.mark.parametrize("name", TEMPLATES)
def test_its_modes_are_those_of_a_vehicle_and_its_rig_is_symmetric(name):
    """A drag link on the left makes steered rigid axles asymmetric."""
    template = TEMPLATES[name]
    given = scene(template.scene, *template.changes)
    modes = stiffmbs.modes(given).modes
    assert max(value.real for mode in modes for value in mode.eigenvalues) < 0.01
    of_body = [mode.frequency for mode in modes if 0.9 < mode.frequency < 3.5 and abs(mode.eigenvalues[0].imag) > 0]
    assert len(of_body) >= 2, "heave and pitch"
    for axle in template.axles.split():
        found = stiffmbs.kinematics_and_compliance(given, axle, points=5)
        side = "wheel" if name == "motorcycle" else "left"
        assert found.measures[f"{side}.load"] > 0
        if name != "motorcycle":
            assert found.measures["left.wheel_rate"] > 0
            assert found.measures["axle.roll_rate"] > 0
        if axle == "rear" or name not in ("leaf_springs", "truck_and_trailer"):
            assert found.asymmetry() < 1e-6


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize("name", ["formula_student", "motorcycle"])
def test_no_mode_grows_at_the_speed_of_the_lane_change(name):
    rates = [value.real for mode in stiffmbs.modes(scene(name)).modes for value in mode.eigenvalues]
    assert max(rates) < 0.1


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize("rear", ["twist_beam", "five_link"])
def test_other_rear_suspensions_of_the_hatchback(rear):
    given = scene("hatchback", ("choose.rear", rear), ("choose.compliance", "rigid"))
    assert stiffmbs.check(given).redundant == ()
    found = stiffmbs.run(given, duration=2.5)
    assert found.success
    assert 1 < found["chassis.y"][-1] < 5


def kinematics(parts, axle="rear", **named):
    read = stiffmbs.read_scene(json.dumps({"dimensions": 3, "gravity": [0, 0, 0], "parts": parts}))
    return stiffmbs.kinematics_and_compliance(read, axle, **{"points": 5, **NONE, **named})


@pytest.mark.long
def test_a_twist_beam_rolls_about_the_lines_from_its_pivots_to_the_shear_centre():
    """In roll the pin in the middle rests: each half turns about the line from its pivot to it; in heave about the line of the pivots."""
    pivot, beam, wheel = np.array([0.42, 0.57, 0.30]), np.array([0.26, 0.0, 0.33]), np.array([0.0, 0.74, 0.30])
    found = kinematics({"rear": {"use": "twist_beam", "compliance": "rigid"}}, bump=1, roll=1)
    roll, bump = found.sweeps["roll"].channels, found.sweeps["bump"].channels
    contact = wheel * [1, 1, 0]
    axis = beam - pivot
    omega = axis / np.cross(axis, contact - pivot)[2]  # the contact rises at 1
    v = np.cross(omega, contact - pivot)
    assert roll["axle.roll_centre_height"][2] == pytest.approx(1e3 * wheel[1] * v[1] / v[2], rel=1e-6)
    rise = np.cross(omega, wheel - pivot)[2]
    assert found.sweeps["roll"].slope("left.camber") == pytest.approx(1e-3 * np.degrees(-omega[0]), rel=1e-4)
    assert roll["left.fvsa_length"][2] == pytest.approx(
        1e3 * np.hypot(*np.cross(omega, wheel - pivot)[1:]) / omega[0], rel=1e-6
    )
    assert found.sweeps["roll"].slope("left.toe") == pytest.approx(1e-3 * np.degrees(-omega[2]), rel=1e-4)
    assert rise == pytest.approx(1, abs=0.2)
    assert bump["left.svsa_length"][2] == pytest.approx(-1e3 * 0.42, rel=1e-9)
    assert np.max(np.abs(bump["left.camber"])) < 1e-9


@pytest.mark.long
def test_a_rocker_turns_with_the_rise_of_the_wheel():
    """Motion ratio and wheel rate of a pushrod suspension from its hard points."""
    at = {
        name: np.array(point)
        for name, point in {
            "lower_front": (0.14, 0.22, 0.13), "lower_rear": (-0.14, 0.22, 0.13), "lower_ball": (0.006, 0.545, 0.125),
            "upper_front": (0.12, 0.25, 0.275), "upper_rear": (-0.12, 0.25, 0.265), "upper_ball": (-0.008, 0.525, 0.315),
            "tie_inner": (0.07, 0.224, 0.149), "tie_outer": (0.07, 0.545, 0.150),
            "outer": (0.0, 0.50, 0.14), "inner": (0.0, 0.24, 0.40), "pivot": (0.0, 0.20, 0.36), "seat": (0.0, 0.16, 0.40), "tower": (0.0, -0.02, 0.28),
        }.items()
    }  # fmt: skip
    links = [(at[f"{arm}_{end}"], at[f"{arm}_ball"]) for arm in ("lower", "upper") for end in ("front", "rear")]
    arm = (at["lower_front"], at["lower_rear"], at["lower_ball"])
    corner = Corner((*links, (at["tie_inner"], at["tie_outer"])), np.array([0, 0.60, 0.23]), (at["outer"], at["inner"]), on_arm=arm)  # fmt: skip
    rod = np.linalg.norm(at["outer"] - at["inner"])

    def turned(point, angle):
        y, z = (point - at["pivot"])[1:]
        return at["pivot"] + [0, y * np.cos(angle) - z * np.sin(angle), y * np.sin(angle) + z * np.cos(angle)]

    def length(rise):
        end = corner.on_arm_at(at["outer"], rise)
        angle = brentq(lambda a: np.linalg.norm(end - turned(at["inner"], a)) - rod, -0.5, 0.5, xtol=1e-15, rtol=1e-15)
        return np.linalg.norm(turned(at["seat"], angle) - at["tower"])

    entry = {"use": "pushrod_wishbone", "compliance": "rigid", "parameters": {"strut_load": 900, "spring": 30e3}}
    found = kinematics({"rear.left": entry, "rear.right": {**entry, "mirror": "y"}}, bump=10)
    bump = found.sweeps["bump"].channels
    for k, z in enumerate(1e-3 * np.linspace(-10, 10, 5)):
        rise = slope(lambda s: corner.point(corner.centre, s), z)[2]
        assert bump["left.motion_ratio.strut.strut"][k] == pytest.approx(-slope(length, z) / rise, rel=1e-6)
        force = -(900 - 30e3 * (length(z) - length(0.0))) * slope(length, z)
        assert bump["left.load"][k] == pytest.approx(force, rel=1e-6)


@pytest.mark.long
def test_a_motorcycle_has_rake_trail_and_the_slope_of_its_swingarm():
    front = kinematics({"front": {"use": "telescopic_fork"}}, "front", bump=5).measures
    rake = np.arctan(0.466)
    at_axle = -0.30 + 0.466 * (0.85 - 0.30)  # of the axis at the height of the wheel's centre
    assert front["wheel.caster"] == pytest.approx(np.degrees(rake), rel=1e-9)
    assert front["wheel.caster_offset"] == pytest.approx(1e3 * at_axle, rel=1e-9)
    assert front["wheel.caster_trail"] == pytest.approx(1e3 * (at_axle + 0.466 * 0.30), rel=1e-9)
    assert front["wheel.motion_ratio.strut.strut"] == pytest.approx(1 / np.cos(rake), rel=1e-9)
    assert not [name for name in front if name.startswith("axle.")]
    rear = kinematics({"rear": {"use": "swingarm"}}, "rear", bump=5).measures
    assert rear["wheel.drive_angle"] == pytest.approx(-np.degrees(np.arctan(0.09 / 0.55)), rel=1e-9)
    assert rear["wheel.brake_angle"] == pytest.approx(-np.degrees(np.arctan(0.40 / 0.55)), rel=1e-9)


@pytest.mark.long
def test_kingpins_of_a_rigid_axle():
    found = kinematics(
        {"front": {"use": "rigid_axle", "steering": "kingpins", "compliance": "rigid"}}, "front", steer=4
    )
    assert found.measures["left.caster"] == pytest.approx(np.degrees(np.arctan(0.05)), abs=0.02)
    assert found.measures["left.kingpin_inclination"] == pytest.approx(np.degrees(np.arctan(0.08)), abs=1e-3)
    assert found.sweeps["steer"].channels["axle.steer"][-1] > 2, "positive angles steer to the left"


def test_a_fifth_wheel_carries_roll_and_a_ball_does_not():
    bodies = {
        "truck": {"mass": 1, "inertia": [1, 1, 1]},
        "trailer": {"mass": 1, "inertia": [1, 1, 1], "position": [-2, 0, 0]},
    }
    joints = {"fixed": {"type": "fixed", "i": "truck", "j": "ground"}}
    for coupling, free in (("ball", 3), ("fifth_wheel", 2)):
        hitch = {"use": "trailer_hitch", "on": "truck", "mounts": {"trailer": "trailer"}, "coupling": coupling}
        text = json.dumps({"dimensions": 3, "bodies": bodies, "joints": joints, "parts": {"hitch": hitch}})
        assert stiffmbs.check(stiffmbs.read_scene(text)).degrees_of_freedom == free


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize("name", ["hatchback", "formula_student", "motorcycle", "truck", "car"])
def test_it_starts_in_equilibrium_as_the_torques_of_its_wheels_balance(name):
    assert stiffmbs.modes(scene(name)).notes == ()


@pytest.mark.long
def test_tyres_that_bend_in_their_slip_have_no_breakpoint_on_a_truck_on_bushings():
    assert stiffmbs.modes(scene("truck", ("choose.compliance", "bushing"))).notes == ()
