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


def rail(d: Draft, half: float = 0.25) -> None:
    """Line on j along its z, on which i slides."""
    assert d.i is not None and d.j is not None
    start = float(d.j.turned[:, 2] @ (d.i.in_ground - d.j.in_ground))
    ends = np.array([[0, 0, start - half * d.size], [0, 0, start + half * d.size]])
    d.put(d.j, "ground" if d.j.on_ground else "joint", Line(ends, 1.8))


def plate(d: Draft, half: float = 3.0) -> None:
    """Plane on which i stays: the x-y plane of j."""
    assert d.j is not None
    square = solids.rectangle(2 * half * d.u, 2 * half * d.u)
    d.put(
        d.j,
        "ground" if d.j.on_ground else "joint",
        solids.outline(square),
        Line(square[[0, 2]], 0.5),
        Line(square[[1, 3]], 0.5),
    )
