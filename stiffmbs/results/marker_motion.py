"""How markers in space move over a run, from the channels of their bodies."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..compile.quaternions import CONJUGATE, rotated, times
from ..describe.marker import GROUND, MarkerReference


@dataclass(frozen=True, eq=False)
class MarkerMotion:
    """A marker over time, all in ground axes, one instant a row.

    Attributes
    ----------
    point, velocity, acceleration : ndarray, shape (n, 3)
    orientation : ndarray, shape (n, 4)
        The quaternion of its axes.
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
        """Vectors in ground axes in this marker's, shape (n, 3)."""
        return rotated(self.orientation * CONJUGATE, vectors)

    def placed(self, point: np.ndarray, orientation: np.ndarray) -> MarkerMotion:
        """What is fixed to this marker at a point, and with an orientation, in its axes."""
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
    """Finds the motion of markers.

    Parameters
    ----------
    model : SpatialData
    channels : mapping of str to ndarray
        Of a run of it.
    count : int
        Instants.
    """

    def __init__(self, model: Any, channels: Mapping[str, np.ndarray], count: int) -> None:
        self._model, self._channels, self._count = model, channels, count
        self._bodies: dict[str, MarkerMotion] = {}

    def of(self, marker: MarkerReference) -> MarkerMotion:
        """The motion of a marker."""
        body, placed = marker.body, self._model.place(marker)
        from_center = np.array(placed.point)
        if body != GROUND:
            from_center = from_center - self._model.bodies[body].center_of_mass
        return self.of_body(body).placed(from_center, np.array(placed.orientation))

    def of_body(self, body: str) -> MarkerMotion:
        """The motion of a body's centre of mass with the body's own axes; of ground, rest."""
        if body not in self._bodies:
            self._bodies[body] = self._at_rest() if body == GROUND else self._moving(body)
        return self._bodies[body]

    def _at_rest(self) -> MarkerMotion:
        nothing = np.zeros((self._count, 3))
        return MarkerMotion(nothing, nothing, nothing, np.tile([1.0, 0, 0, 0], (self._count, 1)), nothing, nothing)

    def _moving(self, body: str) -> MarkerMotion:
        def columns(names: str) -> np.ndarray:
            return np.column_stack([self._channels[f"{body}.{name}"] for name in names.split()])

        orientation = columns("q0 q1 q2 q3")
        return MarkerMotion(
            columns("x y z"), columns("vx vy vz"), columns("ax ay az"), orientation,
            rotated(orientation, columns("wx wy wz")), rotated(orientation, columns("wdx wdy wdz")),
        )  # fmt: skip
