"""The cart-pendulum of ``examples/cart_pendulum.yaml``, 10 s with 1001 output points."""

from __future__ import annotations

from functools import partial

import numpy as np

from stiffmbs.model.read_scene import read_scene

from ..by_hand import cart_pendulum as hand
from ..contestant import Contestant, auto, bdf, bdf_of_all, by_hand, converged, dop853, minimal
from ..problem import Problem
from ..task import Minimal, Task

SCENE = """
name: Cart-pendulum
gravity: [0, -9.81]
bodies:
  cart: {mass: 10, inertia: 1}
  bar: {mass: 1, inertia: 0.03, position: [0.3*sin(20 deg), -0.3*cos(20 deg)], angle: -70 deg}
joints:
  rail: {type: prismatic, i: cart, j: ground}
  hinge: {type: revolute, i: cart, j: {body: bar, point: [-0.3, 0]}}
forces:
  spring: {type: spring_damper, i: cart, j: {body: ground, point: [-1, 0]}, stiffness: 270, free_length: 1}
run: {duration: 10, points: 1001}
"""
TIMES = np.linspace(0.0, 10.0, 1001)
X_AT_END, THETA_AT_END = 0.005385525470510, 0.298328485255
"""The cart's place and the bar's angle from hanging after 10 s: minimal equations with DOP853 at rtol 1e-13 and the
yardstick at rtol 1e-12 agree to 1e-11."""


def contestants() -> list[Contestant]:
    """This package beside SI2 by hand and two minimal equations."""
    scene = read_scene(SCENE)
    return [
        bdf(scene), bdf_of_all(scene), by_hand(hand.si2(), TIMES), dop853(scene),
        minimal(RATES, hand.minimal_start(), hand.places, TIMES), auto(scene),
    ]  # fmt: skip


def task() -> Task:
    """The problem for other tools."""
    return Task(read_scene(SCENE), TIMES, Minimal(RATES, hand.minimal_start(), hand.places))


RATES = partial(hand.minimal, k=hand.STIFFNESS)
BENCHMARKS = (
    Problem(
        "cart_pendulum", partial(converged, RATES, hand.minimal_start(), hand.places, TIMES), contestants, task=task
    ),
)
