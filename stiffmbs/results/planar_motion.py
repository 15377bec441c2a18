"""Planar bodies, markers and forces in the x-y plane of space, over a run."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..describe.marker import GROUND, MarkerReference
from ..describe.requests.output import Term
from .marker_motion import Channels, MarkerMotion, Motions


def body_motion(body: str, channels: Channels) -> MarkerMotion:
    """Return the motion of a body's centre of mass with the body's own axes."""
    x, y, angle, vx, vy, omega, ax, ay, alpha = (
        channels[f"{body}.{name}"] for name in ["x", "y", "angle", "vx", "vy", "omega", "ax", "ay", "alpha"]
    )
    zero = np.zeros_like(x)
    return MarkerMotion(
        np.column_stack([x, y, zero]), np.column_stack([vx, vy, zero]), np.column_stack([ax, ay, zero]),
        np.column_stack([np.cos(angle / 2), zero, zero, np.sin(angle / 2)]),
        np.column_stack([zero, zero, omega]), np.column_stack([zero, zero, alpha]),
    )  # fmt: skip


def place(model: Any, marker: MarkerReference) -> tuple[np.ndarray, np.ndarray]:
    """Return the position of a marker relative to the centre of mass, and the quaternion of its axes in the body's."""
    placed = model.place(marker)
    half = placed.angle / 2
    return np.array([*placed.point, 0.0]), np.array([math.cos(half), 0.0, 0.0, math.sin(half)])


def action(element: str, channels: Channels) -> tuple[np.ndarray, np.ndarray]:
    """Return force and torque of a joint or force on its first body, in ground axes, shape (n, 3)."""
    fx, fy, torque = (channels[f"{element}.{name}"] for name in ("fx", "fy", "torque"))
    zero = np.zeros_like(fx)
    return np.column_stack([fx, fy, zero]), np.column_stack([zero, zero, torque])


def continuous_angle(term: Term, motions: Motions, counters: Channels) -> np.ndarray:
    """Return the angle of marker i relative to marker j; angles of planar bodies are unwrapped."""
    i, j = (_angle(marker, motions) for marker in term.markers)
    return np.broadcast_to(i - j, motions.count)


def _angle(marker: MarkerReference, motions: Motions) -> Any:
    placed = motions.model.place(marker).angle
    return placed if marker.body == GROUND else motions.channels[f"{marker.body}.angle"] + placed
