"""Reactions of any size stay outside of the error test."""

import pytest

import stiffmbs

SCENE = """
parameters: {M: 1 kg}
gravity: [0, -9.81]
bodies:
  wheel: {mass: M, inertia: M*(1 m)^2}
  bob: {mass: 1, inertia: 0.01, position: [1.5, 0]}
joints:
  axle: {type: revolute, i: wheel, j: ground}
  brake: {type: drive, joint: axle, velocity: 0}
  pin: {type: revolute, i: {body: bob, point: [-0.5, 0]}, j: {body: wheel, point: [1, 0]}}
run: {duration: 2 s, points: 201, rtol: 1e-8, presolve: false}
"""


@pytest.mark.parametrize("mass", ["1 kg", "6e24 kg"])
def test_a_pendulum_swings_on_a_held_body_of_any_mass(mass):
    solution = stiffmbs.run(stiffmbs.read_scene(SCENE, [("M", mass)]))
    assert solution.success, solution.message
    kinetic = 0.5 * (0.01 + 0.5**2) * solution["bob.omega"] ** 2
    assert abs(kinetic + 9.81 * solution["bob.y"]).max() < 1e-6
    assert solution["axle.fy"][0] == pytest.approx(9.81 * (float(mass.split()[0]) + 1 - 0.25 / 0.26))
