"""Measures of an axle against an independent geometric calculation from its hard points."""

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import stiffmbs

from .geometry import STEP, Corner, screw, slope

POINTS = {
    "double_wishbone": {
        "lower_front": (0.16, 0.35, 0.19), "lower_rear": (-0.20, 0.36, 0.18), "lower_ball": (0.01, 0.70, 0.17),
        "upper_front": (0.12, 0.42, 0.485), "upper_rear": (-0.15, 0.41, 0.46), "upper_ball": (-0.02, 0.66, 0.50),
        "tie_inner": (0.12, 0.37, 0.287), "tie_outer": (0.13, 0.69, 0.28), "strut_seat": (0.0, 0.56, 0.185), "strut_tower": (0.0, 0.50, 0.66),
    },
    "macpherson": {
        "lower_front": (0.02, 0.36, 0.20), "lower_rear": (-0.28, 0.36, 0.21), "lower_ball": (0.0, 0.70, 0.18),
        "tie_inner": (-0.12, 0.37, 0.27), "tie_outer": (-0.12, 0.69, 0.26), "strut_seat": (-0.01, 0.62, 0.42), "strut_tower": (-0.03, 0.55, 0.82),
    },
    "multi_link": {
        "lower_front_inner": (0.38, 0.44, 0.20), "lower_front_outer": (0.05, 0.67, 0.18), "lower_rear_inner": (-0.03, 0.32, 0.19),
        "lower_rear_outer": (-0.02, 0.68, 0.17), "upper_front_inner": (0.30, 0.48, 0.46), "upper_front_outer": (0.03, 0.65, 0.47),
        "upper_rear_inner": (-0.04, 0.40, 0.49), "upper_rear_outer": (-0.03, 0.66, 0.48), "toe_inner": (-0.18, 0.34, 0.27),
        "toe_outer": (-0.17, 0.69, 0.25), "strut_seat": (-0.05, 0.58, 0.25), "strut_tower": (-0.04, 0.50, 0.66),
    },
}  # fmt: skip
SPRING, LOAD, CENTRE = 30e3, 3500.0, (0.0, 0.76, 0.30)


def corner_of(part, points):
    at = {name: np.asarray(point) for name, point in points.items()}
    strut = (at["strut_seat"], at["strut_tower"])
    if part == "multi_link":
        names = ("lower_front", "lower_rear", "upper_front", "upper_rear", "toe")
        return Corner(tuple((at[f"{each}_inner"], at[f"{each}_outer"]) for each in names), np.array(CENTRE), strut)
    lower = [(at[f"lower_{each}"], at["lower_ball"]) for each in ("front", "rear")]
    tie = (at["tie_inner"], at["tie_outer"])
    if part == "macpherson":
        return Corner((*lower, tie), np.array(CENTRE), strut, slides=True)
    upper = [(at[f"upper_{each}"], at["upper_ball"]) for each in ("front", "rear")]
    arm = (at["lower_front"], at["lower_rear"], at["lower_ball"])
    return Corner((*lower, *upper, tie), np.array(CENTRE), strut, on_arm=arm)


def found_by_kc(part, points, **sizes):
    inner = points["toe_inner" if part == "multi_link" else "tie_inner"]
    entry = {"use": part, "mounts": {"rack": "steering.rack"}, "parameters": {**{k: list(v) for k, v in points.items()}, "spring": SPRING, "strut_load": LOAD}}  # fmt: skip
    rack = {"use": "steering_rack", "parameters": {"centre": [inner[0], 0, inner[2]]}}
    scene = {
        "dimensions": 3, "gravity": [0, 0, 0], "choose": {"compliance": "rigid"},
        "parts": {"steering": rack, "front.left": entry, "front.right": {**entry, "mirror": "y"}},
    }  # fmt: skip
    cases = dict.fromkeys(("bump", "roll", "steer", "lateral", "lateral_parallel", "brake", "traction", "aligning", "aligning_parallel"), 0)  # fmt: skip
    return stiffmbs.kinematics_and_compliance(
        stiffmbs.read_scene(json.dumps(scene)),
        points=5,
        vehicle=stiffmbs.VehicleOptions(wheelbase=2.6),
        **{**cases, **sizes},
    )


