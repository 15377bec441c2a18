"""Estimated errors of bodies that turn over and spin, against Euler's equations and runs with a much smaller tolerance."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stiffmbs
from stiffmbs.results.digits import KnownErrors, largest_bar
from tests.error_estimate.test_against_truth import ratio, solved

PRINCIPAL = np.array([0.01, 0.02, 0.03])
START = np.array([0.01, 10.0, 0.02])
"""Angular velocity about the intermediate axis, rad/s: the body turns over again and again (Dzhanibekov)."""
TURNING_OVER = f"""
dimensions: 3
bodies: {{r: {{mass: 1, inertia: {PRINCIPAL.tolist()}, omega: {START.tolist()}}}}}
run: {{duration: 5, points: 201}}
"""


def turning_over(t):
    """Return the angular velocities of a free body in its own axes, and its quaternion, by Euler's equations."""

    def rates(_, y):
        w, (p0, *p) = y[:3], y[3:]
        turned = np.array([-np.dot(p, w), *(p0 * w + np.cross(p, w))])
        return np.concatenate([np.cross(PRINCIPAL * w, w) / PRINCIPAL, 0.5 * turned])

    start = np.concatenate([START, [1.0, 0.0, 0.0, 0.0]])
    return solve_ivp(rates, (0, t[-1]), start, "DOP853", t, rtol=1e-13, atol=1e-13).y


@pytest.mark.long
@pytest.mark.sampled(8)
@pytest.mark.parametrize(
    "solver, rtol", [("bdf", 1e-4), ("bdf", 1e-6), ("bdf", 1e-8), ("radau", 1e-3), ("radau", 1e-6), ("radau", 1e-8)]
)
def test_a_body_that_turns_over(solver, rtol):
    """In axes of the ground, errors turned as fast as the body: they were lost by bdf, and 20 to 130 times too large by radau."""
    found = solved(TURNING_OVER, solver=solver, rtol=rtol)
    truth = dict(zip(("r.wx", "r.wy", "r.wz", "r.q0", "r.q1", "r.q2", "r.q3"), turning_over(found.time), strict=True))
    for channel in ("r.wx", "r.wy", "r.q0", "r.q2"):
        assert 0.6 < ratio(found, channel, truth[channel]) < 1.5, channel


@pytest.mark.long
def test_bodies_that_turn_over_many_times_are_not_lost():
    """Nineteen turns over in 10 s; the true errors of quaternions are 4e-4."""
    scene = TURNING_OVER.replace("10.0", "30.0").replace("duration: 5", "duration: 10")
    found, truth = solved(scene, solver="bdf", rtol=1e-8), solved(scene, solver="projected", rtol=1e-12)
    assert found.estimate.status == "estimated"
    for channel in ("r.q0", "r.q3", "r.wx", "r.wy"):
        assert 0.8 < ratio(found, channel, truth[channel]) < 1.25, channel


@pytest.mark.long
def test_a_body_in_the_plane_that_turns_within_steps():
    """Its error estimated by the seven points of a step, of up to two radians, was 12 times too large."""
    scene = """
        gravity: [0, -9.81]
        bodies:
          a: {mass: 1, inertia: 0.01, position: [0.3, 0], omega: 100}
          b: {mass: 1, inertia: 0.01, position: [1.3, 0]}
        forces:
          s: {type: spring_damper, i: {body: a, point: [0.1, 0]}, j: {body: b, point: [0, 0.1]}, stiffness: 100, damping: 0.1, free_length: 0.5}
        run: {duration: 10, points: 201}
        """
    found, truth = solved(scene, solver="radau", rtol=1e-8), solved(scene, solver="projected", rtol=1e-12)
    for channel in ("a.x", "a.angle", "b.omega", "s.fx"):
        assert 0.7 < ratio(found, channel, truth[channel]) < 1.4, channel


def test_peaks_of_euler_parameters_between_outputs_take_no_digits():
    """A wheel at 40 rad/s with ten outputs a second: its quaternion has its peaks between them."""
    found = stiffmbs.run(
        stiffmbs.read_scene("""
dimensions: 3
bodies: {wheel: {mass: 10, inertia: [1, 2, 1], omega: [0, 40, 0], velocity: [12, 0, 0]}}
run: {duration: 1, points: 11, solver: radau}
"""),
        errors=True,
    )
    assert found.errors["wheel.q0"].greatest > 0.01
    assert KnownErrors(found).digits(largest_bar)["positions"] > 6
