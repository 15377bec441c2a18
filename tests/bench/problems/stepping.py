"""The cart-pendulum under a PD controller, 10 000 steps of 1 ms; it, two arms and a half car with new inputs at each step; the car; a thousand arms."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from stiffmbs import load_scene
from stiffmbs.model.read_scene import read_scene

from ..by_hand import cart_pendulum as hand
from ..stepping.controlled import Stepping
from ..stepping.in_a_batch import InABatch
from ..stepping.in_the_loop import InTheLoop
from .cart_pendulum import SCENE as FREE

SCENE = FREE.replace("gravity:", "parameters: {F: 0 N}\ngravity:").replace(
    "forces:", "forces:\n  push: {type: force, i: cart, force: [F, 0]}"
).replace("points: 1001", "rtol: 1e-8")  # fmt: skip
PLACED, DAMPED = 200.0, 60.0
"""Of the controller, N/m and N s/m."""
SUBSTEPS = 4


def control(x: float, v: float) -> float:
    """Force on the cart that brings it back to the middle."""
    return -PLACED * x - DAMPED * v


def reference(dt: float, steps: int) -> np.ndarray:
    """The cart's place after each step: minimal equations by the classical Runge-Kutta scheme, right to 1e-12."""
    y, places, h = hand.minimal_start(), np.empty(steps), dt / SUBSTEPS
    for k in range(steps):
        push = control(y[0], y[2])
        for _ in range(SUBSTEPS):
            k1 = hand.pushed(0.0, y, hand.STIFFNESS, push)
            k2 = hand.pushed(0.0, y + h / 2 * k1, hand.STIFFNESS, push)
            k3 = hand.pushed(0.0, y + h / 2 * k2, hand.STIFFNESS, push)
            k4 = hand.pushed(0.0, y + h * k3, hand.STIFFNESS, push)
            y = y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        places[k] = y[0]
    return places


SCENES, EXAMPLES = Path(__file__).parents[1] / "scenes", Path(__file__).parents[3] / "examples"
BENCHMARKS = (
    Stepping("stepping", SCENE, "F", control, ("cart.x", "cart.vx"), reference),
    InTheLoop("cart_in_the_loop", lambda: read_scene(SCENE), ("F",), 10.0),
    InTheLoop("arm_in_the_loop", lambda: SCENES / "arm.xml", tuple(f"m{k}_input" for k in range(1, 6)), 0.1),
    InTheLoop(
        "seven_joints_in_the_loop", lambda: SCENES / "seven_joints.xml", tuple(f"m{k}_input" for k in range(1, 8)), 0.1
    ),
    InTheLoop(
        "half_car_in_the_loop",
        lambda: load_scene(EXAMPLES / "half_car.yaml"),
        ("V",),
        16.0,
        least=14.0,
        steps=1000,
        rounds=3,
        schemes=("bdf", "radau"),
    ),
    InTheLoop(
        "car_in_the_loop",
        lambda: load_scene(EXAMPLES / "car.yaml", [("choose.manoeuvre", "step_steer")]),
        (),
        0.0,
        steps=200,
        schemes=("linearly_implicit_euler", "extrapolated_euler", "bdf", "radau"),
    ),
    InABatch("arms_in_a_batch", SCENES / "arm.xml", tuple(f"m{k}_input" for k in range(1, 6)), 0.1),
    InABatch("seven_joints_in_a_batch", SCENES / "seven_joints.xml", tuple(f"m{k}_input" for k in range(1, 8)), 0.1),
)