def compare(found, expected, scale=1.0, tolerance=1e-6):
    assert np.allclose(found, expected, rtol=tolerance, atol=tolerance * scale), (found, expected)


def check(part, points):
    corner = corner_of(part, points)
    kc = found_by_kc(part, points, bump=20, roll=16, steer=16)
    bump, roll, steer = (kc.sweeps[name].channels for name in ("bump", "roll", "steer"))
    _travel(corner, bump, 1e-3 * np.linspace(-20, 20, 5))
    _axis(part, corner, points, bump, 1e-3 * np.linspace(-20, 20, 5))
    _roll(corner, roll, 1e-3 * np.linspace(-16, 16, 5))
    _steer(corner, steer, 1e-3 * np.linspace(-16, 16, 5))


def _travel(corner, bump, heights):
    rest = corner.point(corner.centre, 0.0)
    for k, z in enumerate(heights):
        centre = lambda s: corner.point(corner.centre, s)  # noqa: E731
        moved, v, patch, contact = centre(z), slope(centre, z), slope(corner.patch, z), slope(corner.contact, z)
        spin = slope(lambda s: corner.pose(s)[0], z) @ corner.pose(z)[0].T
        omega = np.array([spin[2, 1], spin[0, 2], spin[1, 0]])
        compare(bump["left.travel"][k], 1e3 * (moved - rest)[2])
        compare(bump["left.longitudinal"][k], 1e3 * (moved - rest)[0])
        compare(bump["left.lateral"][k], 1e3 * (corner.contact(z) - corner.contact(0.0))[1])
        compare(bump["left.toe"][k], corner.toe(z))
        compare(bump["left.camber"][k], corner.camber(z))
        compare(bump["left.fvsa_length"][k], 1e3 * np.hypot(v[1], v[2]) / omega[0])
        compare(bump["left.fvsa_angle"][k], np.degrees(np.arctan(v[1] / v[2])))
        compare(bump["left.svsa_length"][k], -1e3 * np.hypot(v[0], v[2]) / omega[1])
        compare(bump["left.svsa_angle"][k], np.degrees(np.arctan(v[0] / v[2])))
        locked = v + np.cross(omega, corner.contact(z) - moved)
        compare(bump["left.brake_angle"][k], np.degrees(np.arctan(locked[0] / contact[2])))
        compare(bump["left.drive_angle"][k], np.degrees(np.arctan(v[0] / contact[2])))
        if not z:
            compare(locked, patch)
        load = lambda s: -(LOAD - SPRING * (corner.length(s) - corner.length(0.0))) * slope(corner.length, s)  # noqa: E731
        compare(bump["left.load"][k], load(z))
        compare(bump["left.wheel_rate"][k], 1e-3 * slope(load, z) / v[2])
        compare(bump["left.motion_ratio.strut.strut"][k], -slope(corner.length, z) / v[2])
        line = slope(corner.contact, z)  # both sides alike: the centre is in the middle plane
        y, height = corner.contact(z)[1:]
        compare(bump["axle.roll_centre_height"][k], 1e3 * y * line[1] / line[2])
        compare(bump["axle.roll_centre_lateral"][k], 0.0)
        compare(bump["axle.track"][k], 2e3 * y)
        assert abs(height - z) < 1e-12


