"""Contact of a wheel that rolls on its pad: it does not follow the rotation of the carrier about the wheel's axis."""

from __future__ import annotations

import numpy as np

UP = np.array([0.0, 0.0, 1.0])


def wheel_axes(axis: np.ndarray) -> np.ndarray:
    """Return the axes of a wheel as rows: horizontal and forward, along its axis to the left, and upwards between them."""
    forward = np.cross(axis, UP)
    forward /= np.linalg.norm(forward)
    return np.array([forward, axis, np.cross(forward, axis)])


def contact_from(centre: np.ndarray, axis: np.ndarray, contact: np.ndarray) -> tuple[float, float, float]:
    """Return the position of the contact from the centre along the axis, forward and upwards in the wheel's plane, m."""
    forward, along, upward = wheel_axes(axis) @ (contact - centre)
    return float(along), float(forward), float(upward)


def contact_at(centre: np.ndarray, axis: np.ndarray, place: tuple[float, float, float]) -> np.ndarray:
    """Return the contact in ground axes, m, from its position as `contact_from` returns it."""
    along, forward, upward = place
    found: np.ndarray = centre + np.array([forward, along, upward]) @ wheel_axes(axis)
    return found


def contact_velocity(axis: np.ndarray, arm: np.ndarray, v: np.ndarray, omega: np.ndarray) -> np.ndarray:
    """Return the velocity of the contact with an arm from the centre, for a motion of the carrier.

    The wheel's axes rotate with omega - s axis, where s keeps `forward` horizontal. `axis`, `arm` of shape (3,): axis
    of the wheel, and contact from its centre, m. `v`, `omega` of shape (3,): velocity of the centre and angular
    velocity of the carrier.
    """
    forward, _, upward = wheel_axes(axis)
    spin = -np.cross(omega, forward)[2] / upward[2]
    found: np.ndarray = v + np.cross(omega - spin * axis, arm)
    return found
