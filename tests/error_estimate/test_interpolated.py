"""Tangent spaces that are interpolated between those of a few nodes."""

import numpy as np

from stiffmbs.analyses.job import prepare
from stiffmbs.error_estimate.evaluated import evaluated
from stiffmbs.error_estimate.interpolated import linearised_along
from stiffmbs.error_estimate.linearised import linearised
from stiffmbs.error_estimate.parameters import ESTIMATE
from stiffmbs.model.read_scene import read_scene

PENDULUM = """
gravity: [0, -9.81]
bodies: {bob: {mass: 1, inertia: 0.1, position: [1, 0]}}
joints: {pin: {type: revolute, i: {body: bob, point: [-1, 0]}, j: ground}}
"""


def pendulum(angle):
    """Return the dynamics of a pendulum, and its states at some angles, at a rate of 1 rad/s."""
    dynamics, one = prepare(read_scene(PENDULUM)).dynamics, np.ones_like(angle)
    q = np.stack([np.cos(angle), np.sin(angle), angle], axis=1)
    u = np.stack([-np.sin(angle), np.cos(angle), one], axis=1)
    return dynamics, evaluated(dynamics, angle, q, u)


def rates_of(space):
    """Return the rates of changes of states, which do not depend on the coordinates of tangent spaces."""
    return space.rates @ np.linalg.solve(space.left @ space.basis, space.left)


def test_a_smooth_motion_is_interpolated():
    dynamics, at = pendulum(np.linspace(0.0, 4.0, 201))
    found, exact = linearised_along(dynamics, at, np.zeros(1, dtype=int), 0.1), linearised(dynamics, at, 0.1)
    assert found.computed.mean() < 0.5
    off = np.linalg.norm(rates_of(found.space) - rates_of(exact), axis=(1, 2))
    assert off.max() < 2 * ESTIMATE.interpolated * np.linalg.norm(rates_of(exact), axis=(1, 2)).max()


def test_nothing_is_interpolated_across_the_start_of_a_piece():
    """The pose jumps by a right angle between two nodes."""
    angle = np.append(np.linspace(0.0, 1.0, 40), 2.5 + np.linspace(0.0, 1.0, 40))
    dynamics, at = pendulum(angle)
    found, exact = linearised_along(dynamics, at, np.array([0, 40]), 0.1), linearised(dynamics, at, 0.1)
    assert np.abs(rates_of(found.space) - rates_of(exact)).max() < 0.1
    assert found.computed[[0, 39, 40, 79]].all()
