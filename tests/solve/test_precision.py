"""Tolerances below what the rounding of coordinates leaves are told for what they are."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import Body, Marker, Model, Revolute
from stiffmbs.analyses.job import prepare
from stiffmbs.solve.error_control.precision import governed_by_rounding, too_fine
from stiffmbs.solve.explicit.native.parameters import CONTROL
from stiffmbs.solve.trajectory import Outcome


def pendulum(speed=0.0, at=0.0):
    """A bar of 1 kg on a hinge at a place on the x axis, turning at a speed."""
    model = Model("pendulum", gravity=(0, -9.81))
    bar = model.add("bar", Body(mass=1, inertia=0.1, position=(at + 1, 0), velocity=(0, speed), omega=speed))
    model.add("hinge", Revolute(i=bar.at(-1, 0), j=Marker(body="ground", point=(at, 0))))
    return model


@pytest.mark.long
def test_a_fast_pendulum_at_a_tight_tolerance_is_told_its_rounding():
    solution = stiffmbs.run(pendulum(1e4), duration=1.0, rtol=1e-10, points=11)
    assert solution.outcome is Outcome.STOPPED
    assert "rtol = 1e-10 is below rounding: bar.angle" in solution.message


@pytest.mark.long
@pytest.mark.sampled(2)
@pytest.mark.parametrize("solver", ["bdf", "radau"])
def test_a_planet_on_an_arm_is_told_the_rounding_of_its_place_or_moves(solver):
    """An arm of 1.5e11 m: radau blamed a jump or kink, 'axis' violated by 5 km. Explicit steps, which both advise, pass."""
    model = stiffmbs.read_scene("""
dimensions: 3
bodies:
  arm: {mass: 1e20, inertia: [1e35, 1e35, 1e35], omega: [0, 0, 2e-7]}
  earth: {mass: 6e24, inertia: [8e37, 8e37, 8e37], position: [1.5e11, 0, 0], velocity: [0, 3e4, 0], omega: [0, 0, 7.3e-5]}
joints:
  sun: {type: revolute, i: arm, j: ground}
  axis: {type: revolute, i: earth, j: {body: arm, point: [1.5e11, 0, 0], orientation: {euler: yxz, angles: [0.4, 0, 0]}}}
  orbit: {type: drive, joint: sun, velocity: 2e-7 rad/s}
  spin: {type: drive, joint: axis, velocity: 7.3e-5 rad/s}
run: {duration: 7.9e6, points: 92}
""")
    solution = stiffmbs.run(model, solver=solver)
    assert solution.success or "rtol = 1e-06 is below rounding: earth.x = 1.5e+11 m" in solution.message
    exact = stiffmbs.run(model, solver="projected", scheme="dop853")
    assert exact["earth.x"][-1] == pytest.approx(1.5e11 * np.cos(2e-7 * 7.9e6), abs=1e4)


def test_a_pendulum_far_from_the_origin_swings_as_one_at_it():
    """Coordinates of 1e6 m are known to 6e-11 m; the motion is not known better."""
    there, here = (stiffmbs.run(pendulum(at=at), duration=1.0, rtol=1e-10, points=11) for at in (1e6, 0.0))
    assert there.outcome is here.outcome is Outcome.DONE
    np.testing.assert_allclose(there["bar.angle"], here["bar.angle"], atol=1e-7)


@pytest.mark.parametrize("speed, rtol", [(1e4, 1e-8), (1e3, 1e-9)])
def test_tolerances_that_rounding_allows_are_kept(speed, rtol):
    """Energy of the fast pendulum: omega^2 = omega_0^2 - 2 m g l sin(phi)/I."""
    solution = stiffmbs.run(pendulum(speed), duration=0.05, rtol=rtol, points=11)
    assert solution.outcome is Outcome.DONE
    expected = np.sqrt(speed**2 - 2 * 9.81 * np.sin(solution["bar.angle"]) / 1.1)
    assert np.allclose(solution["bar.omega"], expected, rtol=3e3 * rtol, atol=0)


@pytest.mark.parametrize("x, rounding", [(0.5, 2.22e-16), (4.0, 8.9e-16)])
def test_the_rounding_of_a_flat_equation_is_told_in_numbers(x, rounding):
    """Rounding of coordinates, those of 1 at least, over the slope 1e-9 sqrt(2) of the equation."""
    job = prepare(
        stiffmbs.read_scene(f"""
bodies: {{b: {{mass: 1, inertia: 1, position: [{x}, {-x}]}}}}
joints: {{flat: {{type: equation, zero: 1e-9*(b.x + b.y)}}}}
run: {{duration: 1, rtol: 1e-9}}
""")
    )
    sentence = too_fine(job.dynamics, job.settings, 0.0, job.start.q)
    assert sentence.startswith(
        "rtol = 1e-09 is below rounding: the derivatives of 'flat' by coordinates are at most 1e-09"
    )
    assert f"moves coordinates by {rounding / 1.4142e-9:.1g}" in sentence


def test_rounding_governs_a_long_run_that_fails_a_fifth_of_its_error_tests():
    steps = 10 * CONTROL.enough_steps
    failed = [governed_by_rounding({"steps": steps, "rejected": int(part * steps)}) for part in (0.15, 0.25)]
    assert failed == [False, True]


@pytest.mark.parametrize(
    "amplitude, settings, noted", [(1e-9, {}, True), (1e-9, {"atol": 1e-15}, False), (0.01, {}, False)]
)
def test_a_small_motion_of_a_model_without_a_size_is_noted(amplitude, settings, noted):
    """All markers are at the origin: the absolute tolerance is 1e-6 m, and the plate of a sensor vibrates by 1 nm."""
    scene = f"""
bodies: {{plate: {{mass: 1e-11, inertia: 1e-22}}}}
joints: {{rail: {{type: prismatic, i: plate, j: ground}}}}
forces:
  spring: {{type: bushing, i: plate, j: ground, stiffness: [2, 0, 0]}}
  push: {{type: force, i: plate, force: [{2 * amplitude}, 0]}}
run: {{duration: 1e-4, points: 101}}
"""
    solution = stiffmbs.run(stiffmbs.read_scene(scene), **settings)
    assert any("set atol" in note for note in solution.notes) is noted
    expected = amplitude * (1 - np.cos(np.sqrt(2 / 1e-11) * solution.time))
    assert noted or np.abs(solution["plate.x"] - expected).max() < 1e-3 * amplitude
