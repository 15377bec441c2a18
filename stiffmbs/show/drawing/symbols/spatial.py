"""Symbols of space: pins, balls, blocks and coils, along the axes of their markers."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np

from .. import solids
from ..draft import Draft, Site
from ..frames import axes_along
from ..scene_graph import Line, Solid
from . import profiles
from .shared import (
    any_force,
    any_joint,
    arc_arrow,
    arrow,
    coupling,
    curve,
    force,
    ground,
    line_force,
    rubbing,
    spiral,
    torque,
)  # fmt: skip

DARK = "#707070"


def _shape(d: Draft, site: Site, solid: Solid, color: str = "") -> None:
    d.put(site, "joint", solids.edged(solid), color=color)


def _pin(d: Draft, site: Site, radius: float = 0.45, length: float = 2.0) -> None:
    _shape(d, site, solids.cylinder(radius * d.u, length * d.u, 16))


def _ball(d: Draft, site: Site, radius: float = 0.6) -> None:
    d.put(site, "joint", solids.sphere(radius * d.u))


def _rail(d: Draft, half: float = 0.25) -> None:
    """The line that i slides on, on j along its z."""
    assert d.i is not None and d.j is not None
    start = float(d.j.turned[:, 2] @ (d.i.in_ground - d.j.in_ground))
    ends = np.array([[0, 0, start - half * d.size], [0, 0, start + half * d.size]])
    d.put(d.j, "ground" if d.j.on_ground else "joint", Line(ends, 1.8))


def _plate(d: Draft, half: float = 3.0) -> None:
    """The plane that i stays on: the x-y plane of j."""
    assert d.j is not None
    square = solids.rectangle(2 * half * d.u, 2 * half * d.u)
    d.put(
        d.j,
        "ground" if d.j.on_ground else "joint",
        solids.outline(square),
        Line(square[[0, 2]], 0.5),
        Line(square[[1, 3]], 0.5),
    )


def revolute(d: Draft) -> None:
    """A pin along z."""
    ground(d)
    if d.i is not None:
        _pin(d, d.i)


def spherical(d: Draft) -> None:
    """A ball."""
    ground(d)
    if d.i is not None:
        _ball(d, d.i)


def universal(d: Draft) -> None:
    """A cross: an arm along the z of each marker."""
    ground(d)
    for site in (d.i, d.j):
        if site is not None:
            _pin(d, site, 0.28, 2.2)


def constant_velocity(d: Draft) -> None:
    """A ball in a ring about the shaft."""
    ground(d)
    if d.i is not None:
        _ball(d, d.i)
        d.put(d.i, "joint", Line(solids.circle(0.85 * d.u), 2.0))


def prismatic(d: Draft) -> None:
    """A block on a rail."""
    if d.i is not None and d.j is not None:
        _rail(d)
        _block(d, (1.8, 1.8, 3.2))


def _block(d: Draft, size: tuple[float, float, float]) -> None:
    assert d.i is not None
    block = solids.box((size[0] * d.u, size[1] * d.u, size[2] * d.u))
    d.put(d.i, "body", solids.edged(block), color=d.colors.get(d.i.body, ""))


def cylindrical(d: Draft) -> None:
    """A sleeve on a rail."""
    if d.i is not None and d.j is not None:
        _rail(d)
        _pin(d, d.i, 0.7, 2.6)


def screw(d: Draft) -> None:
    """A sleeve on a thread."""
    if d.i is None or d.j is None:
        return
    cylindrical(d)
    turns = np.linspace(-4, 4, 120)
    thread = np.column_stack([np.cos(2 * math.pi * turns), np.sin(2 * math.pi * turns), turns]) * (0.35, 0.35, 0.8)
    d.put(d.j, "joint", Line(thread * d.u, 1.0))


def planar(d: Draft) -> None:
    """A block on a plane."""
    if d.i is not None and d.j is not None:
        _plate(d)
        _shape(d, d.i, solids.box((1.4 * d.u, 1.4 * d.u, 0.6 * d.u)))


def point_on_plane(d: Draft) -> None:
    """A ball on a plane."""
    if d.i is not None and d.j is not None:
        _plate(d)
        _ball(d, d.i, 0.45)


def point_on_line(d: Draft) -> None:
    """A ball on a line."""
    if d.i is not None and d.j is not None:
        _rail(d)
        _ball(d, d.i, 0.45)


def point_on_curve(d: Draft) -> None:
    """A ball on a curve."""
    curve(d)
    if d.i is not None:
        _ball(d, d.i, 0.4)


def fixed(d: Draft) -> None:
    """A small dark cube."""
    ground(d)
    if d.i is not None:
        _shape(d, d.i, solids.box((0.8 * d.u,) * 3), DARK)


def directions(d: Draft) -> None:
    """The axes whose directions are tied, without the points."""
    for site in (d.i, d.j):
        if site is not None:
            d.put(site, "drive", *arrow(np.array([0.0, 0.0, 1.0]), 2.2 * d.u, 0.6 * d.u))


def distance(d: Draft) -> None:
    """A rod with a ball at each end."""
    ground(d)
    if d.i is not None and d.j is not None:
        d.stretch(d.i, d.j, "joint", profiles.STRAIGHT, width=2.2)
        for site in (d.i, d.j):
            _ball(d, site, 0.38)


def revolute_spherical(d: Draft) -> None:
    """A rod from a ball at i to a pin at j."""
    ground(d)
    if d.i is not None and d.j is not None:
        d.stretch(d.i, d.j, "joint", profiles.STRAIGHT, width=2.2)
        _ball(d, d.i, 0.5)
        _pin(d, d.j)


def drive(d: Draft) -> None:
    """An arrow around a driven angle, or along a driven displacement."""
    site = d.j if d.j is not None and d.j.on_ground else d.i
    if site is None:
        return
    name = d.element.joint
    straight = (
        name is not None and name.joint in d.joints and name.coordinate_of(d.joints[name.joint][0]) == "displacement"
    )
    shapes = (
        arrow(np.array([0.0, 0.0, 1.0]), 3.5 * d.u, 0.9 * d.u)
        if straight
        else arc_arrow(1.5 * d.u, 0, 1.5 * math.pi, 0.7 * d.u)
    )
    d.put(site.at((1.4 * d.u, 0, 0) if straight else (0, 0, 0)), "drive", *shapes)


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
    _pin(d, d.i, 0.35, 1.8)


def beam(d: Draft) -> None:
    """A thick elastic line."""
    if d.i is not None and d.j is not None:
        d.stretch(d.j, d.i, "force", profiles.STRAIGHT, width=3.0)


def elastic(d: Draft) -> None:
    """A dashed line between the markers with springs of all directions."""
    if d.i is not None and d.j is not None:
        d.stretch(d.j, d.i, "force", profiles.STRAIGHT, width=1.5, dashed=True)
        _shape(d, d.j, solids.cylinder(0.6 * d.u, 0.8 * d.u, 16), DARK)


def contact(d: Draft) -> None:
    """The ball about i, and the plane or ball that it meets."""
    e = d.element
    if d.i is None or d.j is None:
        return
    if e.radius:
        d.put(d.i, "body", solids.sphere(e.radius, 20), color=d.colors.get(d.i.body, ""))
    else:
        _ball(d, d.i, 0.3)
    if e.surface == "plane":
        _plate(d, 0.25 * d.size / d.u)
    elif e.surface_radius:
        rings = (axes_along(np.eye(3)[k]) for k in range(3))
        ring = solids.circle(e.surface_radius, corners=48)
        d.put(d.j, "ground" if d.j.on_ground else "joint", *(Line(ring @ axes.T, 1.0) for axes in rings))


SYMBOLS: Mapping[str, Callable[[Draft], None]] = {
    "revolute": revolute, "spherical": spherical, "universal": universal, "constant_velocity": constant_velocity,
    "prismatic": prismatic, "cylindrical": cylindrical, "screw": screw, "thread": screw, "planar": planar,
    "point_on_plane": point_on_plane, "point_on_line": point_on_line, "point_on_curve": point_on_curve, "fixed": fixed,
    "parallel": directions, "perpendicular": directions, "orientation": directions, "distance": distance,
    "revolute_spherical": revolute_spherical, "coupler": coupling, "drive": drive, "spring_damper": spring_damper,
    "torsion_spring": spiral, "bushing": bushing, "beam": beam, "field": elastic, "contact": contact,
    "sphere_contact": contact, "line_force": line_force, "force": force, "torque": torque, "joint_friction": rubbing,
    "joint": any_joint, "any_force": any_force,
}  # fmt: skip
