"""The driver: lateral error on standard courses and at all speeds, speed profile, pedal, and faults in a path."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import stiffmbs
from stiffmbs.model.paths.curves import circle, curve_through, straightened
from stiffmbs.model.paths.lanes import STANDARDS, path_through

from ..conftest import EXAMPLES


def driven(manoeuvre, *changes, **settings):
    run = stiffmbs.run(
        stiffmbs.load_scene(EXAMPLES / "car.yaml", [("choose.manoeuvre", manoeuvre), *changes]), **settings
    )
    assert run.success
    return run


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize("word", ["bushing", "rigid"])
def test_the_double_lane_change_of_iso_3888_at_80_km_h(word):
    """The error is measured again in NumPy, as the distance from the points of the path."""
    run = driven("lane_change", ("V", "80/3.6"), ("choose.compliance", word), duration=8)
    lanes = tuple(lane.shifted(30) for lane in STANDARDS["iso3888-1"](1.8))
    course = curve_through(path_through(lanes, 1.8, 30, 100))
    errors = course.nearest(run["chassis.x"], run["chassis.y"])[1]
    assert np.max(np.abs(errors)) < 0.15
    assert run["driver.lateral_error"] == pytest.approx(errors, abs=2e-3)
    for lane in lanes:
        inside = (run["chassis.x"] > lane.start) & (run["chassis.x"] < lane.end)
        assert np.all(np.abs(run["chassis.y"][inside] - lane.centre) < (lane.left - lane.right - 1.8) / 2), (
            "no cone is hit"
        )


@pytest.mark.long
def test_a_circle_of_100_m_at_20_m_s():
    run = driven("circle", ("R", "100"))
    assert np.max(np.abs(run["driver.lateral_error"])) < 0.15
    x, y = run["chassis.x"][500:], run["chassis.y"][500:]
    centre = np.linalg.lstsq(np.stack([2 * x, 2 * y, np.ones_like(x)], axis=1), x**2 + y**2, rcond=None)[0]
    assert np.hypot(x - centre[0], y - centre[1]) == pytest.approx(np.full_like(x, 100), abs=0.03)


@pytest.mark.long
@pytest.mark.sampled(6)
@pytest.mark.parametrize(("speed", "radius", "duration"), [(1, 20, 40), (5, 40, 20), (40, 600, 10), (60, 1200, 12)])
def test_the_driver_is_stable_from_1_to_60_m_s(speed, radius, duration):
    run = driven("circle", ("V", str(speed)), ("R", str(-radius)), duration=duration, output=0.05)
    assert np.max(np.abs(run["driver.lateral_error"])) < 0.2
    assert np.max(np.abs(run["driver.lateral_error"][-10:])) < 0.1
    turning = np.diff(np.sign(np.diff(run["driver.travel"][-60:])))
    assert np.count_nonzero(turning) < 3 or np.ptp(run["driver.travel"][-60:]) < 1e-5, "it does not weave"


def test_a_lap_closes_and_its_curvature_is_that_of_the_circle():
    angles = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    lap = curve_through(50 * np.stack([np.cos(angles), np.sin(angles)], axis=1), closed=True)
    assert lap.s[-1] == pytest.approx(2 * np.pi * 50, rel=1e-5)
    assert lap.curvature == pytest.approx(np.full_like(lap.s, 0.02), rel=3e-3)
    assert (lap.x[0], lap.y[0]) == (lap.x[-1], lap.y[-1])


def test_an_open_course_straightens_beyond_both_ends():
    course = curve_through(np.array([[0, 0], [10, 4], [30, 5], [60, 0]]))
    longer = straightened(course)
    inside = (longer.s >= 0) & (longer.s <= course.s[-1])
    assert longer.x[inside] == pytest.approx(course.x)
    assert abs(course.curvature[0]) > 0.02
    assert longer.curvature[[0, -1]] == pytest.approx([0, 0])
    at = np.linspace(longer.s[0], longer.s[-1], 1000)
    velocity = CubicSpline(longer.s, np.stack([longer.x, longer.y], axis=1))(at, 1)
    heading = np.unwrap(np.arctan2(velocity[:, 1], velocity[:, 0]))
    assert np.sin(heading) == pytest.approx(CubicSpline(longer.s, longer.sin)(at), abs=1e-3)
    assert np.gradient(heading, at) == pytest.approx(CubicSpline(longer.s, longer.curvature)(at), abs=1e-3)


@pytest.mark.long
def test_the_driver_goes_straight_on_from_the_end_of_a_circle():
    quarter = circle(80, 20, 30, 0.25)
    path = "{circle: 80 m, turns: 0.25, speed: [[0, 14 m/s], [150, 15 m/s]]}"
    run = driven("circle", ("V", "15"), ("path", path), ("use.driver.pace", "profile"), duration=20)
    assert run["driver.station"][-1] > quarter.s[-1] + 80
    assert abs(run["driver.lateral_error"][-1]) < 0.005
    assert run["driver.speed"][-1] == pytest.approx(15, abs=0.1)


def test_a_body_beyond_the_end_of_a_path_has_no_note_on_tables():
    """Users did not write these tables, and going on straight is intended; tables of their own keep their notes."""
    scene = """
