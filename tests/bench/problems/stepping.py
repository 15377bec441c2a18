"""The cart-pendulum under a PD controller, 10 000 steps of 1 ms."""

from __future__ import annotations

import numpy as np

from ..by_hand import cart_pendulum as hand
from ..stepping import Stepping
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


BENCHMARKS = (Stepping("stepping", SCENE, "F", control, ("cart.x", "cart.vx"), reference),)
