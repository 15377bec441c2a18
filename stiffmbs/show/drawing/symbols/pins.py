"""Components of spatial symbols: pins, balls, rails and plates."""

from __future__ import annotations

import numpy as np

from .. import solids
from ..draft import Draft, Site
from ..scene_graph import Line, Solid

DARK = "#707070"


def shape(d: Draft, site: Site, solid: Solid, color: str = "") -> None:
    d.put(site, "joint", solids.edged(solid), color=color)


def pin(d: Draft, site: Site, radius: float = 0.45, length: float = 2.0) -> None:
    shape(d, site, solids.cylinder(radius * d.u, length * d.u, 16))


def ball(d: Draft, site: Site, radius: float = 0.6) -> None:
    d.put(site, "joint", solids.sphere(radius * d.u))


def rail(d: Draft, i: Site, j: Site) -> None:
    """Line on j along its z, on which i slides; shorter on a moving body."""
    half = 0.25 if j.on_ground else 0.1
    start = float(j.turned[:, 2] @ (i.in_ground - j.in_ground))
    ends = np.array([[0, 0, start - half * d.size], [0, 0, start + half * d.size]])
    d.put(j, "ground" if j.on_ground else "joint", Line(ends, 1.8))


def plate(d: Draft, j: Site, half: float = 3.0) -> None:
    """Plane on which i stays: the x-y plane of j."""
    square = solids.rectangle(2 * half * d.u, 2 * half * d.u)
    diagonals = (Line(square[[k, k + 2]], 0.5) for k in (0, 1))
    d.put(j, "ground" if j.on_ground else "joint", solids.outline(square), *diagonals)