dimensions: 3
path: {points: [[0, 0], [10, 0], [20, 2], [30, 3]], speed: [[0, 1], [20, 2]]}
tables: {push: {table: [[0, 0], [1, 1], [2, 4]]}}
bodies: {b: {mass: 1, inertia: [1, 1, 1], velocity: [50, 0, 0]}}
forces: {f: {type: force, i: b, force: ["path_curvature(b.x)", "path_sin(b.x)", "path_speed(b.x) + push(b.x)"]}}
requests: {aside: dy(b) - path_y(dx(b))}
run: {duration: 2, points: 11}
"""
    notes = [note for note in stiffmbs.run(stiffmbs.read_scene(scene)).notes if "was left for" in note]
    assert [note[: note.index(" was")] for note in notes] == ["f: the table 'push'"]


@pytest.mark.long
def test_a_speed_profile_along_points_with_the_pedal_at_the_end():
    points = "[[0, 0], [10, 0], [20, 0], [30, 0], [40, 0], [80, 4], [120, 4], [200, 0], [300, 0]]"
    path = f"{{points: {points}, speed: [[0, 15 m/s], [60, 15 m/s], [110, 20 m/s], [400, 20 m/s]]}}"
    changes = [("V", "15"), ("path", path), ("use.driver.pace", "profile"), ("use.driver.parameters.brakes", "9")]
    run = driven("circle", *changes, duration=11)
    assert np.max(np.abs(run["driver.lateral_error"])) < 0.15
    at = np.searchsorted(run.time, 8.9)
    assert run["driver.speed"][at] == pytest.approx(20, abs=0.2)
    assert run["driver.speed"][-1] < 14, "braked"


@pytest.mark.long
@pytest.mark.sampled(2)
@pytest.mark.parametrize("manoeuvre", ["lane_change", "circle"])
def test_a_car_with_a_driver_on_a_path_stands(manoeuvre):
    scene = stiffmbs.load_scene(EXAMPLES / "car.yaml", [("choose.manoeuvre", manoeuvre), ("V", "0")])
    found = stiffmbs.equilibrium(scene)
    assert abs(found.channels["driver.travel"]) < 1e-4
    assert found.channels["driver.pace"] == pytest.approx(1, abs=1e-9), "the least that the driver sees"


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize("pedal", [6e3, 12e3])
def test_the_pedal_is_the_braking_force(pedal):
    """The wheels take it by the radius of the driver, 0.3 m, and the road gives it back by the loaded one."""
    parameters = f"{{target: V, begins: -1 s, brakes: 0.5 s, pedal: {pedal} N}}"
    run = driven("straight", ("V", "30"), ("use.driver.parameters", parameters), duration=2)
    assert run["driver.brake"][-1] == pytest.approx(-pedal, rel=2e-3)
    torques = sum(run[f"driver.brake_{end}_{side}.ty"][-1] for end in ("front", "rear") for side in ("left", "right"))
    assert -torques == pytest.approx(0.3 * pedal, rel=2e-3)


@pytest.mark.parametrize(
    ("path", "message"),
    [
        ("{circle: 0 m}", "path.circle: found 0"),
        ("{points: [[0, 0], [0, 0], [1, 1]]}", "path.points: found the point (0.0, 0.0) twice"),
        ("{points: [[0, 0]]}", "path.points: found 1 points, expected 2 or more"),
        ("{lanes: iso3888-3}", "path.lanes"),
        ("{lanes: iso3888-1, circle: 50 m}", "path: found circle and lanes, expected one of points, circle, lanes"),
        ("{}", "path: found no course"),
        ("{circle: 50 m, speed: [[0, 1], [0, 2]]}", "path.speed: found arc lengths that do not increase"),
        ("5", "path: found 5"),
    ],
)
def test_a_fault_in_a_path_is_named(path, message):
    with pytest.raises(stiffmbs.InputError) as error:
        stiffmbs.load_scene(EXAMPLES / "car.yaml", [("choose.manoeuvre", "circle"), ("path", path)])
    assert message in str(error.value)
