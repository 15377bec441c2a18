"""Enveloping contact: elliptical cams on a cleat and a kerb, against their geometry."""

import math

import numpy as np
import pytest

import stiffmbs
from stiffmbs import InputError
from stiffmbs.roads import FlatRoad, FormulaRoad, TableRoad
from stiffmbs.spatial import Body, MagicFormulaTyre, Model, VerticalTyre
from stiffmbs.tyres import TyreProperties

from .test_magic_formula_6 import NUMBERS
from .wheels import reported

LENGTH, HEIGHT, ORDER, SHIFT = 0.33, 0.31, 1.8, 0.11
CAMS = {"shift": SHIFT, "length": LENGTH, "height": HEIGHT, "order": ORDER}
CLEAT = np.array([[0, 0], [1.999, 0], [2.0, 0.01], [2.02, 0.01], [2.021, 0], [4, 0]])
RADIUS, STIFFNESS = 0.32, 2e5


def cleat(**fields):
    return TableRoad(profile={"table": CLEAT.tolist(), "lines": True}, **fields)


def follower(x, profile=CLEAT):
    """The height of one cam at x above its height on a level road, from the profile's vertices, between which it is straight."""
    s = np.linspace(-LENGTH, LENGTH, 200001)
    lower = HEIGHT * (1 - np.abs(s / LENGTH) ** ORDER) ** (1 / ORDER)
    heights = np.interp(x + s, *profile.T)
    return (heights + lower).max() - HEIGHT


def effective(x):
    """Height and slope of the two-point follower."""
    front, rear = follower(x + SHIFT / 2), follower(x - SHIFT / 2)
    return (front + rear) / 2, (front - rear) / SHIFT


def measured(road, x, y=0.0, deflection=0.01, yaw=0.0, **cams):
    """The channels of an upright wheel at a place on a road, pressed against its level."""
    tyre = VerticalTyre(i="wheel", road=road, radius=RADIUS, stiffness=STIFFNESS, envelope={**CAMS, **cams})
    c, s = math.cos(yaw), math.sin(yaw)
    model = Model("wheel", gravity=(0, 0, -9.81))
    body = Body(
        mass=20, inertia=(0.7, 1.2, 0.7), position=(x, y, RADIUS - deflection), velocity=(10, 0, 0),
        orientation={"x": (c, s, 0), "y": (-s, c, 0)},
    )  # fmt: skip
    model.add("wheel", body)
    model.add("tyre", tyre)
    return reported(model)


@pytest.mark.parametrize("x", [1.5, 1.75, 1.85, 1.95, 2.01, 2.06, 2.2, 2.32])
def test_a_cleat_under_two_cams(x):
    """The load is that of the distance to the effective plane, and it acts along its normal."""
    found = measured(cleat(), x)
    w, slope = effective(x)
    upright = 1 / math.hypot(1, slope)
    radius = (RADIUS - 0.01 - w) * upright
    assert found["deflection"] == pytest.approx(RADIUS - radius, abs=3e-5)
    assert found["load"] == pytest.approx(STIFFNESS * (RADIUS - radius), abs=3e-5 * STIFFNESS)
    assert (found["fx"], found["fz"]) == pytest.approx(
        (-slope * upright * found["load"], upright * found["load"]), abs=2e-3 * found["load"]
    )


@pytest.mark.long
def test_cams_begin_and_end_to_rise_before_and_after_the_cleat():
    """The response is longer than the cleat by the cams and their distance, and has two humps of half the height."""
    x = np.linspace(1.5, 2.5, 101)
    found = np.array([effective(one)[0] for one in x])
    assert found.max() < 0.0101
    assert x[found > 1e-4][0] < 2.0 - SHIFT / 2
    assert x[found > 1e-4][-1] > 2.021 + SHIFT / 2


@pytest.mark.long
def test_an_oblique_cleat_is_met_by_one_track_first():
    """Tracks across the contact see the cleat at other places, which tilts the effective plane."""
    yaw, width, x = 0.5, 0.2, 1.9
    found = measured(cleat(), x, yaw=yaw, width=width, tracks=3)
    c, s = math.cos(yaw), math.sin(yaw)
    places = [
        (side, across, x + side * SHIFT / 2 * c - across * s)
        for side in (1, -1)
        for across in (-width / 2, 0, width / 2)
    ]
    heights = [follower(place) for *_, place in places]
    w = np.mean(heights)
    pitch = sum(side * h for (side, *_), h in zip(places, heights, strict=True)) * 2 / (6 * SHIFT)
    roll = sum(across * h for (_, across, _), h in zip(places, heights, strict=True)) / (2 * 2 * (width / 2) ** 2)
    slopes = np.array([pitch * c - roll * s, pitch * s + roll * c])
    normal = np.array([*-slopes, 1]) / math.sqrt(1 + slopes @ slopes)
    force = np.array([found["fx"], found["fy"], found["fz"]])
    # the force is along the wheel's plane and the normal; its component along the normal is the load
    assert force == pytest.approx(found["load"] * normal, abs=2e-3 * found["load"])
    assert found["load"] > STIFFNESS * 0.01
    assert w > 0


