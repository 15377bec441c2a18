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
