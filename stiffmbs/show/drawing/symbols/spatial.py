"""Spatial symbols: pins, balls, blocks and coils, along the axes of their markers."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np

from .. import solids
from ..draft import Draft
from ..scene_graph import Line
from . import profiles
from .gears import gear, rack_and_pinion
from .pins import DARK, ball, pin, plate, rail, shape
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
from .spatial_forces import beam, bushing, contact, elastic, spring_damper


def revolute(d: Draft) -> None:
    """A pin along z."""
    ground(d)
    if d.i is not None:
        pin(d, d.i)


def spherical(d: Draft) -> None:
    """A ball."""
    ground(d)
    if d.i is not None:
        ball(d, d.i)


def universal(d: Draft) -> None:
    """A cross: an arm along the z of each marker."""
    ground(d)
    for site in (d.i, d.j):
        if site is not None:
            pin(d, site, 0.28, 2.2)


def constant_velocity(d: Draft) -> None:
    """A ball in a ring about the shaft."""
    ground(d)
    if d.i is not None:
        ball(d, d.i)
        d.put(d.i, "joint", Line(solids.circle(0.85 * d.u), 2.0))


def prismatic(d: Draft) -> None:
    """A block on a rail."""
    if d.i is not None and d.j is not None:
        rail(d)
        _block(d, (1.8, 1.8, 3.2))


def _block(d: Draft, size: tuple[float, float, float]) -> None:
    assert d.i is not None
    block = solids.box((size[0] * d.u, size[1] * d.u, size[2] * d.u))
    d.put(d.i, "body", solids.edged(block), color=d.colors.get(d.i.body, ""))


def cylindrical(d: Draft) -> None:
    """A sleeve on a rail."""
    if d.i is not None and d.j is not None:
        rail(d)
        pin(d, d.i, 0.7, 2.6)


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
        plate(d)
        shape(d, d.i, solids.box((1.4 * d.u, 1.4 * d.u, 0.6 * d.u)))


def point_on_plane(d: Draft) -> None:
    """A ball on a plane."""
    if d.i is not None and d.j is not None:
        plate(d)
        ball(d, d.i, 0.45)


def point_on_line(d: Draft) -> None:
    """A ball on a line."""
    if d.i is not None and d.j is not None:
        rail(d)
        ball(d, d.i, 0.45)


def point_on_curve(d: Draft) -> None:
    """A ball on a curve."""
    curve(d)
    if d.i is not None:
        ball(d, d.i, 0.4)


def fixed(d: Draft) -> None:
    """A small dark cube."""
    ground(d)
    if d.i is not None:
        shape(d, d.i, solids.box((0.8 * d.u,) * 3), DARK)


def directions(d: Draft) -> None:
    """Axes with constrained directions, without their points."""
    for site in (d.i, d.j):
        if site is not None:
            d.put(site, "drive", *arrow(np.array([0.0, 0.0, 1.0]), 2.2 * d.u, 0.6 * d.u))


def distance(d: Draft) -> None:
    """A rod with a ball at each end."""
    ground(d)
    if d.i is not None and d.j is not None:
        d.stretch(d.i, d.j, "joint", profiles.STRAIGHT, width=2.2)
        for site in (d.i, d.j):
            ball(d, site, 0.38)


def revolute_spherical(d: Draft) -> None:
    """A rod from a ball at i to a pin at j."""
    ground(d)
    if d.i is not None and d.j is not None:
        d.stretch(d.i, d.j, "joint", profiles.STRAIGHT, width=2.2)
        ball(d, d.i, 0.5)
        pin(d, d.j)


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


SYMBOLS: Mapping[str, Callable[[Draft], None]] = {
    "revolute": revolute, "spherical": spherical, "universal": universal, "constant_velocity": constant_velocity,
    "prismatic": prismatic, "cylindrical": cylindrical, "screw": screw, "thread": screw, "planar": planar,
    "point_on_plane": point_on_plane, "point_on_line": point_on_line, "point_on_curve": point_on_curve, "tangent_to_curve": point_on_curve,
    "fixed": fixed,
    "parallel": directions, "perpendicular": directions, "orientation": directions, "distance": distance,
    "revolute_spherical": revolute_spherical, "coupler": coupling, "gear": gear, "rack_and_pinion": rack_and_pinion, "drive": drive, "spring_damper": spring_damper,
    "torsion_spring": spiral, "bushing": bushing, "beam": beam, "field": elastic, "contact": contact,
    "sphere_contact": contact, "line_force": line_force, "force": force, "torque": torque, "joint_friction": rubbing,
    "joint": any_joint, "any_force": any_force,
}  # fmt: skip
