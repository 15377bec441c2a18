"""Symbols of spatial force elements."""

from __future__ import annotations

import numpy as np

from .. import solids
from ..draft import Draft, Site, at_both
from ..frames import axes_along
from ..scene_graph import Line
from . import profiles
from .pins import DARK, ball, pin, plate, shape
from .shared import ground, is_damped


@at_both
def spring_damper(d: Draft, i: Site, j: Site) -> None:
    """A coil, and a dashpot in it."""
    ground(d)
    d.stretch(i, j, "force", profiles.coil(0.7 * d.u), width=1.2)
    if is_damped(d):
        d.stretch(i, j, "force", *profiles.damper(0.35 * d.u), width=1.1)


@at_both
def bushing(d: Draft, i: Site, j: Site) -> None:
    """A sleeve of rubber about a pin."""
    ground(d)
    rubber = solids.cylinder(0.8 * d.u, 1.1 * d.u, 18)
    d.put(j, "rubber", solids.edged(rubber))
    pin(d, i, 0.35, 1.8)


@at_both
def beam(d: Draft, i: Site, j: Site) -> None:
    """A thick elastic line."""
    d.stretch(j, i, "force", profiles.straight(), width=3.0)


@at_both
def elastic(d: Draft, i: Site, j: Site) -> None:
    """A dashed line between the markers, with springs in all directions."""
    d.stretch(j, i, "force", profiles.straight(), width=1.5, dashed=True)
    shape(d, j, solids.cylinder(0.6 * d.u, 0.8 * d.u, 16), DARK)


@at_both
def contact(d: Draft, i: Site, j: Site) -> None:
    """Ball about i, and the plane or ball that it touches."""
    e = d.element
    if e.radius:
        d.put(i, "body", solids.sphere(e.radius, 20), color=d.colors.get(i.body, ""))
    else:
        ball(d, i, 0.3)
    if e.surface == "plane":
        plate(d, j, 0.25 * d.size / d.u)
    elif e.surface_radius:
        rings = (axes_along(np.eye(3)[k]) for k in range(3))
        ring = solids.circle(e.surface_radius, corners=48)
        d.put(j, "ground" if j.on_ground else "joint", *(Line(ring @ axes.T, 1.0) for axes in rings))
