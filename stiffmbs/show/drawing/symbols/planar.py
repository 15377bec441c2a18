"""Planar symbols, as in textbooks on mechanisms."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

import numpy as np

from .. import solids
from ..draft import Draft, Piece, Site, Symbol, at_both, at_each, at_first
from ..scene_graph import Line, Role
from . import profiles
from .shared import COMMON, arc_arrow, arrow, curve, drives_a_displacement, hatched, is_damped, upright


def _front(site: Site, d: Draft, layer: float = 1.0) -> Site:
    """Return a site in front of the bodies, by a multiple of the distance of pins."""
    return site.at((0, 0, layer * d.front))


def pin(radius: float = 0.5) -> Piece:
    """Return a disc; its radius in units of symbols."""
    return lambda d, i, _: d.put(
        _front(i, d), "joint", solids.disc(radius * d.u), Line(solids.circle(radius * d.u), 1.3)
    )


def support(d: Draft, *_: Site) -> None:
    """Triangle on hatched ground under a pin."""
    site = d.grounded()
    if site is None:
        return
    foot = np.array([[0, 0, 0], [-0.9, -1.6, 0], [0.9, -1.6, 0]]) * d.u
    below = _front(upright(d, site), d, 0.5)
    d.put(
        below, "ground", solids.flat(foot), solids.outline(foot, 1.1), *hatched(d.u, 1.3, -1.6 * d.u), color="#dddddd"
    )


def _anchor(d: Draft, other: Site) -> None:
    """Hatched ground across the direction to the other end."""
    site = d.grounded()
    if site is None:
        return
    offset = other.in_ground - site.in_ground
    if np.linalg.norm(offset) < 1e-9 * d.size:
        return
    y = offset / np.linalg.norm(offset)
    axes = np.column_stack([np.cross(y, [0.0, 0.0, 1.0]), y, [0.0, 0.0, 1.0]])
    d.put(_front(site.along_ground().with_axes(axes), d, 0), "ground", *hatched(d.u, 1.2, 0.0))


def slider(d: Draft, i: Site, _: Site) -> None:
    """A block in the color of its body."""
    block = solids.rectangle(4.4 * d.u, 2.4 * d.u)
    d.put(_front(i, d, 0.15), "body", solids.flat(block), solids.outline(block), color=d.colors.get(i.body, ""))


def guides(d: Draft, i: Site, j: Site, half: float = 0.5) -> None:
    """Lines on both sides along the axis of j at the position of i; hatched outside on ground."""
    start = float(j.turned[:, 0] @ (i.in_ground - j.in_ground))
    length = 0.3 * d.size
    for side in (1, -1):
        height = side * (half + 0.12) * d.u
        ends = np.array([[start - length, height, 0], [start + length, height, 0]])
        d.put(j, "ground" if j.on_ground else "joint", Line(ends, 1.3))
        if j.on_ground:
            xs = np.arange(start - length, start + length + 1e-9, 0.7 * d.u)
            strokes = (Line(np.array([[x, height, 0], [x - 0.3 * d.u, height + side * 0.4 * d.u, 0]]), 0.6) for x in xs)
            d.put(j, "ground", *strokes)


def square(d: Draft, i: Site, _: Site) -> None:
    """A filled square."""
    d.put(_front(i, d), "rubber", solids.flat(solids.rectangle(0.9 * d.u, 0.9 * d.u)))


def rod(d: Draft, i: Site, j: Site) -> None:
    """A bar from one site to the other."""
    d.stretch(_front(i, d), _front(j, d), "joint", *profiles.bar(0.14 * d.u))


def drive(d: Draft, i: Site, j: Site) -> None:
    """An arrow around a driven angle, or along a driven displacement."""
    if drives_a_displacement(d):
        along = j.turned[:, 0]
        above = i.along_ground().at(1.9 * d.u * np.array([-along[1], along[0], 0.0]))
        d.put(_front(above, d), "drive", *arrow(along, 3 * d.u, 0.9 * d.u))
        return
    arc = arc_arrow(1.35 * d.u, -0.1 * np.pi, 1.25 * np.pi, 0.6 * d.u)
    holder = j if j.on_ground else i
    d.put(_front(holder.along_ground(), d), "drive", *arc)


def spring_damper(d: Draft, i: Site, j: Site) -> None:
    """A zigzag, and a dashpot next to it."""
    _anchor(d, j if i.on_ground else i)
    width, shift = (0.5 * d.u, 0.75 * d.u) if is_damped(d) else (0.7 * d.u, 0.0)
    ends = _front(i, d, 0.5), _front(j, d, 0.5)
    d.stretch(*ends, "force", profiles.zigzag(width, shift), width=1.2)
    if is_damped(d):
        d.stretch(*ends, "force", *profiles.damper(0.45 * d.u, -shift), width=1.1)


def rubber(d: Draft, _: Site, j: Site) -> None:
    """A ring of rubber."""
    d.put(_front(j, d, 0.9), "rubber", solids.disc(0.95 * d.u), Line(solids.circle(0.95 * d.u), 1.2))


def contact(d: Draft, i: Site, j: Site) -> None:
    """Circle about i, and the line or circle that it touches."""
    e = d.element
    if e.radius:
        ring = solids.circle(e.radius, corners=40)
        spoke = Line(np.array([[0.6 * e.radius, 0, 0], [e.radius, 0, 0]]))
        d.put(_front(i, d, -0.15), "body", solids.flat(ring[:-1]), Line(ring), spoke, color=d.colors.get(i.body, ""))
    else:
        pin(0.2)(d, i, j)
    role: Role = "ground" if j.on_ground else "joint"
    if e.surface == "line":
        start = float(j.turned[:, 0] @ (i.in_ground - j.in_ground))
        lines = hatched(d.u, 0.25 * d.size / d.u, 0.0)
        d.put(j.at((start, 0, 0)), role, *(lines if j.on_ground else lines[:1]))
    elif e.surface_radius:
        d.put(_front(j, d, -0.2), role, Line(solids.circle(e.surface_radius, corners=48), 1.5))


SYMBOLS: Mapping[str, Symbol] = {
    **COMMON,
    "revolute": at_first(support, pin()),
    "prismatic": at_both(slider, partial(guides, half=1.2)),
    "fixed": at_first(square, support),
    "distance": at_both(support, rod, at_each(pin(0.32))),
    "point_on_line": at_both(guides, pin(0.45)),
    "point_on_curve": at_both(curve, pin(0.4)),
    "drive": at_first(drive),
    "spring_damper": at_both(spring_damper),
    "bushing": at_both(support, rubber, pin(0.42)),
    "contact": at_both(contact),
}
