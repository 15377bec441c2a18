"""Motion of markers over a run, from the channels of their bodies."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..compile.quaternions import CONJUGATE, rotated, times
from ..elements.requests.output import Term
from ..reading.marker import GROUND, MarkerReference

if TYPE_CHECKING:
    from ..model.model_data import ModelData

Channels = Mapping[str, np.ndarray]
"""Channels by name, shape (n,)."""


@dataclass(frozen=True, eq=False)
class MarkerMotion:
    """Motion of a marker over time in ground axes, one row per instant.

    `point`, `velocity`, `acceleration` of shape (n, 3). `orientation` of shape (n, 4): quaternion of its axes. `omega`,
    `alpha` of shape (n, 3): angular velocity and acceleration.
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

    def axis(self, k: int, other: MarkerMotion) -> np.ndarray:
        """Return the k-th axis of this marker in the axes of another, shape (n, 3)."""
        return rotated(self.relative(other), np.eye(3)[k])

    def relative(self, other: MarkerMotion) -> np.ndarray:
        """Return the quaternion of this marker's axes in those of another, shape (n, 4)."""
        return times(other.orientation * CONJUGATE, self.orientation)

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


def place(model: ModelData, marker: MarkerReference) -> tuple[np.ndarray, np.ndarray]:
    """Return the position of a marker relative to the centre of mass, and the quaternion of its axes in the body's."""
    placed = model.place(marker)
    if model.dimensions == 2:
        half = placed.angle / 2
        return np.array([*placed.point, 0.0]), np.array([math.cos(half), 0.0, 0.0, math.sin(half)])
    point = np.array(placed.point)
    if marker.body != GROUND:
        point = point - model.bodies[marker.body].center_of_mass
    return point, np.array(placed.orientation)


class Motions:
    """Motion of markers, and actions of joints and forces; the plane is the x-y plane of space.

    `channels`: channels of a run of the model. `count`: number of instants.
    """

    def __init__(self, model: ModelData, channels: Channels, count: int) -> None:
        self._model, self._channels, self._zero = model, channels, np.zeros(count)
        self._planar = model.dimensions == 2
        self._bodies: dict[str, MarkerMotion] = {}

    def of(self, marker: MarkerReference) -> MarkerMotion:
        """Return the motion of a marker."""
        if marker.body not in self._bodies:
            self._bodies[marker.body] = self._of_body(marker.body)
        return self._bodies[marker.body].placed(*place(self._model, marker))

    def _of_body(self, body: str) -> MarkerMotion:
        """Return the motion of a body's centre of mass with the body's own axes; rest for ground."""
        if body == GROUND:
            rest = self._columns(body, "0 0 0")
            return MarkerMotion(rest, rest, rest, np.tile([1.0, 0, 0, 0], (len(rest), 1)), rest, rest)
        if self._planar:
            half = self._channels[f"{body}.angle"] / 2
            orientation = np.column_stack([np.cos(half), self._zero, self._zero, np.sin(half)])
            names = ("x y 0", "vx vy 0", "ax ay 0", "0 0 omega", "0 0 alpha")
            point, velocity, acceleration, *turning = (self._columns(body, labels) for labels in names)
        else:
            orientation = self._columns(body, "q0 q1 q2 q3")
            point, velocity, acceleration = (
                self._columns(body, labels) for labels in ("x y z", "vx vy vz", "ax ay az")
            )
            turning = [rotated(orientation, self._columns(body, labels)) for labels in ("wx wy wz", "wdx wdy wdz")]
        return MarkerMotion(point, velocity, acceleration, orientation, *turning)

    def _columns(self, owner: str, labels: str) -> np.ndarray:
        """Return channels of a body or element as columns; the label 0 stands for zeros."""
        return np.column_stack(
            [self._zero if label == "0" else self._channels[f"{owner}.{label}"] for label in labels.split()]
        )

    def action(self, element: str) -> tuple[np.ndarray, np.ndarray]:
        """Return force and torque of a joint or force on its first body, in ground axes, shape (n, 3)."""
        force, torque = ("fx fy 0", "0 0 torque") if self._planar else ("fx fy fz", "tx ty tz")
        return self._columns(element, force), self._columns(element, torque)

    def continuous_angle(self, term: Term, counters: Channels) -> np.ndarray:
        """Return an unwrapped angle, shape (n,): of planar bodies, or in space by its revolution counter."""
        if self._planar:
            i, j = (self._planar_angle(marker) for marker in term.markers)
            return np.broadcast_to(i - j, self._zero.shape)
        sine, cosine = _sine_and_cosine(term.function[1], *map(self.of, term.markers))
        counted = counters[str(term)]
        s, c = np.sin(counted), np.cos(counted)
        return np.asarray(counted + np.arctan2(sine * c - cosine * s, cosine * c + sine * s))

    def _planar_angle(self, marker: MarkerReference) -> Any:
        placed = self._model.place(marker).angle
        return placed if marker.body == GROUND else self._channels[f"{marker.body}.angle"] + placed


def _sine_and_cosine(about: str, i: MarkerMotion, j: MarkerMotion) -> tuple[np.ndarray, np.ndarray]:
    """Return sine and cosine of an angle as in `stiffmbs.compile.symbolic.spatial_frames.SpatialFrame.angle_about`."""
    if about == "z":
        x = i.axis(0, j)
        return x[:, 1], x[:, 0]
    z = i.axis(2, j)
    return (-z[:, 1] if about == "x" else z[:, 0]), z[:, 2]
