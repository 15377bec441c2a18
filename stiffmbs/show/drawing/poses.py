"""Poses of bodies, and acting forces, over time: as described, or of a run."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ...errors import InputError
from ...model.model_data import ModelData
from ...reading.marker import GROUND, MarkerReference
from ...results.marker_motion import place
from .scene_graph import Anchor, Drawing, Solid
from .solids import rotation

Channels = Mapping[str, np.ndarray]
FAR = 2.0
"""Displacement of the heaviest body, relative to the mechanism's size, above which the view follows it."""


@dataclass(frozen=True, eq=False)
class Poses:
    """Poses of all bodies at some instants."""

    time: np.ndarray  # shape (n,): times, s
    points: Mapping[str, np.ndarray]  # shape (n, 3): centres of mass in ground axes, m
    orientations: Mapping[str, np.ndarray]  # shape (n, 4): quaternions of the bodies' own axes
    # shape (n, 3): forces of joints and force elements on their first bodies, in ground axes, N
    forces: Mapping[str, np.ndarray] = field(default_factory=dict)

    def pose(self, body: str, k: int) -> tuple[np.ndarray, np.ndarray]:
        """Return a body's centre of mass and the matrix of its axes at the k-th instant; for ground, the origin."""
        if body == GROUND:
            return np.zeros(3), np.eye(3)
        return self.points[body][k], rotation(self.orientations[body][k])

    def vertices(self, solid: Solid, k: int) -> np.ndarray:
        """Return the vertices of a solid at the k-th instant, deformed by its modes, shape (n, 3)."""
        return np.asarray(
            sum((np.tensordot(self.points[body][k], shapes, 1) for body, shapes in solid.modes.items()), solid.vertices)
        )

    def stresses(self, solid: Solid, rows: np.ndarray) -> np.ndarray:
        """Return the von Mises stress at the vertices of a solid at some instants, shape (rows, n)."""
        parts = (np.tensordot(self.points[body][rows], of, 1) for body, of in solid.stresses.items())
        return np.linalg.norm(sum(parts), axis=-1)

    def at(self, rows: np.ndarray) -> Poses:
        """Return the poses at some of the instants."""
        pick = [
            {name: values[rows] for name, values in part.items()}
            for part in (self.points, self.orientations, self.forces)
        ]
        return Poses(self.time[rows], *pick)

    def resampled(self, time: np.ndarray) -> Poses:
        """Interpolate the poses at other instants: points and forces linearly, orientations by the shorter rotation."""
        known = np.isfinite(np.column_stack([self.time, *self.points.values()])).all(axis=1)
        rows = self.at(np.flatnonzero(known)) if not known.all() else self
        after = np.clip(np.searchsorted(rows.time, time, side="right"), 1, max(len(rows.time) - 1, 1))
        before = after - 1
        after = np.minimum(after, len(rows.time) - 1)
        span = rows.time[after] - rows.time[before]
        part = np.clip(np.where(span > 0, (time - rows.time[before]) / np.where(span > 0, span, 1.0), 0.0), 0.0, 1.0)[
            :, None
        ]

        def between(values: np.ndarray) -> np.ndarray:
            return np.asarray(values[before] + part * (values[after] - values[before]))

        def turned(p: np.ndarray) -> np.ndarray:
            sign = np.where(np.sum(p[before] * p[after], axis=1) < 0, -1.0, 1.0)[:, None]
            found = p[before] + part * (sign * p[after] - p[before])
            return np.asarray(found / np.linalg.norm(found, axis=1, keepdims=True))

        return Poses(
            time,
            {name: between(values) for name, values in rows.points.items()},
            {name: turned(values) for name, values in rows.orientations.items()},
            {name: between(values) for name, values in rows.forces.items()},
        )

    def path(self, anchor: Anchor) -> np.ndarray:
        """Return the path of a point of a body, in ground axes, shape (n, 3)."""
        if anchor.body == GROUND:
            return np.tile(anchor.point, (len(self.time), 1))
        turned = rotation(self.orientations[anchor.body]) @ anchor.point
        return np.asarray(self.points[anchor.body] + turned)


def placed(data: ModelData, marker: MarkerReference) -> tuple[np.ndarray, np.ndarray]:
    """Return the position of a marker relative to the centre of mass, and its axes in the body's, shape (3, 3)."""
    point, orientation = place(data, marker)
    return point, rotation(orientation)


def described_poses(data: ModelData) -> Poses:
    """Return the poses of the described bodies, before assembly."""
    points, orientations = {}, {}
    for name, body in data.bodies.items():
        if data.dimensions == 2:
            points[name] = np.array([[*body.position, 0.0]])
            orientations[name] = np.array([[math.cos(body.angle / 2), 0, 0, math.sin(body.angle / 2)]])
        else:
            orientations[name] = np.array([body.orientation])
            points[name] = np.array([body.position]) + rotation(body.orientation) @ np.array(body.center_of_mass)
    return Poses(np.zeros(1), points, orientations)


def poses_of(data: ModelData, time: np.ndarray, channels: Channels) -> Poses:
    """Return the poses of a run, and the forces of all elements that report one.

    `time` of shape (n,). `channels` of shape (n,). Raises InputError if the run belongs to another model.
    """
    points, orientations = {}, {}
    for name in data.bodies:
        points[name] = columns(channels, len(time), name, ("x", "y", "z")[: data.dimensions])
        orientations[name] = _orientations(channels, name, data.dimensions)
    axes = ("fx", "fy", "fz")[: data.dimensions]
    forces = {
        name: columns(channels, len(time), name, axes)
        for name in (*data.joints, *data.forces) if all(f"{name}.{axis}" in channels for axis in axes)
    }  # fmt: skip
    return Poses(np.asarray(time), points, orientations, forces)


def columns(channels: Channels, count: int, name: str, axes: Iterable[str]) -> np.ndarray:
    """Return channels of one owner as columns, with zeros for the third in the plane, shape (n, 3)."""
    found = np.zeros((count, 3))
    for k, axis in enumerate(axes):
        found[:, k] = _channel(channels, f"{name}.{axis}")
    return found


def _orientations(channels: Channels, name: str, dimensions: int) -> np.ndarray:
    if dimensions == 3:
        return np.column_stack([_channel(channels, f"{name}.q{k}") for k in range(4)])
    half = _channel(channels, f"{name}.angle") / 2
    zero = np.zeros_like(half)
    return np.column_stack([np.cos(half), zero, zero, np.sin(half)])


def _channel(channels: Channels, channel: str) -> Any:
    if channel not in channels:
        raise InputError(f"found results without the channel '{channel}', expected those of a run of this scene")
    return channels[channel]


def followed_body(drawing: Drawing, poses: Poses) -> str:
    """Return the body that the view follows, or an empty string."""
    if drawing.heaviest not in poses.points:
        return ""
    travelled = path_of(drawing.heaviest, poses)
    return drawing.heaviest if np.nanmax(np.linalg.norm(travelled, axis=1)) > FAR * drawing.size else ""


def path_of(body: str, poses: Poses) -> np.ndarray:
    """Return the displacement of a body from its first position, shape (n, 3), m."""
    return np.asarray(poses.points[body] - poses.points[body][0])


def seen_from(body: str, drawing: Drawing, poses: Poses) -> Poses:
    """Return the poses relative to a body's displacement, without its rotation."""
    travelled = path_of(body, poses)
    modal = {name for part in drawing.parts for solid in part.solids for name in solid.modes}
    points = {name: p if name in modal else p - travelled for name, p in poses.points.items()}
    return Poses(poses.time, points, poses.orientations, poses.forces)
