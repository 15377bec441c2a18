"""Angles between markers in space count whole turns: gears of any ratio, drives and measures over many turns."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import spatial

SOLVERS = (
    {"solver": "bdf"},
    {"solver": "projected", "scheme": "dop853"},
    {"solver": "projected", "step": 2e-3},
    {"solver": "kinematic"},
)
RATIO = 1.37


def geared(start=0.0):
    """A motor turns wheel a, which drives wheel b; both start turned by an angle."""
    model = spatial.Model("gears", gravity=(0, 0, -9.81))
    turned = {"euler": "zxz", "angles": [start, 0, 0]}
    model.add("a", spatial.Body(mass=1, inertia=(1, 1, 1), orientation=turned))
    model.add("b", spatial.Body(mass=1, inertia=(1, 1, 1.2), position=(1, 0, 0)))
    model.add("pin_a", spatial.Revolute(i="a", j="ground"))
    model.add("pin_b", spatial.Revolute(i="b", j=spatial.Marker(body="ground", point=(1, 0, 0))))
    model.add("mesh", spatial.Gear(joint_1="pin_a", joint_2="pin_b", ratio=RATIO))
    model.request("turned_a", "az(a, ground)")
    model.request("turned_b", "az(b, ground)")
    return model


@pytest.mark.sampled(3)
@pytest.mark.parametrize("settings", SOLVERS)
def test_wheels_turn_many_times(settings):
    model = geared()
    model.add("motor", spatial.Drive(joint="pin_a", position="3*t + 4*t^2"))
    solution = stiffmbs.run(model, duration=6.0, rtol=1e-7, output=0.5, **settings)
    t = solution.time
    assert np.allclose(solution["turned_a"], 3 * t + 4 * t**2, rtol=0, atol=1e-9)
    assert np.allclose(solution["turned_b"], -(3 * t + 4 * t**2) / RATIO, rtol=0, atol=1e-9)
    assert np.allclose(solution["motor.tz"], 8 * (1 + 1.2 / RATIO**2))
    assert np.nanmax(solution["constraint.position"]) < 1e-12


def test_a_gear_holds_from_any_pose_drawn():
    model = geared(start=3.0)
    model.add("push", spatial.Drive(joint="pin_a", velocity="20"))
    solution = stiffmbs.run(model, duration=2.0, rtol=1e-8, output=0.1)
    assert np.allclose(solution["turned_a"], 3.0 + 20 * solution.time, rtol=0, atol=1e-6)
    assert np.allclose(solution["turned_b"], -20 * solution.time / RATIO, rtol=0, atol=1e-6)


def test_an_angle_far_from_zero_is_as_exact_as_one_near_it():
    """A counter decides about the turn alone: after 1000 rad the angle is that of the quaternion."""
    model = spatial.Model("wheel")
    model.add("wheel", spatial.Body(mass=1, inertia=(1, 1, 1), omega=(0, 0, 100)))
    model.add("pin", spatial.Revolute(i="wheel", j="ground"))
    model.request("turned", "az(wheel, ground)")
    solution = stiffmbs.run(model, duration=10.0, rtol=1e-6, output=1.0)
    half = np.arctan2(solution["wheel.q3"], solution["wheel.q0"])
    assert np.abs(np.sin(half - solution["turned"] / 2)).max() < 1e-13
    assert abs(solution["turned"][-1] - 1000) < 0.1


FAST = (
    ({"rtol": 1e-2}, False),
    ({"solver": "auto", "rtol": 1e-4}, True),
    ({"solver": "projected", "scheme": "rk4", "step": 1e-3}, False),
    ({"solver": "projected", "scheme": "dop853", "rtol": 1e-3}, True),
)
"""Settings, and whether the steps follow the orientation.  Over 3000 rad the quaternion of the first falls behind by 661 rad,
that of the third by 41 rad: the angle is then anywhere within half a turn of the counter."""
OF_COUNTER = 0.01
"""Error of the counter at rtol 1e-2, rad (measured: 0.0041)."""


@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize("settings, follows", FAST)
def test_a_request_counts_as_a_torsion_spring_does(settings, follows):
    """3000 rad/s, whatever the output points: omega = omega_0 cos(w t) with w^2 = k/I, phi = omega_0/w sin(w t)."""
    model = spatial.Model("wheel")
    model.add("wheel", spatial.Body(mass=1, inertia=(1, 1, 1), omega=(0, 0, 3000)))
    model.add("pin", spatial.Revolute(i="wheel", j="ground"))
    model.add("spring", spatial.TorsionSpring(i="wheel", j="ground", stiffness=1e-3))
    model.request("turned", "az(wheel)")
    model.request("sum", "az(wheel) + 2*az(wheel, ground)")
    w, apart = np.sqrt(1e-3), 0.3 if follows else np.pi + OF_COUNTER
    for points in (2, 11, 1001):
        solution = stiffmbs.run(model, duration=1.0, points=points, errors=True, **settings)
        assert np.allclose(solution["turned"], -solution["spring.tz"] / 1e-3, rtol=0, atol=1e-6)
        assert np.allclose(solution["turned"], 3000 / w * np.sin(w * solution.time), rtol=0, atol=apart)
        assert np.allclose(solution["sum"], 3 * solution["turned"], rtol=1e-12)
        told = any("revolutions" in note and "'spring'" in note for note in solution.notes)
        # at the end alone, the orientation may be near the counter by chance
        assert not told if follows else told or any("the solution is lost" in note for note in solution.notes)


def test_turns_are_counted_beside_a_pole():
    """An axis 1.7 degrees from the one that it turns about: a counter that is slow by 1e-4 there is in a wrong turn by 30 000 rad."""
    tilt = np.arcsin(0.03) - np.pi / 2
    model = spatial.Model("sphere")
    turned = {"euler": "xyz", "angles": [0, tilt, 0]}
    spin = (-200 * np.sin(tilt), 0, 200 * np.cos(tilt))
    model.add("sphere", spatial.Body(mass=1, inertia=(1, 1, 1), omega=spin, orientation=turned))
    model.request("turned", "az(sphere)")
    solution = stiffmbs.run(model, duration=500.0, points=2, solver="projected", scheme="dop853", rtol=1e-6)
    assert solution["turned"][-1] - solution["turned"][0] == pytest.approx(1e5, abs=0.1)
    assert not any("revolutions" in note for note in solution.notes)


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize("points", [2, 7, 101])
def test_an_angle_that_swings_between_output_points_is_counted(points):
    model = geared()
    model.add("motor", spatial.Drive(joint="pin_a", position="300*t + 40*sin(2*pi*t)"))
    solution = stiffmbs.run(model, duration=2.0, points=points, solver="kinematic")
    assert np.allclose(solution["turned_a"], 300 * solution.time + 40 * np.sin(2 * np.pi * solution.time), atol=1e-8)
    assert np.allclose(solution["turned_b"], -solution["turned_a"] / RATIO, rtol=0, atol=1e-8)


def test_bodies_that_are_merged_and_mechanisms_apart_are_counted():
    """A wheel with a fixed hub and, apart from it, another one: the presolve keeps both requests."""
    model = spatial.Model("wheels")
    for name, x, omega in (("one", 0.0, 50.0), ("two", 1.0, -70.0)):
        place = spatial.Marker(body="ground", point=(x, 0, 0))
        model.add(name, spatial.Body(mass=1, inertia=(1, 1, 1), position=(x, 0, 0), omega=(0, 0, omega)))
        model.add(f"pin_{name}", spatial.Revolute(i=name, j=place))
    model.add("hub", spatial.Body(mass=1, inertia=(1, 1, 1), omega=(0, 0, 50.0)))
    model.add("weld", spatial.Fixed(i="hub", j="one"))
    model.request("hub_turned", "az(hub)")
    model.request("apart", "az(two, one)")
    model.request("on_it", "az(hub, one)")
    for presolve in (True, False):
        solution = stiffmbs.run(model, duration=10.0, points=3, presolve=presolve)
        assert np.allclose(solution["hub_turned"], [0, 250, 500], rtol=1e-5)
        assert np.allclose(solution["apart"], [0, -600, -1200], rtol=1e-5)
        assert np.allclose(solution["on_it"], 0, atol=1e-12)


def test_an_angle_that_has_no_direction_at_a_pole_stops_no_run():
    """A turn about y takes the x axis through the z axis, where az jumps by half a turn and comes back."""
    model = spatial.Model("tumbling")
    model.add("body", spatial.Body(mass=1, inertia=(1, 2, 3), omega=(0, 5, 0)))
    model.request("about_z", "az(body)")
    model.request("about_y", "ay(body)")
    solution = stiffmbs.run(model, duration=10.0, points=11)
    assert np.allclose(solution["about_y"], 5 * solution.time, atol=1e-4)
    assert np.abs(solution["about_z"]).max() < 3.2
