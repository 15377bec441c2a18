"""The cart-pendulum: rail force, motion and convergence against its two Euler-Lagrange equations."""

import itertools
import json

import numpy as np
import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs.commands.main import main

RAIL_FORCE = {0.0: 106.9941992390, 5.0: 107.1068184413, 10.0: 107.3999119123}
LARGEST_RAIL_FORCE, AT = 108.8457634070, 4.6508


@pytest.fixture(scope="module")
def scene(examples):
    return stiffmbs.load_scene(examples / "cart_pendulum.yaml")


@pytest.fixture(scope="module")
def fine(scene):
    return stiffmbs.run(scene, rtol=1e-8)


def test_rail_force_against_the_converged_one(fine):
    assert fine["rail.fy"][0] == pytest.approx(RAIL_FORCE[0.0], abs=1e-9)
    for t in (5.0, 10.0):
        assert fine["rail.fy"][np.searchsorted(fine.time, t)] == pytest.approx(RAIL_FORCE[t], abs=5e-6)


def test_motion_against_the_converged_one(fine):
    assert fine["cart.x"][-1] == pytest.approx(0.005385525470510, abs=1e-7)
    assert fine["bar.angle"][-1] + np.pi / 2 == pytest.approx(0.298328485255, abs=2e-6)


def test_constraints_hold(fine):
    assert fine["constraint.position"].max() < 1e-9
    assert fine["constraint.velocity"].max() < 1e-9


def test_largest_rail_force(scene):
    solution = stiffmbs.run(scene, rtol=1e-10, duration=5, output=1e-4)
    peak = int(np.argmax(solution["rail.fy"]))
    assert solution["rail.fy"][peak] == pytest.approx(LARGEST_RAIL_FORCE, abs=1e-7)
    assert solution.time[peak] == pytest.approx(AT, abs=1e-9)


def test_the_command_reports_the_same(examples, fine):
    result = CliRunner().invoke(main, ["run", str(examples / "cart_pendulum.yaml"), "--rtol", "1e-8", "--json"])
    channels = json.loads(result.output)["channels"]
    assert channels["rail.fy"]["first"] == pytest.approx(RAIL_FORCE[0.0], abs=1e-9)
    assert channels["cart.x"]["last"] == fine["cart.x"][-1]


def test_each_hundredfold_tightening_cuts_the_error_tenfold(scene, cart_pendulum_reference):
    errors = []
    for rtol in (1e-4, 1e-6, 1e-8, 1e-10):
        solution = stiffmbs.run(scene, rtol=rtol)
        x, theta = cart_pendulum_reference(solution.time)
        found = (solution["cart.x"] - x, solution["bar.angle"] + np.pi / 2 - theta)
        errors.append(max(np.max(np.abs(part)) for part in found))
    assert all(coarse > 10 * fine for coarse, fine in itertools.pairwise(errors)), errors


def test_multipliers_carry_the_weight_of_both_bodies(fine):
    """Newton's law for the whole: the rail's force is the weight and the inertia of the bar."""
    expected = 11 * 9.81 + 1.0 * fine["bar.ay"]
    np.testing.assert_allclose(fine["rail.fy"], expected, rtol=1e-12)


def test_own_steps_can_be_reported(scene):
    solution = stiffmbs.run(scene, points="steps", rtol=1e-6)
    assert len(solution.time) == solution.solver["steps"] + 1
    np.testing.assert_allclose(solution.time[1:], solution.step_times)
    assert solution.time[-1] == 10.0


def test_explicit_integrator_shows_the_chapters_errors(scene, cart_pendulum_reference):
    """Euler-Cromer with projection at 1 ms: 0.0963 mm, 0.0585 deg, 0.580 % of the energy, at every 49th step.

    The text does not say which steps it looks at; the stride was found by search.  Over all steps it is 0.0970 mm,
    0.0589 deg, 0.580 %.
    """
    solution = stiffmbs.run(scene, solver="projected", scheme="euler_cromer", points="steps")
    assert len(solution.time) == 10_001
    x, theta = cart_pendulum_reference(solution.time)
    shown = slice(None, None, 49)
    scale = 1.0 * 9.81 * 0.3 * (1 - np.cos(np.radians(20)))
    total = solution["energy.total"]
    assert 1e3 * np.max(np.abs(solution["cart.x"] - x)[shown]) == pytest.approx(0.0963, abs=5e-5)
    assert np.degrees(np.max(np.abs(solution["bar.angle"] + np.pi / 2 - theta)[shown])) == pytest.approx(
        0.0585, abs=5e-5
    )
    assert 100 * np.max(np.abs(total - total[0])) / scale == pytest.approx(0.580, abs=5e-4)
    assert 1e3 * np.max(np.abs(solution["cart.x"] - x)) == pytest.approx(0.0970, abs=5e-5)
    assert np.degrees(np.max(np.abs(solution["bar.angle"] + np.pi / 2 - theta))) == pytest.approx(0.0589, abs=5e-5)


def test_explicit_integrator_is_of_first_order(scene, cart_pendulum_reference):
    errors = []
    for step in (2e-3, 1e-3, 5e-4):
        solution = stiffmbs.run(scene, solver="projected", scheme="euler_cromer", step=step)
        errors.append(np.max(np.abs(solution["cart.x"] - cart_pendulum_reference(solution.time)[0])))
    assert errors[0] / errors[1] == pytest.approx(2, abs=0.1)
    assert errors[1] / errors[2] == pytest.approx(2, abs=0.1)
