"""Selection of a body for a film or page to follow, if a mechanism travels too far for a fixed view."""

from __future__ import annotations

import numpy as np

from .poses import Poses
from .scene_graph import Drawing

FAR = 3.0
"""Displacement of the heaviest body, relative to the mechanism's size, above which the view follows it."""


def followed_body(drawing: Drawing, poses: Poses) -> str:
    """Return the body that the view follows, or an empty string."""
    if drawing.heaviest not in poses.points:
        return ""
    way = way_of(drawing.heaviest, poses)
    return drawing.heaviest if np.nanmax(np.linalg.norm(way, axis=1)) > FAR * drawing.size else ""


def way_of(body: str, poses: Poses) -> np.ndarray:
    """Return the displacement of a body from its first position, shape (n, 3), m."""
    return np.asarray(poses.points[body] - poses.points[body][0])


def seen_from(body: str, poses: Poses) -> Poses:
    """Return the poses relative to a body's displacement, without its rotation."""
    way = way_of(body, poses)
    return Poses(poses.time, {name: p - way for name, p in poses.points.items()}, poses.orientations, poses.forces)