def test_a_level_road_a_slope_and_a_filter_stay_what_they_are():
    plain = measured(FlatRoad(), 1.0)
    assert plain["load"] == pytest.approx(STIFFNESS * 0.01, rel=1e-12)
    same = measured(cleat(filter_radius=0.3), 1.95)
    assert same["load"] == pytest.approx(measured(cleat(), 1.95)["load"], rel=1e-12)  # cams replace the filter
    with pytest.raises(InputError, match="found a road 'formula' without an extent"):
        measured(FormulaRoad(z="0.01*sin(x)"), 1.0)
    with pytest.raises(InputError, match="order"):
        measured(cleat(), 1.0, order=0.5)


def test_cams_of_a_property_file():
    """ELLIPS_SHIFT is relative to the contact length 2a at the nominal load, ELLIPS_LENGTH and _HEIGHT to the radius."""
    cams = {
        "ELLIPS_SHIFT": 0.83,
        "ELLIPS_LENGTH": 1.05,
        "ELLIPS_HEIGHT": 1.02,
        "ELLIPS_ORDER": 1.8,
        "ELLIPS_NWIDTH": 10.0,
    }
    patch = {"Q_RA1": 0.66, "Q_RA2": 0.71, "Q_RB1": 1.03, "Q_RB2": -1.12}
    properties = TyreProperties(coefficients={**NUMBERS, **patch, **cams}, version="6.2")
    tyre = MagicFormulaTyre(i="wheel", properties=properties, envelope="file", road=cleat())
    part = 4000 / (2e5 * 0.33)
    a, b = 0.33 * (0.71 * part + 0.66 * math.sqrt(part)), 0.2 * (-1.12 * part + 1.03 * part ** (1 / 3))
    assert (tyre.envelope.shift, tyre.envelope.width) == pytest.approx((0.83 * 2 * a, 2 * b))
    assert (tyre.envelope.length, tyre.envelope.tracks) == (pytest.approx(1.05 * 0.33), 10)
    assert tyre.road.filter_shape.order == 1.8
    with pytest.raises(InputError, match="envelope: found properties without ELLIPS_SHIFT"):
        MagicFormulaTyre(i="wheel", properties=TyreProperties(coefficients=NUMBERS, version="6.2"), envelope="file")


SCENE = """
dimensions: 3
gravity: [0, 0, -9.81]
roads: {cleat: {type: table, profile: {table: [[0, 0], [1.999, 0], [2, 0.01], [2.02, 0.01], [2.021, 0], [4, 0]], lines: true}}}
bodies:
  wheel: {mass: 350, inertia: [12, 2, 12], position: [1.5, 0, 0.3028], velocity: [10, 0, 0], omega: [0, 32, 0]}
joints: {keep: {type: parallel, i: wheel, j: ground}}
forces:
  tyre:
    {type: vertical_tyre, i: wheel, road: cleat, radius: 320 mm, stiffness: 200 N/mm, damping: 2000,
     envelope: {shift: 110 mm, length: 330 mm, height: 310 mm, width: 180 mm}}
run: {duration: 0.1 s, output: 1 ms, rtol: 1e-7}
"""


@pytest.mark.long
def test_a_run_over_a_cleat_by_three_solvers():
    scene = stiffmbs.read_scene(
        SCENE.replace("keep: {type: parallel, i: wheel, j: ground}", "").replace("joints: {}\n", "")
    )
    runs = [stiffmbs.run(scene, solver=solver) for solver in ("bdf", "radau", "projected")]
    for solution in runs:
        assert solution["tyre.load"] == pytest.approx(runs[0]["tyre.load"], rel=1e-4, abs=2)
    assert runs[0]["tyre.load"].max() > 350 * 9.81 + 500


ROLLING_OVER = """
dimensions: 3
gravity: [0, 0, -9.81]
bodies:
  chassis: {mass: 1350, inertia: [480, 2100, 2300], position: [0, 0, 1.2], velocity: [0, 6, 0], omega: [-3, 0, 0]}
forces:
  body:
    {type: box_plane_impact, i: {body: chassis, point: [-0.2, 0, 0.35]}, j: ground, x: 2.4, y: 1.4, z: 1.1,
     stiffness: 1e7, exponent: 1.5, damping: 2e4, depth: 10 mm, static_friction: 0.5, friction: 0.4}
run: {duration: 4 s, output: 0.02 s, rtol: 1e-5}
"""


@pytest.mark.long
def test_the_body_of_a_car_comes_to_rest_on_the_road():
    """A chassis that rolls over on the contact of the guide lies still, and the road carries its weight."""
    solution = stiffmbs.run(stiffmbs.read_scene(ROLLING_OVER), solver="projected")
    assert solution.success, solution.message
    late = solution.time > 3.5
    assert solution["body.fz"][late].mean() == pytest.approx(1350 * 9.81, rel=0.02)
    assert np.abs(solution["chassis.vy"][late]).max() < 0.05
    assert solution["chassis.z"].min() > 0
