"""Motion of markers over a run, from the channels of their bodies."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np

from ..compile.quaternions import CONJUGATE, rotated, times
from ..describe.marker import GROUND, MarkerReference
from ..describe.requests.output import Term

Channels = Mapping[str, np.ndarray]
"""Channels by name, shape (n,)."""


@dataclass(frozen=True, eq=False)
class MarkerMotion:
    """Motion of a marker over time in ground axes, one row per instant.

    Attributes
    ----------
    point, velocity, acceleration : ndarray, shape (n, 3)
    orientation : ndarray, shape (n, 4)
        Quaternion of its axes.
    omega, alpha : ndarray, shape (n, 3)
        Angular velocity and acceleration.
    """

    point: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    orientation: np.ndarray
    omega: np.ndarray
    alpha: np.ndarray

    def along(self, vectors: np.ndarray) -> np.ndarray:
        """Transform vectors from ground axes to this marker's axes, shape (n, 3)."""
        return rotated(self.orientation * CONJUGATE, vectors)

    def placed(self, point: np.ndarray, orientation: np.ndarray) -> MarkerMotion:
        """Return the motion of a frame fixed to this marker, with its point and orientation in this marker's axes."""
        arm = rotated(self.orientation, np.broadcast_to(point, self.point.shape))
        turning = np.cross(self.omega, arm)
        return MarkerMotion(
            self.point + arm,
            self.velocity + turning,
            self.acceleration + np.cross(self.alpha, arm) + np.cross(self.omega, turning),
            times(self.orientation, np.broadcast_to(orientation, self.orientation.shape)),
            self.omega,
            self.alpha,
        )


class Motions:
    """Motion of markers, and actions of joints and forces; the plane is the x-y plane of space.

    Attributes
    ----------
    model : ModelData
    channels : mapping of str to ndarray
        Channels of a run of the model.
    count : int
        Number of instants.
    """

    def __init__(self, model: Any, channels: Channels, count: int) -> None:
        self.model, self.channels, self.count = model, channels, count
        self._family = import_module(f".{'planar' if model.dimensions == 2 else 'spatial'}_motion", __package__)
        self._bodies: dict[str, MarkerMotion] = {}

    def of(self, marker: MarkerReference) -> MarkerMotion:
        """Return the motion of a marker."""
        point, orientation = self._family.place(self.model, marker)
        return self.of_body(marker.body).placed(point, orientation)

    def of_body(self, body: str) -> MarkerMotion:
        """Return the motion of a body's centre of mass with the body's own axes; rest for ground."""
        if body not in self._bodies:
            moving = body != GROUND
            self._bodies[body] = self._family.body_motion(body, self.channels) if moving else self._at_rest()
        return self._bodies[body]

    def action(self, element: str) -> tuple[np.ndarray, np.ndarray]:
        """Return force and torque of a joint or force on its first body, in ground axes, shape (n, 3)."""
        force, torque = self._family.action(element, self.channels)
        return force, torque

    def continuous_angle(self, term: Term, counters: Channels) -> np.ndarray:
        """Return an unwrapped angle, shape (n,), from revolution counters if required."""
        angle: np.ndarray = self._family.continuous_angle(term, self, counters)
        return angle

    def _at_rest(self) -> MarkerMotion:
        nothing = np.zeros((self.count, 3))
        return MarkerMotion(nothing, nothing, nothing, np.tile([1.0, 0, 0, 0], (self.count, 1)), nothing, nothing)
