"""Steering axis of a wheel as the instant screw axis of its carrier."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .tangent import Twist

STILL = 1e-9
"""Angular velocity per unit of steering below which a wheel does not steer, rad/m or rad/rad."""
LEVEL = 1e-6
"""Smallest upward component of a direction that intersects the road."""


@dataclass(frozen=True)
class SteeringAxis:
    """Axis of a motion.

    `direction` of shape (3,): unit vector, upwards. `arm` of shape (3,): vector from the centre of the wheel to the
    nearest point of the axis, m.
    """

    direction: np.ndarray
    arm: np.ndarray


def steering_axis(locked: Twist | None, held: Twist, bump: Twist) -> SteeringAxis | None:
    """Return the steering axis of a wheel, or None if it does not steer about an axis.

    `locked`: motion of the carrier, at the centre of the wheel, by steering with the springs locked. Without it the
    axis is that of the pure rotation nearest to `held` among the sums of `held` and a multiple of `bump`. `held`:
    motion by steering with the heights of the contacts held. `bump`: motion by lifting.
    """
    twist = locked or _rotation(held, bump)
    square = float(twist.omega @ twist.omega)
    if np.sqrt(square) < STILL:
        return None
    direction = twist.omega / np.sqrt(square)
    if abs(direction[2]) < LEVEL:
        return None
    return SteeringAxis(direction * np.sign(direction[2]), np.cross(twist.omega, twist.v) / square)


def _rotation(held: Twist, bump: Twist) -> Twist:
    """Return the sum of steering and a multiple of lifting whose screw has the smallest pitch."""
    a, c = float(bump.omega @ bump.v), float(held.omega @ held.v)
    b = float(bump.omega @ held.v + held.omega @ bump.v)
    roots = np.roots([a, b, c]) if abs(a) * 1e12 > abs(b) else np.array([-c / b if b else 0.0])
    real = roots[np.abs(roots.imag) <= 1e-9 * (1 + np.abs(roots.real))].real
    multiple = min(real, key=abs) if len(real) else -b / (2 * a)
    return held + bump * float(multiple)