def _axis(part, corner, points, bump, heights):
    for k, z in enumerate(heights):
        length = corner.length(z)
        direction, point = screw(corner, lambda s, z=z, length=length: (z, s, {"length": length}))
        if part == "double_wishbone":  # through both ball joints
            low, high = (corner.point(points[name], z) for name in ("lower_ball", "upper_ball"))
        elif part == "macpherson":  # through the lower ball joint and the top of the strut
            low, high = corner.point(points["lower_ball"], z), np.asarray(points["strut_tower"])
        if part != "multi_link":
            direction, point = (high - low) / np.linalg.norm(high - low), low
        centre, contact, axis = corner.point(corner.centre, z), corner.contact(z), corner.axis(z)
        heading, out = np.array([axis[1], -axis[0], 0]), np.array([axis[0], axis[1], 0])
        heading, out = (each / np.linalg.norm(each) for each in (heading, out))
        road, hub = (point + direction * (at[2] - point[2]) / direction[2] - at for at in (contact, centre))
        compare(bump["left.caster"][k], np.degrees(np.arctan(-direction[0] / direction[2])))
        compare(bump["left.kingpin_inclination"][k], np.degrees(np.arctan(-direction[1] / direction[2])))
        compare(bump["left.scrub_radius"][k], -1e3 * road @ out, 10)
        compare(bump["left.caster_trail"][k], 1e3 * road @ heading, 10)
        compare(bump["left.spindle_offset"][k], -1e3 * hub @ out, 10)
        compare(bump["left.caster_offset"][k], 1e3 * hub @ heading, 10)


def _roll(corner, roll, heights):
    mirror = np.array([1, -1, 1])

    def load(s):
        return -(LOAD - SPRING * (corner.length(s) - corner.length(0.0))) * slope(corner.length, s)

    def across(s):
        return corner.contact(s)[1] + corner.contact(-s)[1]

    def moment(s):
        return (load(s) - load(-s)) * across(s) / 2

    for k, z in enumerate(heights):
        left, right = corner.contact(z), mirror * corner.contact(-z)
        middle = (left + right) / 2
        paths = np.array([slope(corner.contact, z)[1:], mirror[1:] * slope(corner.contact, -z)[1:]])
        centre = np.linalg.solve(paths, [paths[0] @ (left - middle)[1:], paths[1] @ (right - middle)[1:]])
        compare(roll["axle.roll_centre_height"][k], 1e3 * centre[1], 100)
        compare(roll["axle.roll_centre_lateral"][k], 1e3 * (centre[0] + middle[1]), 100)
        compare(roll["axle.roll_angle"][k], np.degrees(np.arctan2(2 * z, (left - right)[1])))
        turn = slope(lambda s: np.arctan2(2 * s, across(s)), z)
        compare(roll["axle.roll_rate"][k], np.radians(slope(moment, z) / turn))


def _steer(corner, steer, travels):
    for k, rack in enumerate(travels):
        left, right = -corner.toe(0.0, rack), corner.toe(0.0, -rack)
        compare(steer["left.toe"][k], -left)
        compare(steer["right.toe"][k], right)
        mean = lambda s: -(corner.toe(0.0, s) - corner.toe(0.0, -s)) / 2  # noqa: E731
        compare(steer["axle.steering_ratio"][k], 1e3 / slope(mean, rack))
        if rack:
            inner, outer = np.radians(sorted((abs(left), abs(right)), key=lambda a: a != abs(left if left + right > 0 else right)))  # fmt: skip
            part = (corner.contact(0.0, rack)[1] + corner.contact(0.0, -rack)[1]) / 2.6
            ideal = np.arctan(1 / (1 / np.tan(outer) - part))
            compare(steer["axle.ackermann"][k], 100 * (inner - outer) / (ideal - outer), 100)


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize("part", POINTS)
def test_measures_follow_from_the_hard_points(part):
    check(part, POINTS[part])


@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize("part", POINTS)
@settings(max_examples=3, deadline=None, derandomize=True)
@given(data=st.data())
def test_measures_follow_from_any_hard_points(part, data):
    moves = st.tuples(*[st.floats(-0.02, 0.02, allow_subnormal=False)] * 3)
    points = {name: tuple(np.add(point, data.draw(moves)).tolist()) for name, point in POINTS[part].items()}
    check(part, points)


def test_steps_are_small():
    assert abs(slope(np.sin, 1.0, STEP) - np.cos(1.0)) < 1e-12
