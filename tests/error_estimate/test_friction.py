"""Estimated errors of friction where a velocity reverses, against runs of radau with a much smaller tolerance."""

import numpy as np
import pytest

import stiffmbs
from tests.error_estimate.test_against_truth import ratio

SLIDING = """
gravity: [0, -9.81]
bodies: {{m: {{mass: 1, inertia: 0.1, position: [1, 0]}}}}
joints: {{rail: {{type: prismatic, i: m, j: ground}}}}
forces:
  spring: {{type: spring_damper, i: m, j: {{body: ground, point: [-1, 0]}}, stiffness: 100, free_length: 1}}
  rubbing: {{type: joint_friction, joint: rail, friction: 0.3, static_friction: {static}, friction_velocity: 0.02 m/s, stiction_velocity: {velocity} mm/s}}
run: {{duration: 3, points: {points}}}
"""
TWO_BARS = """
gravity: [0, -9.81]
bodies: {a: {mass: 1, inertia: 0.1, position: [1, 0]}, b: {mass: 1, inertia: 0.1, position: [2, 0]}}
joints:
  p: {type: revolute, i: {body: a, point: [-1, 0]}, j: ground}
  q: {type: revolute, i: {body: b, point: [-1, 0]}, j: a}
forces:
  f: {type: joint_friction, joint: p, friction: 0.3, radius: 0.02, friction_velocity: 0.02, stiction_velocity: 0.001}
  g: {type: torque, i: b, j: a, torque: "-0.5*tanh((b.omega - a.omega)/0.001)"}
run: {duration: 3, points: 301}
"""


def compared(scene, channels, **how):
    """Return the estimated errors of channels in the true ones."""
    scene = stiffmbs.read_scene(scene)
    found = stiffmbs.run(scene, errors=True, **how)
    truth = stiffmbs.run(scene, solver="radau", rtol=1e-11, errors=False)
    return np.array([ratio(found, channel, truth[channel]) for channel in channels])


@pytest.mark.parametrize(
    "static, velocity, how",
    [
        (0.3, 0.1, {"solver": "bdf", "rtol": 1e-3}),
        (0.5, 1, {"solver": "bdf", "rtol": 1e-4}),
        (0.3, 1, {"solver": "radau", "rtol": 1e-3}),
        (0.3, 1, {"solver": "bdf", "rtol": 1e-6}),
    ],
)
def test_friction_at_a_reversal(static, velocity, how):
    """Interpolated between the nodes of the estimate, errors of forces were 0.006, 7, 0.1 and 10 times the true ones."""
    scene = SLIDING.format(static=static, velocity=velocity, points=3001)
    ratios = compared(scene, ("m.ax", "rubbing.fx"), **how)
    assert (ratios > 0.5).all() and (ratios < 2.0).all()


@pytest.mark.long
def test_friction_at_a_reversal_between_outputs():
    """A node in a reversal gave its error to outputs away from it: 56 times the true one of a torque, 3 times that of a joint."""
    ratios = compared(TWO_BARS, ("g.torque", "p.fx", "q.fx"), solver="bdf", rtol=1e-3)
    assert (ratios > 0.5).all() and (ratios < 2.0).all()


STOPPING = """
gravity: [0, -9.81]
bodies: {block: {mass: 1, inertia: 0.01, velocity: [2, 0]}}
joints: {rail: {type: prismatic, i: block, j: ground}}
forces: {f: {type: joint_friction, joint: rail, friction: 0.3, stiction_velocity: 1e-3}}
run: {duration: 1.5 s, points: 3001}
"""


def test_states_are_closed_by_small_moves_alone():
    """Where a block stops, closed states were 16 times as far from the recorded ones as these from the motion."""
    ratios = compared(STOPPING, ("block.x", "rail.displacement"), solver="bdf", rtol=5e-4)
    assert (ratios > 0.3).all() and (ratios < 3.0).all()
