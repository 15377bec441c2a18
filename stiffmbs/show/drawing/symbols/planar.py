"""Planar symbols, as in textbooks on mechanisms."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from .. import solids
from ..draft import Draft, Site
from ..scene_graph import Line, Role
from . import profiles
from .gears import gear, rack_and_pinion
from .shared import (
    any_force,
    any_joint,
    arc_arrow,
    arrow,
    coupling,
    curve,
    force,
    hatched,
    line_force,
    rubbing,
    spiral,
    torque,
    upright,
)  # fmt: skip


def _front(site: Site, d: Draft, layer: float = 1.0) -> Site:
    """Return a site in front of the bodies, by a multiple of the distance of pins."""
    return site.at((0, 0, layer * d.front))


def _pin(d: Draft, site: Site, radius: float = 0.5) -> None:
    ring = solids.circle(radius * d.u)
    d.put(_front(site, d), "joint", solids.disc(radius * d.u), Line(ring, 1.3))


def _support(d: Draft) -> None:
    """Triangle on hatched ground under a pin."""
    site = d.grounded()
    if site is None:
        return
    foot = np.array([[0, 0, 0], [-0.9, -1.6, 0], [0.9, -1.6, 0]]) * d.u
    below = _front(upright(d, site), d, 0.5)
    d.put(
        below, "ground", solids.flat(foot), solids.outline(foot, 1.1), *hatched(d.u, 1.3, -1.6 * d.u), color="#dddddd"
    )


def _anchor(d: Draft, other: Site | None) -> None:
    """Hatched ground across the direction to the other end."""
    site = d.grounded()
    if site is None or other is None:
        return
    way = other.in_ground - site.in_ground
    if np.linalg.norm(way) < 1e-9 * d.size:
        return
    y = way / np.linalg.norm(way)
    axes = np.column_stack([np.cross(y, [0.0, 0.0, 1.0]), y, [0.0, 0.0, 1.0]])
    d.put(_front(site.along_ground().with_axes(axes), d, 0), "ground", *hatched(d.u, 1.2, 0.0))


def revolute(d: Draft) -> None:
    """A pin."""
    _support(d)
    if d.i is not None:
        _pin(d, d.i)


def prismatic(d: Draft) -> None:
    """A block between two guides."""
    if d.i is None or d.j is None:
        return
    block = solids.rectangle(4.4 * d.u, 2.4 * d.u)
    color = d.colors.get(d.i.body, "")
    d.put(_front(d.i, d, 0.15), "body", solids.flat(block), solids.outline(block), color=color)
    _guides(d, 1.2)


def _guides(d: Draft, half: float) -> None:
    """Lines on both sides along the axis of j at the position of i; hatched outside on ground."""
    assert d.i is not None and d.j is not None
    start = float(d.j.turned[:, 0] @ (d.i.in_ground - d.j.in_ground))
    length = 0.3 * d.size
    for side in (1, -1):
        height = side * (half + 0.12) * d.u
        ends = np.array([[start - length, height, 0], [start + length, height, 0]])
        d.put(d.j, "ground" if d.j.on_ground else "joint", Line(ends, 1.3))
        if d.j.on_ground:
            xs = np.arange(start - length, start + length + 1e-9, 0.7 * d.u)
            strokes = (Line(np.array([[x, height, 0], [x - 0.3 * d.u, height + side * 0.4 * d.u, 0]]), 0.6) for x in xs)
            d.put(d.j, "ground", *strokes)


def point_on_line(d: Draft) -> None:
    """A pin in a slot."""
    if d.i is not None and d.j is not None:
        _guides(d, 0.5)
        _pin(d, d.i, 0.45)


def point_on_curve(d: Draft) -> None:
    """A pin on a curve."""
    curve(d)
    if d.i is not None:
        _pin(d, d.i, 0.4)


def fixed(d: Draft) -> None:
    """A filled square."""
    if d.i is not None:
        square = solids.rectangle(0.9 * d.u, 0.9 * d.u)
        d.put(_front(d.i, d), "rubber", solids.flat(square))
        _support(d)


def distance(d: Draft) -> None:
    """A rod with a pin at each end."""
    _support(d)
    if d.i is not None and d.j is not None:
        d.stretch(_front(d.i, d), _front(d.j, d), "joint", *profiles.bar(0.14 * d.u))
        for site in (d.i, d.j):
            _pin(d, site, 0.32)


def drive(d: Draft) -> None:
    """An arrow around a driven angle, or along a driven displacement."""
    site = d.j or d.i
    if site is None or d.i is None:
        return
    place = d.i.along_ground()
    if _is_straight(d):
        along = site.turned[:, 0]
        d.put(
            _front(place.at(1.9 * d.u * np.array([-along[1], along[0], 0.0])), d),
            "drive",
            *arrow(along, 3 * d.u, 0.9 * d.u),
        )
        return
    arc = arc_arrow(1.35 * d.u, -0.1 * np.pi, 1.25 * np.pi, 0.6 * d.u)
    holder = site if site.on_ground else d.i
    d.put(_front(holder.along_ground(), d), "drive", *arc)


def _is_straight(d: Draft) -> bool:
    name = d.element.joint
    if name is None or name.joint not in d.joints:
        return False
    return bool(name.coordinate_of(d.joints[name.joint][0]) == "displacement")


def spring_damper(d: Draft) -> None:
    """A zigzag, and a dashpot next to it."""
    if d.i is None or d.j is None:
        return
    _anchor(d, d.j if d.i.on_ground else d.i)
    damped = bool(getattr(d.element, "damping", 0)) or getattr(d.element, "damper_law", None) is not None
    shift = 0.75 * d.u if damped else 0.0
    d.stretch(
        _front(d.i, d, 0.5),
        _front(d.j, d, 0.5),
        "force",
        profiles.zigzag(0.5 * d.u if damped else 0.7 * d.u, shift),
        width=1.2,
    )
    if damped:
        d.stretch(_front(d.i, d, 0.5), _front(d.j, d, 0.5), "force", *profiles.damper(0.45 * d.u, -shift), width=1.1)


def torsion_spring(d: Draft) -> None:
    spiral(d)


def bushing(d: Draft) -> None:
    """A ring of rubber about a pin."""
    if d.i is None or d.j is None:
        return
    _support(d)
    d.put(_front(d.j, d, 0.9), "rubber", solids.disc(0.95 * d.u), Line(solids.circle(0.95 * d.u), 1.2))
    _pin(d, d.i, 0.42)


def contact(d: Draft) -> None:
    """Circle about i, and the line or circle that it touches."""
    e = d.element
    if d.i is None or d.j is None:
        return
    if e.radius:
        ring = solids.circle(e.radius, corners=40)
        spoke = Line(np.array([[0.6 * e.radius, 0, 0], [e.radius, 0, 0]]))
        d.put(
            _front(d.i, d, -0.15), "body", solids.flat(ring[:-1]), Line(ring), spoke, color=d.colors.get(d.i.body, "")
        )
    else:
        _pin(d, d.i, 0.2)
    role: Role = "ground" if d.j.on_ground else "joint"
    if e.surface == "line":
        start = float(d.j.turned[:, 0] @ (d.i.in_ground - d.j.in_ground))
        lines = hatched(d.u, 0.25 * d.size / d.u, 0.0)
        d.put(d.j.at((start, 0, 0)), role, *(lines if d.j.on_ground else lines[:1]))
    elif e.surface_radius:
        ring = solids.circle(e.surface_radius, corners=48)
        d.put(_front(d.j, d, -0.2), role, Line(ring, 1.5))


SYMBOLS: Mapping[str, Callable[[Draft], None]] = {
    "revolute": revolute, "prismatic": prismatic, "fixed": fixed, "distance": distance, "point_on_line": point_on_line,
    "point_on_curve": point_on_curve, "gear": gear, "rack_and_pinion": rack_and_pinion, "coupler": coupling,
    "drive": drive, "spring_damper": spring_damper, "torsion_spring": torsion_spring, "bushing": bushing,
    "contact": contact, "line_force": line_force, "force": force, "torque": torque, "joint_friction": rubbing,
    "joint": any_joint, "any_force": any_force,
}  # fmt: skip
