"""bdf at event functions that stay about zero: breakpoints are passed, jumps that the motion is driven back to are told."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import AppliedForce, Body, Contact, Model, Prismatic
from stiffmbs.solve.trajectory import Outcome


def block(law, velocity=0.0):
    """1 kg on a rail along x under one force."""
    model = Model()
    model.add("block", Body(mass=1, inertia=1, velocity=(velocity, 0)))
    model.add("rail", Prismatic(i="block", j="ground"))
    model.add("push", AppliedForce(i="block", force=(law, 0)))
    return model


def solved(model, duration=1.0, **settings):
    return stiffmbs.run(model, solver="bdf", duration=duration, points=101, **settings)


@pytest.mark.parametrize("rtol", [1e-4, 1e-7, 1e-10])
def test_a_contact_whose_gap_starts_at_zero_presses_at_once(rtol):
    """Laid on the floor the ball sinks by rounding alone for the first steps, then swings about m g = K d^1.5."""
    model = Model(gravity=(0, -9.81))
    model.add("ball", Body(mass=1, inertia=1, position=(0, 0.1)))
    model.add("floor", Contact(i="ball", j="ground", radius=0.1, stiffness=1e6))
    solution = solved(model, duration=0.05, rtol=rtol)
    assert solution.outcome is Outcome.DONE
    assert solution.solver["events"] <= 10
    depth = 0.1 - solution["ball.y"]
    energy = solution["energy.total"]
    assert depth.max() == pytest.approx((2.5 * 9.81 / 1e6) ** (2 / 3), rel=1e-2)  # m g d = K d^2.5/2.5
    assert np.ptp(energy) < max(100 * rtol, 1e-7)


@pytest.mark.parametrize("rtol", [1e-6, 1e-10])
def test_the_cam_under_its_follower_starts_with_no_gap(examples, rtol):
    solution = stiffmbs.run(stiffmbs.load_scene(examples / "cam_follower.yaml"), rtol=rtol)
    assert solution.outcome is Outcome.DONE
    assert solution.solver["events"] < 60


def test_motion_that_comes_to_rest_on_a_corner_goes_on():
    """A damped spring, four times as stiff to the left, at rest on its breakpoint: nothing of it is lost."""
    solution = solved(block("-9*block.x + 27*max(0, -block.x) - 3*block.vx", 1.0), duration=60.0, rtol=1e-8)
    assert solution.outcome is Outcome.DONE
    assert solution.solver["events"] < 100
    assert abs(solution["block.x"][-1]) < 1e-8


@pytest.mark.parametrize("rtol", [1e-3, 1e-6, 1e-10])
def test_dry_friction_is_told_where_the_block_comes_to_rest(rtol):
    solution = solved(block("-5*sign(block.vx)", 1.0), rtol=rtol)
    assert solution.outcome is Outcome.STOPPED
    assert "'push'" in solution.message and "t = 0.2" in solution.message and "joint_friction" in solution.message
    np.testing.assert_allclose(solution["block.x"], solution.time - 2.5 * solution.time**2, atol=10 * rtol)
    assert len(solution.time) >= 20
    assert solution.solver["steps"] < 200


@pytest.mark.parametrize("pull", [0.0, 2.0])
def test_dry_friction_at_rest_is_told_at_the_start(pull):
    solution = solved(block(f"{pull} - 5*sign(block.vx)"))
    assert solution.outcome is Outcome.STOPPED
    assert "t = 0 s" in solution.message and "'push'" in solution.message
    assert len(solution.time) == 1


def test_a_pull_that_friction_cannot_hold_starts_the_block():
    solution = solved(block("8 - 5*sign(block.vx)"), rtol=1e-9)
    np.testing.assert_allclose(solution["block.x"], 1.5 * solution.time**2, atol=1e-8)


def test_a_jump_that_the_motion_crosses_is_an_event():
    """x'' = -5 sign(x) from x = 0 at 1 m/s: parabolas of 0.4 s, one after the other."""
    solution = solved(block("-5*sign(block.x)", 1.0), duration=2.0, rtol=1e-9)
    assert solution.solver["events"] == 5 or solution.solver["events"] == 4  # the last is at the end
    t = np.mod(solution.time, 0.8)
    expected = np.where(t < 0.4, t - 2.5 * t**2, -(t - 0.4) + 2.5 * (t - 0.4) ** 2)
    np.testing.assert_allclose(solution["block.x"], expected, atol=1e-7)


@pytest.mark.long
def test_a_relay_about_its_rest_is_told():
    """A damped spring with 0.1 N towards the middle comes to rest there in ever shorter swings."""
    solution = solved(block("-9*block.x - 0.1*sign(block.x) - 3*block.vx", 1.0), duration=600.0, rtol=1e-4)
    assert solution.outcome is Outcome.STOPPED
    assert "'push'" in solution.message
    assert abs(solution["block.x"][-1]) < 1e-2


def test_smooth_friction_at_rest_is_no_jump():
    solution = solved(block("-5*tanh(block.vx/1e-3) - abs(block.vx)*block.vx", 1.0), rtol=1e-6)
    assert solution.outcome is Outcome.DONE
    assert abs(solution["block.vx"][-1]) < 1e-6
