"""Paths through the lanes of ISO 3888, distances to their cones, and the search of the highest entry speed."""

from types import SimpleNamespace

import numpy as np
import pytest

import stiffmbs
from stiffmbs.model.paths.lanes import STANDARDS, USED, Lane, path_through
from stiffmbs.studies.handling.known import SEEN, Known
from stiffmbs.studies.handling.lane_changes import PART_2, highest_entry_speed, in_lanes, least_clearance, of_lanes
from stiffmbs.studies.handling.parameters import ObstacleAvoidance

CAR = SimpleNamespace(
    angular=False, middle=(-0.1, 0.05, 0.3), measured=(0.2, 0.0, 0.5), centre=(0.0, 0.0, 0.5), behind=lambda _: 1.4
)
KNOWN = Known(CAR, 0.33, 4e-4, 1.8, {}, 0.13, 4.4)


def corners(x, y, yaw, width, length):
    """Return the corners of a rectangle about a place, shape (4, 2)."""
    axes = np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]])
    return (
        np.array([x, y]) + np.array([[u, v] for u in (-length / 2, length / 2) for v in (-width / 2, width / 2)]) @ axes
    )


def run_at(x, y, yaw, **more):
    """Return a run whose vehicle has its middle at places; channels are those of the reference point."""
    x, y, yaw = (np.atleast_1d(np.asarray(each, dtype=float)) for each in (x, y, yaw))
    ahead, left = 0.3, -0.05  # from the middle to the reference point
    return {
        "vehicle.x": x + np.cos(yaw) * ahead - np.sin(yaw) * left, "vehicle.y": y + np.sin(yaw) * ahead + np.cos(yaw) * left,
        "vehicle.yaw": yaw, **more,
    }  # fmt: skip


@pytest.mark.parametrize("standard", STANDARDS)
@pytest.mark.parametrize(("width", "length"), [(1.5, 2.5), (1.72, 4.32), (1.9, 5.0)])
def test_corners_stay_within_the_lanes_of_a_path_that_ends_straight(standard, width, length):
    """The centre stayed, not the corners; after the last lane the path went 0.8 m aside."""
    lanes = tuple(lane.shifted(30) for lane in STANDARDS[standard](width))
    x, y = path_through(lanes, width, 30, 100, length).T
    slope = np.gradient(y, x)
    fine = np.linspace(x[0], x[-1], 2000)
    places = np.stack([corners(*each, 0.0, width, length)[:, 0] for each in zip(fine, 0 * fine, strict=True)])
    middle, turn = np.interp(fine, x, y), np.interp(fine, x, slope)
    for lane in lanes:
        free = (lane.left - lane.right - width) / 2
        for k, u in ((0, -length / 2), (2, length / 2)):
            inside = (places[:, k] >= lane.start) & (places[:, k] <= lane.end)
            assert np.max(np.abs(middle + u * turn - lane.centre)[inside]) < USED * free + 0.03
    after = x > lanes[-1].end
    assert np.max(np.abs(y[after] - lanes[-1].centre)) < (lanes[-1].left - lanes[-1].right - width) / 2
    assert y[x > lanes[-1].end + 30] == pytest.approx(lanes[-1].centre, abs=1e-9)


def test_lanes_that_a_vehicle_does_not_fit_are_refused():
    with pytest.raises(ValueError, match=r"found lanes too narrow for a vehicle of 2\.5 m by 15 m"):
        path_through(STANDARDS[PART_2](2.5), 2.5, 30, 100, 15.0)


def test_the_distance_to_cones_is_that_of_corners_and_sides():
    lane = Lane(10.0, 20.0, -1.1, 1.1)
    assert least_clearance([lane], KNOWN, run_at(15, 0.05, 0)) == pytest.approx(0.15)
    assert least_clearance([lane], KNOWN, run_at(15, 0, 0.05)) == pytest.approx(
        1.1 - 0.9 * np.cos(0.05) - 2.2 * np.sin(0.05)
    )
    assert least_clearance([lane], KNOWN, run_at(5, 3, 0)) == np.inf
    pose = run_at(21.0, 0.3, 0.3)  # its side passes the last left cone, its rear corners are still within
    by_side = (1.1 - 0.3) * np.cos(0.3) - (20 - 21.0) * np.sin(0.3) - 0.9
    by_corner = -(-1.1 - (0.3 - 2.2 * np.sin(0.3) - 0.9 * np.cos(0.3)))
    assert least_clearance([lane], KNOWN, pose) == pytest.approx(min(by_side, by_corner))


