"""Spatial symbols: pins, balls, blocks and coils, along the axes of their markers."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from .. import solids
from ..draft import Draft, Site, Symbol, at_both, at_first
from ..scene_graph import Line, Solid
from ..solids import axes_along
from . import profiles
from .shared import COMMON, arc_arrow, arrow, curve, drives_a_displacement, ground, is_damped

DARK = "#707070"


def shape(d: Draft, site: Site, solid: Solid, color: str = "") -> None:
    """Draw a solid with its edges."""
    d.put(site, "joint", solids.edged(solid), color=color)


def pin(d: Draft, site: Site, radius: float = 0.45, length: float = 2.0) -> None:
    """Draw a cylinder along z; sizes in units of symbols."""
    shape(d, site, solids.cylinder(radius * d.u, length * d.u, 16))


def ball(d: Draft, site: Site, radius: float = 0.6) -> None:
    """Draw a ball; its radius in units of symbols."""
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
    if getattr(e, "surface", "plane") == "plane":
        plate(d, j, 0.25 * d.size / d.u)
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


def radius_of(tyre: object) -> float:
    """Return the unloaded radius of a tyre, m; zero if its data have none."""
    properties = getattr(tyre, "properties", None)
    found = getattr(tyre, "radius", None) or _coefficient(properties, "UNLOADED_RADIUS")
    return float(found or 0.0)


def _coefficient(properties: object, name: str) -> float | None:
    found = getattr(properties, "coefficients", properties)
    value = found.get(name) if hasattr(found, "get") else getattr(found, name, None)
    return float(value) if isinstance(value, float | int) else None


@at_first
def wheel(d: Draft, i: Site) -> None:
    """A tyre on a rim with spokes, about the y axis of the marker."""
    radius = radius_of(d.element)
    if not radius:
        return
    width = _coefficient(getattr(d.element, "properties", None), "WIDTH") or WIDTH * radius
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
    **COMMON,
    "revolute": revolute, "spherical": spherical, "universal": universal, "constant_velocity": constant_velocity,
    "prismatic": prismatic, "cylindrical": cylindrical, "screw": screw, "thread": screw, "planar": planar,
    "point_on_plane": point_on_plane, "point_on_line": point_on_line, "point_on_curve": point_on_curve, "tangent_to_curve": point_on_curve,
    "fixed": fixed, "parallel": directions, "perpendicular": directions, "orientation": directions, "distance": distance,
    "revolute_spherical": revolute_spherical, "drive": drive, "spring_damper": spring_damper, "bushing": bushing, "beam": beam,
    "field": elastic, "contact": contact, "sphere_contact": contact, "road_contact": contact, "tyre": wheel,
}  # fmt: skip
