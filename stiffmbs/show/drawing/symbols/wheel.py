"""Wheels of tyres: a tread, a rim, and spokes that show the rotation."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from .. import solids
from ..draft import Draft, Site, at_first
from ..frames import axes_along
from ..scene_graph import Solid

TREAD, RIM = "#4a4a4a", "#c9cdd2"
WIDTH = 0.62
"""Width of a tyre whose data have none, in radii."""
RIM_RADIUS, SPOKES = 0.66, 5
PROFILE = np.array([[0.66, -0.5], [0.95, -0.5], [1.0, -0.3], [1.0, 0.3], [0.95, 0.5], [0.66, 0.5]])
"""Cross section of a tyre: radius in radii, and place in widths."""


def radius_of(tyre: Any) -> float:
    """Return the unloaded radius of a tyre, m; zero if its data do not tell."""
    properties = getattr(tyre, "properties", None)
    found = getattr(tyre, "radius", None) or _coefficient(properties, "UNLOADED_RADIUS")
    return float(found or 0.0)


def _coefficient(properties: Any, name: str) -> float | None:
    found = getattr(properties, "coefficients", properties)
    value = found.get(name) if hasattr(found, "get") else getattr(found, name, None)
    return float(value) if isinstance(value, float | int) else None


@at_first
def wheel(d: Draft, i: Site) -> None:
    """A tyre on a rim with spokes, about the y axis of the marker."""
    radius = radius_of(d.element)
    if not radius:
        return
    width = _coefficient(getattr(d.element, "properties", None), "WIDTH") or WIDTH * radius
    axes = axes_along(np.array([0.0, 1.0, 0.0]))
    site = i.with_axes(axes)
    d.put(site, "body", lathe(PROFILE * (radius, width), 32), color=TREAD)
    hub = solids.cylinder(0.16 * radius, 0.6 * width, 16)
    turns = 2 * math.pi / SPOKES * np.arange(SPOKES)
    spokes = [_turned(_spoke(radius, width), angle) for angle in turns]
    d.put(site, "body", solids.edged(hub), *spokes, color=RIM)


def _spoke(radius: float, width: float) -> Solid:
    length = (RIM_RADIUS - 0.1) * radius
    bar = solids.box((length, 0.14 * radius, 0.3 * width))
    return solids.moved(bar, np.array([0.1 * radius + length / 2, 0.0, 0.0]), np.eye(3))


def _turned(solid: Solid, angle: float) -> Solid:
    c, s = math.cos(angle), math.sin(angle)
    return solids.moved(solid, np.zeros(3), np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]]))


def lathe(profile: np.ndarray, corners: int) -> Solid:
    """Return the ring that a closed cross section (radius, height) sweeps about z; counterclockwise in (height, radius)."""
    angles = 2 * math.pi / corners * np.arange(corners)
    rings = [np.column_stack([r * np.cos(angles), r * np.sin(angles), np.full(corners, z)]) for r, z in profile]
    n = len(profile)
    faces = tuple(
        np.array([p * corners + k, p * corners + (k + 1) % corners, q * corners + (k + 1) % corners, q * corners + k])
        for p in range(n) for q in [(p + 1) % n] for k in range(corners)
    )  # fmt: skip
    return Solid(np.vstack(rings), faces)
