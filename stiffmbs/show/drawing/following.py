"""The body that a film or a page looks at, where a mechanism travels far: all of its path in one picture would show a dot."""

from __future__ import annotations

import numpy as np

from .poses import Poses
from .scene_graph import Drawing

FAR = 3.0
"""Way of the heaviest body, over the mechanism's size, from which on the picture goes with it."""


def followed_body(drawing: Drawing, poses: Poses) -> str:
    """The body that the picture goes with; empty where it stays."""
    if drawing.heaviest not in poses.points:
        return ""
    way = way_of(drawing.heaviest, poses)
    return drawing.heaviest if np.nanmax(np.linalg.norm(way, axis=1)) > FAR * drawing.size else ""


def way_of(body: str, poses: Poses) -> np.ndarray:
    """How far a body is from its first place, shape (n, 3), m."""
    return np.asarray(poses.points[body] - poses.points[body][0])


def seen_from(body: str, poses: Poses) -> Poses:
    """The poses as they are seen by someone who goes with a body without turning."""
    way = way_of(body, poses)
    return Poses(poses.time, {name: p - way for name, p in poses.points.items()}, poses.orientations, poses.forces)
