"""Spatial symbols: pins, balls, blocks and coils, along the axes of their markers."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from ....model.wheels import coefficient, radius_of
from .. import solids
from ..draft import Draft, Piece, Site, Symbol, at_both, at_each, at_first, at_other
from ..scene_graph import Line, Solid
from ..solids import axes_along
from . import profiles
from .shared import COMMON, arc_arrow, arrow, curve, drives_a_displacement, ground, is_damped, stretched

DARK = "#707070"


def shape(d: Draft, site: Site, solid: Solid, color: str = "") -> None:
    """Draw a solid with its edges."""
    d.put(site, "joint", solids.edged(solid), color=color)


def pin(radius: float = 0.45, length: float = 2.0) -> Piece:
    """Return a cylinder along z; sizes in units of symbols."""
    return lambda d, i, _: shape(d, i, solids.cylinder(radius * d.u, length * d.u, 16))


def ball(radius: float = 0.6) -> Piece:
    """Return a ball; its radius in units of symbols."""
    return lambda d, i, _: d.put(i, "joint", solids.sphere(radius * d.u))


def box(x: float, y: float, z: float, color: str = "") -> Piece:
    """Return a block; sizes in units of symbols."""
    return lambda d, i, _: shape(d, i, solids.box((x * d.u, y * d.u, z * d.u)), color)


def rail(d: Draft, i: Site, j: Site) -> None:
    """Line on j along its z, on which i slides; shorter on a moving body."""
    half = 0.25 if j.on_ground else 0.1
    start = float(j.turned[:, 2] @ (i.in_ground - j.in_ground))
    ends = np.array([[0, 0, start - half * d.size], [0, 0, start + half * d.size]])
    d.put(j, "ground" if j.on_ground else "joint", Line(ends, 1.8))


def plate(d: Draft, _: Site, j: Site, half: float = 3.0) -> None:
    """Plane on which i stays: the x-y plane of j."""
    square = solids.rectangle(2 * half * d.u, 2 * half * d.u)
    diagonals = (Line(square[[k, k + 2]], 0.5) for k in (0, 1))
    d.put(j, "ground" if j.on_ground else "joint", solids.outline(square), *diagonals)


def spring_damper(d: Draft, i: Site, j: Site) -> None:
    """A coil, and a dashpot in it."""
    d.stretch(i, j, "force", profiles.coil(0.7 * d.u), width=1.2)
    if is_damped(d):
        d.stretch(i, j, "force", *profiles.damper(0.35 * d.u), width=1.1)


def rubber(d: Draft, _: Site, j: Site) -> None:
    """A sleeve of rubber."""
    d.put(j, "rubber", solids.edged(solids.cylinder(0.8 * d.u, 1.1 * d.u, 18)))


def springs(d: Draft, _: Site, j: Site) -> None:
    """Springs in all directions."""
    shape(d, j, solids.cylinder(0.6 * d.u, 0.8 * d.u, 16), DARK)


def contact(d: Draft, i: Site, j: Site) -> None:
    """Ball about i, and the plane or ball that it touches."""
    e = d.element
    if e.radius:
        d.put(i, "body", solids.sphere(e.radius, 20), color=d.colors.get(i.body, ""))
    else:
        ball(0.3)(d, i, j)
    if getattr(e, "surface", "plane") == "plane":
        plate(d, i, j, 0.25 * d.size / d.u)
    elif e.surface_radius:
        rings = (axes_along(np.eye(3)[k]) for k in range(3))
        ring = solids.circle(e.surface_radius, corners=48)
        d.put(j, "ground" if j.on_ground else "joint", *(Line(ring @ axes.T, 1.0) for axes in rings))


TREAD, RIM = "#4a4a4a", "#c9cdd2"
WIDTH = 0.62
"""Width of a tyre whose data have none, in radii."""
RIM_RADIUS, SPOKES = 0.66, 5
PROFILE = np.array([[0.66, -0.5], [0.95, -0.5], [1.0, -0.3], [1.0, 0.3], [0.95, 0.5], [0.66, 0.5]])
"""Cross section of a tyre: radius in radii, and place in widths."""


def wheel(d: Draft, i: Site, _: Site) -> None:
    """A tyre on a rim with spokes, about the y axis of the marker."""
    radius = radius_of(d.element)
    if not radius:
        return
    width = coefficient(d.element, "WIDTH") or WIDTH * radius
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


def ring(d: Draft, i: Site, _: Site) -> None:
    """A ring about the shaft."""
    d.put(i, "joint", Line(solids.circle(0.85 * d.u), 2.0))


def slider(d: Draft, i: Site, _: Site) -> None:
    """A block in the color of its body."""
    block = solids.box((1.8 * d.u, 1.8 * d.u, 3.2 * d.u))
    d.put(i, "body", solids.edged(block), color=d.colors.get(i.body, ""))


def thread(d: Draft, _: Site, j: Site) -> None:
    """A thread about z."""
    turns = np.linspace(-4, 4, 120)
    points = np.column_stack([np.cos(2 * math.pi * turns), np.sin(2 * math.pi * turns), turns]) * (0.35, 0.35, 0.8)
    d.put(j, "joint", Line(points * d.u, 1.0))


def axis(d: Draft, i: Site, _: Site) -> None:
    """A constrained direction, without its point."""
    d.put(i, "drive", *arrow(np.array([0.0, 0.0, 1.0]), 2.2 * d.u, 0.6 * d.u))


def drive(d: Draft, i: Site, j: Site) -> None:
    """An arrow around a driven angle, or along a driven displacement."""
    site = j if j.on_ground else i
    if drives_a_displacement(d):
        d.put(site.at((1.4 * d.u, 0, 0)), "drive", *arrow(np.array([0.0, 0.0, 1.0]), 3.5 * d.u, 0.9 * d.u))
    else:
        d.put(site, "drive", *arc_arrow(1.5 * d.u, 0, 1.5 * math.pi, 0.7 * d.u))


rod = stretched("joint", profiles.straight(), width=2.2)
directions, touching, on_curve = at_both(at_each(axis)), at_both(contact), at_both(curve, ball(0.4))
SYMBOLS: Mapping[str, Symbol] = {
    **COMMON,
    "revolute": at_first(ground, pin()),
    "spherical": at_first(ground, ball()),
    "universal": at_both(ground, at_each(pin(0.28, 2.2))),
    "constant_velocity": at_first(ground, ball(), ring),
    "prismatic": at_both(rail, slider),
    "cylindrical": at_both(rail, pin(0.7, 2.6)),
    "screw": at_both(rail, pin(0.7, 2.6), thread),
    "thread": at_both(rail, pin(0.7, 2.6), thread),
    "planar": at_both(plate, box(1.4, 1.4, 0.6)),
    "point_on_plane": at_both(plate, ball(0.45)),
    "point_on_line": at_both(rail, ball(0.45)),
    "point_on_curve": on_curve,
    "tangent_to_curve": on_curve,
    "fixed": at_first(ground, box(0.8, 0.8, 0.8, DARK)),
    "parallel": directions,
    "perpendicular": directions,
    "orientation": directions,
    "distance": at_both(ground, rod, at_each(ball(0.38))),
    "revolute_spherical": at_both(ground, rod, ball(0.5), at_other(pin())),
    "drive": at_first(drive),
    "spring_damper": at_both(ground, spring_damper),
    "bushing": at_both(ground, rubber, pin(0.35, 1.8)),
    "beam": at_both(at_other(stretched("force", profiles.straight(), width=3.0))),
    "field": at_both(at_other(stretched("force", profiles.straight(), width=1.5, dashed=True)), springs),
    "contact": touching,
    "sphere_contact": touching,
    "road_contact": touching,
    "tyre": at_first(wheel),
}
