"""Spatial bodies, markers and forces over a run."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..compile.quaternions import rotated
from ..describe.marker import GROUND, MarkerReference
from ..describe.requests.output import Term
from .marker_measures import axis
from .marker_motion import Channels, MarkerMotion, Motions


def body_motion(body: str, channels: Channels) -> MarkerMotion:
    """Return the motion of a body's centre of mass with the body's own axes."""

    def columns(names: str) -> np.ndarray:
        return np.column_stack([channels[f"{body}.{name}"] for name in names.split()])

    orientation = columns("q0 q1 q2 q3")
    return MarkerMotion(
        columns("x y z"), columns("vx vy vz"), columns("ax ay az"), orientation,
        rotated(orientation, columns("wx wy wz")), rotated(orientation, columns("wdx wdy wdz")),
    )  # fmt: skip


def place(model: Any, marker: MarkerReference) -> tuple[np.ndarray, np.ndarray]:
    """Return the position of a marker relative to the centre of mass, and the quaternion of its axes in the body's."""
    placed = model.place(marker)
    point = np.array(placed.point)
    if marker.body != GROUND:
        point = point - model.bodies[marker.body].center_of_mass
    return point, np.array(placed.orientation)


def action(element: str, channels: Channels) -> tuple[np.ndarray, np.ndarray]:
    """Return force and torque of a joint or force on its first body, in ground axes, shape (n, 3)."""
    force, torque = (np.column_stack([channels[f"{element}.{kind}{axis}"] for axis in "xyz"]) for kind in "ft")
    return force, torque


def continuous_angle(term: Term, motions: Motions, counters: Channels) -> np.ndarray:
    """Return the angle of marker i about an axis of marker j, unwrapped by its revolution counter."""
    i, j = (motions.of(marker) for marker in term.markers)
    sine, cosine = _sine_and_cosine(term.function[1], i, j)
    counted = counters[str(term)]
    s, c = np.sin(counted), np.cos(counted)
    return np.asarray(counted + np.arctan2(sine * c - cosine * s, cosine * c + sine * s))


def _sine_and_cosine(about: str, i: MarkerMotion, j: MarkerMotion) -> tuple[np.ndarray, np.ndarray]:
    """Return sine and cosine of an angle as in `stiffmbs.compile.symbolic.spatial_frames.SpatialFrame.angle_about`."""
    if about == "z":
        x = axis(0, i, j)
        return x[:, 1], x[:, 0]
    z = axis(2, i, j)
    return (-z[:, 1] if about == "x" else z[:, 0]), z[:, 2]
