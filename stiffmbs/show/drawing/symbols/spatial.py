"""Spatial symbols: pins, balls, blocks and coils, along the axes of their markers."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from .. import solids
from ..draft import Draft, Site, Symbol, at_both, at_first
from ..scene_graph import Line
from . import profiles
from .pins import DARK, ball, pin, plate, rail, shape
from .shared import (  # fmt: skip
    any_force,
    any_joint,
    arc_arrow,
    arrow,
    coupling,
    curve,
    drives_a_displacement,
    force,
    gear,
    ground,
    line_force,
    rack_and_pinion,
    rubbing,
    spiral,
    torque,
)
from .spatial_forces import beam, bushing, contact, elastic, spring_damper
from .wheel import wheel


@at_first
def revolute(d: Draft, i: Site) -> None:
    """A pin along z."""
    ground(d)
    pin(d, i)


@at_first
def spherical(d: Draft, i: Site) -> None:
    """A ball."""
    ground(d)
    ball(d, i)


@at_both
def universal(d: Draft, i: Site, j: Site) -> None:
    """A cross: an arm along the z of each marker."""
    ground(d)
    for site in (i, j):
        pin(d, site, 0.28, 2.2)


@at_first
def constant_velocity(d: Draft, i: Site) -> None:
    """A ball in a ring about the shaft."""
    ground(d)
    ball(d, i)
    d.put(i, "joint", Line(solids.circle(0.85 * d.u), 2.0))


@at_both
def prismatic(d: Draft, i: Site, j: Site) -> None:
    """A block on a rail."""
    rail(d, i, j)
    block = solids.box((1.8 * d.u, 1.8 * d.u, 3.2 * d.u))
    d.put(i, "body", solids.edged(block), color=d.colors.get(i.body, ""))


@at_both
def cylindrical(d: Draft, i: Site, j: Site) -> None:
    """A sleeve on a rail."""
    rail(d, i, j)
    pin(d, i, 0.7, 2.6)


@at_both
def screw(d: Draft, i: Site, j: Site) -> None:
    """A sleeve on a thread."""
    cylindrical(d)
    turns = np.linspace(-4, 4, 120)
    thread = np.column_stack([np.cos(2 * math.pi * turns), np.sin(2 * math.pi * turns), turns]) * (0.35, 0.35, 0.8)
    d.put(j, "joint", Line(thread * d.u, 1.0))


@at_both
def planar(d: Draft, i: Site, j: Site) -> None:
    """A block on a plane."""
    plate(d, j)
    shape(d, i, solids.box((1.4 * d.u, 1.4 * d.u, 0.6 * d.u)))


@at_both
def point_on_plane(d: Draft, i: Site, j: Site) -> None:
    """A ball on a plane."""
    plate(d, j)
    ball(d, i, 0.45)


@at_both
def point_on_line(d: Draft, i: Site, j: Site) -> None:
    """A ball on a line."""
    rail(d, i, j)
    ball(d, i, 0.45)


@at_both
def point_on_curve(d: Draft, i: Site, j: Site) -> None:
    """A ball on a curve."""
    curve(d, j)
    ball(d, i, 0.4)


@at_first
def fixed(d: Draft, i: Site) -> None:
    """A small dark cube."""
    ground(d)
    shape(d, i, solids.box((0.8 * d.u,) * 3), DARK)


@at_both
def directions(d: Draft, i: Site, j: Site) -> None:
    """Axes with constrained directions, without their points."""
    for site in (i, j):
        d.put(site, "drive", *arrow(np.array([0.0, 0.0, 1.0]), 2.2 * d.u, 0.6 * d.u))


@at_both
def distance(d: Draft, i: Site, j: Site) -> None:
    """A rod with a ball at each end."""
    ground(d)
    d.stretch(i, j, "joint", profiles.straight(), width=2.2)
    for site in (i, j):
        ball(d, site, 0.38)


@at_both
def revolute_spherical(d: Draft, i: Site, j: Site) -> None:
    """A rod from a ball at i to a pin at j."""
    ground(d)
    d.stretch(i, j, "joint", profiles.straight(), width=2.2)
    ball(d, i, 0.5)
    pin(d, j)


@at_first
def drive(d: Draft, i: Site) -> None:
    """An arrow around a driven angle, or along a driven displacement."""
    site = d.j if d.j is not None and d.j.on_ground else i
    if drives_a_displacement(d):
        d.put(site.at((1.4 * d.u, 0, 0)), "drive", *arrow(np.array([0.0, 0.0, 1.0]), 3.5 * d.u, 0.9 * d.u))
    else:
        d.put(site, "drive", *arc_arrow(1.5 * d.u, 0, 1.5 * math.pi, 0.7 * d.u))


SYMBOLS: Mapping[str, Symbol] = {
    "revolute": revolute, "spherical": spherical, "universal": universal, "constant_velocity": constant_velocity,
    "prismatic": prismatic, "cylindrical": cylindrical, "screw": screw, "thread": screw, "planar": planar,
    "point_on_plane": point_on_plane, "point_on_line": point_on_line, "point_on_curve": point_on_curve, "tangent_to_curve": point_on_curve,
    "fixed": fixed,
    "parallel": directions, "perpendicular": directions, "orientation": directions, "distance": distance,
    "revolute_spherical": revolute_spherical, "coupler": coupling, "gear": gear, "rack_and_pinion": rack_and_pinion, "drive": drive, "spring_damper": spring_damper,
    "torsion_spring": spiral, "bushing": bushing, "beam": beam, "field": elastic, "contact": contact,
    "sphere_contact": contact, "line_force": line_force, "force": force, "torque": torque, "joint_friction": rubbing,
    "tyre": wheel,
    "joint": any_joint, "any_force": any_force,
}  # fmt: skip