@pytest.mark.parametrize("seed", range(5))
def test_a_cone_is_hit_if_a_point_of_its_row_is_within_the_vehicle(seed):
    rng, lane = np.random.default_rng(seed), Lane(10.0, 20.0, -1.1, 1.1)
    row = np.linspace(lane.start, lane.end, 4001)
    for x, y, yaw in zip(rng.uniform(6, 24, 80), rng.uniform(-0.9, 0.9, 80), rng.uniform(-0.4, 0.4, 80), strict=True):
        hit = False
        for side in (lane.left, lane.right):
            u = np.cos(yaw) * (row - x) + np.sin(yaw) * (side - y)
            v = np.cos(yaw) * (side - y) - np.sin(yaw) * (row - x)
            hit |= bool(np.any((np.abs(u) < 2.2) & (np.abs(v) < 0.9)))
        found = least_clearance([lane], KNOWN, run_at(x, y, yaw))
        if abs(found) > 2e-3:
            assert (found < 0) == hit, (x, y, yaw)


def driving(limit):
    """Return a function that drives on the course without a cone hit up to a speed before it."""
    lanes = [lane.shifted(30) for lane in STANDARDS[PART_2](1.8)]

    def solve(manoeuvre):
        time = np.linspace(0, manoeuvre.duration, 4000)
        x = manoeuvre.speed * time
        points = path_through(tuple(lanes), 1.8, 30, 100, 4.4)
        y = np.interp(x, *points.T) + (5.0 if manoeuvre.speed > limit else 0.0)
        slope = np.interp(x, points[:, 0], np.gradient(points[:, 1], points[:, 0]))
        zero = np.zeros_like(x)
        return run_at(
            x, y, np.arctan(slope), **{
                "time": time, "vehicle.speed": zero + manoeuvre.speed - 0.2, "vehicle.ay": zero, "vehicle.yaw_rate": zero,
                SEEN: zero, "handling_driver.lateral_error": zero,
            },
        )  # fmt: skip

    return solve


def searched(test, limit):
    """Return the metrics of a search after those of the test's own run."""
    solve = driving(limit)
    own = of_lanes(PART_2)(KNOWN, test, [solve(each) for each in in_lanes(PART_2)(KNOWN, test)])
    return highest_entry_speed(KNOWN, test, own, solve)


def test_the_highest_entry_speed_is_that_at_the_end_of_the_first_lane():
    test = ObstacleAvoidance(slowest=10.0, fastest=20.0, resolution=0.1)
    found = searched(test, 15.3)["highest entry speed without a cone hit"]
    assert 15.1 - 0.1 < found[0] <= 15.1
    (one,) = in_lanes(PART_2)(KNOWN, test)
    assert one.driver["releases"] * test.speed == pytest.approx(32.0), "2 m within the first lane"


def test_a_search_finds_no_lower_speed_than_that_of_a_passed_test():
    """The metrics of one test contradicted each other: 13.81 m/s passed, and the highest speed was 13.68 m/s."""
    test = ObstacleAvoidance(speed=13.9, slowest=10.0, fastest=20.0, resolution=2.0)
    assert searched(test, 14.0)["highest entry speed without a cone hit"][0] == pytest.approx(13.7)


@pytest.mark.parametrize(
    ("limit", "said"),
    [
        (5.0, "no entry speed passes: the least distance to a cone is -4"),
        (25.0, "the fastest entry speed passes, 20 m/s"),
    ],
)
def test_a_search_without_a_result_says_so(limit, said):
    """The value was nan, and the message was empty."""
    test = ObstacleAvoidance(slowest=10.0, fastest=20.0)
    with pytest.raises(stiffmbs.InputError, match=said):
        searched(test, limit)


@pytest.mark.parametrize("ahead", [0.0, 1.2, -0.7])
@pytest.mark.parametrize("speed", [5.0, 8.0, 14.0, 22.0, 30.0])
def test_the_delay_at_a_speed_is_that_of_the_bicycle_model(speed, ahead):
    """Slope of the phase of the lateral acceleration at zero frequency, of a linear car.

    The ramp is measured at the reference point, and the driver's point is the centre of mass.
    """
    mass, inertia, a, b, front, rear = 1500.0, 2500.0, 1.2, 1.5, 9e4, 1.2e5

    def delay(v, ahead=0.0, w=1e-3):
        lever = a * front - b * rear
        matrix = np.array([
            [-(front + rear) / (mass * v), -v - lever / (mass * v)],
            [-lever / (inertia * v), -(a**2 * front + b**2 * rear) / (inertia * v)],
        ])  # fmt: skip
        x = np.linalg.solve(1j * w * np.eye(2) - matrix, [front / mass, a * front / inertia])
        return -np.angle(1j * w * (x[0] + ahead * x[1]) + v * x[1]) / w

    growth = mass / (a + b) ** 2 * (b / front - a / rear)
    car = SimpleNamespace(centre=0.0, measured=ahead, behind=lambda place: b + place)
    known = Known(car, a + b, growth * (a + b), 1.8, {}, delay(80 / 3.6, ahead))
    assert known.lag_at(speed) == pytest.approx(delay(speed), abs=1e-5)
