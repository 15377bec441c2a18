"""Symbols of spatial force elements."""

from __future__ import annotations

import numpy as np

from .. import solids
from ..draft import Draft
from ..frames import axes_along
from ..scene_graph import Line
from . import profiles
from .pins import DARK, ball, pin, plate, shape
from .shared import ground


def spring_damper(d: Draft) -> None:
    """A coil, and a dashpot in it."""
    if d.i is None or d.j is None:
        return
    ground(d)
    d.stretch(d.i, d.j, "force", profiles.coil(0.7 * d.u), width=1.2)
    if getattr(d.element, "damping", 0) or getattr(d.element, "damper_law", None) is not None:
        d.stretch(d.i, d.j, "force", *profiles.damper(0.35 * d.u), width=1.1)


def bushing(d: Draft) -> None:
    """A sleeve of rubber about a pin."""
    if d.i is None or d.j is None:
        return
    ground(d)
    rubber = solids.cylinder(0.8 * d.u, 1.1 * d.u, 18)
    d.put(d.j, "rubber", solids.edged(rubber))
    pin(d, d.i, 0.35, 1.8)


def beam(d: Draft) -> None:
    """A thick elastic line."""
    if d.i is not None and d.j is not None:
        d.stretch(d.j, d.i, "force", profiles.STRAIGHT, width=3.0)


def elastic(d: Draft) -> None:
    """A dashed line between the markers, with springs in all directions."""
    if d.i is not None and d.j is not None:
        d.stretch(d.j, d.i, "force", profiles.STRAIGHT, width=1.5, dashed=True)
        shape(d, d.j, solids.cylinder(0.6 * d.u, 0.8 * d.u, 16), DARK)


def contact(d: Draft) -> None:
    """Ball about i, and the plane or ball that it touches."""
    e = d.element
    if d.i is None or d.j is None:
        return
    if e.radius:
        d.put(d.i, "body", solids.sphere(e.radius, 20), color=d.colors.get(d.i.body, ""))
    else:
        ball(d, d.i, 0.3)
    if e.surface == "plane":
        plate(d, 0.25 * d.size / d.u)
    elif e.surface_radius:
        rings = (axes_along(np.eye(3)[k]) for k in range(3))
        ring = solids.circle(e.surface_radius, corners=48)
        d.put(d.j, "ground" if d.j.on_ground else "joint", *(Line(ring @ axes.T, 1.0) for axes in rings))
