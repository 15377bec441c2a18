"""Views of a mechanism: parallel projections onto a plane."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ...errors import InputError

ISOMETRIC = math.degrees(math.asin(math.tan(math.radians(30))))


@dataclass(frozen=True, eq=False)
class View:
    """Parallel projection. `axes` of shape (3, 3): rows: to the right, up, and towards the viewer."""

    axes: np.ndarray

    def seen(self, points: np.ndarray) -> np.ndarray:
        """Return points to the right, up and towards the viewer, shape (n, 3)."""
        return points @ self.axes.T


def from_angles(azimuth: float, elevation: float, up: str = "z") -> View:
    """Return the view from a direction.

    `azimuth`: angle of the viewer about the upright axis, deg. `elevation`: angle above the horizontal, deg. `up`:
    upright axis.
    """
    a, e = math.radians(azimuth), math.radians(elevation)
    right = np.array([-math.sin(a), math.cos(a), 0.0])
    towards = np.array([math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e)])
    rows = np.array([right, np.cross(towards, right), towards])
    return View(rows if up == "z" else rows[:, [1, 2, 0]])  # cyclic: z, x, y replace x, y, z


NAMED = {
    "front": (np.array([1.0, 0, 0]), np.array([0, 0, 1.0])),
    "back": (np.array([-1.0, 0, 0]), np.array([0, 0, 1.0])),
    "side": (np.array([0, 1.0, 0]), np.array([0, 0, 1.0])),
    "top": (np.array([1.0, 0, 0]), np.array([0, 1.0, 0])),
    "xy": (np.array([1.0, 0, 0]), np.array([0, 1.0, 0])),
    "xz": (np.array([1.0, 0, 0]), np.array([0, 0, 1.0])),
    "yz": (np.array([0, 1.0, 0]), np.array([0, 0, 1.0])),
}
"""Directions to the right and up."""


def view_named(text: str, dimensions: int, gravity: np.ndarray) -> View:
    """Return the view that a text names.

    `text`: ``front``, ``back``, ``side``, ``top``, ``isometric``, a plane such as ``xz``, ``AZIMUTH,ELEVATION`` in
    degrees, or empty: along z in the plane, isometric in space. `gravity` of shape (3,): if it is along y, y is the
    upright axis of views by angles.
    """
    if text in NAMED or (not text and dimensions == 2):
        right, up = NAMED[text or "xy"]
        return View(np.array([right, up, np.cross(right, up)]))
    upright = "y" if abs(gravity[1]) > abs(gravity[2]) else "z"
    if text in ("", "isometric"):
        return from_angles(-45.0 if upright == "z" else 45.0, ISOMETRIC, upright)
    try:
        azimuth, elevation = (float(part) for part in text.split(","))
    except ValueError:
        raise InputError(
            f"--view: found '{text}', expected isometric, {', '.join(NAMED)}, or AZIMUTH,ELEVATION in degrees"
        ) from None
    if not (math.isfinite(azimuth) and math.isfinite(elevation)):
        raise InputError(f"--view: found '{text}', expected finite angles in degrees")
    return from_angles(azimuth, elevation, upright)


def check_view(text: str) -> None:
    """Check that a text names a view, before anything is solved."""
    view_named(text, 3, np.zeros(3))
