"""Symbols shared by planar and spatial drawings."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ....reading.formula.formula import Formula
from ....reading.formula.text import FormulaError
from ....reading.formula.value import formula_value
from .. import solids
from ..draft import Draft, Piece, Site, Symbol, at_both, at_first
from ..scene_graph import Line, Role
from ..solids import axes_along
from . import profiles

TURN = 2 * math.pi
FAR_OFF = 0.1
"""Distance of a torque's marker from the centre of mass, relative to the mechanism, above which it is ignored."""


def ground(d: Draft, *_: Site) -> None:
    """Hatched line, or plate, under a point of the ground."""
    site = d.grounded()
    if site is not None:
        d.put(upright(d, site).at((0, 0.0, 0)), "ground", *hatched(d.u, 1.1, 0.0))


def upright(d: Draft, site: Site) -> Site:
    """Return the site with axes whose -y points down."""
    up = -d.down
    x = np.cross(up, [0.0, 0.0, 1.0])
    if np.linalg.norm(x) < 0.5:  # up is z: the plate is perpendicular to the x axis
        x = np.array([1.0, 0.0, 0.0])
    return site.along_ground().with_axes(np.column_stack([x, up, np.cross(x, up)]))


def hatched(u: float, half: float, height: float) -> list[Line]:
    """Return a line along x with hatching below it; half its width is given in units."""
    strokes = np.arange(-half, half + 1e-9, 0.4) * u
    low = height - 0.45 * u
    line = Line(np.array([[-half * u, height, 0], [half * u, height, 0]]), 1.4)
    return [line, *(Line(np.array([[x, height, 0], [x - 0.35 * u, low, 0]]), 0.7) for x in strokes)]


def arc_arrow(radius: float, start: float, end: float, head: float) -> list[Line]:
    """Return an arc in the x-y plane with a head at its end."""
    tip = radius * np.array([math.cos(end), math.sin(end), 0.0])
    back = np.array([math.sin(end), -math.cos(end), 0.0]) * head
    out = np.array([math.cos(end), math.sin(end), 0.0]) * head * 0.6
    return [
        Line(solids.circle(radius, start, end), 1.6),
        Line(np.array([tip + back + out, tip, tip + back - out]), 1.6),
    ]


def arrow(direction: np.ndarray, length: float, head: float) -> list[Line]:
    """Return an arrow from the origin."""
    axes = axes_along(direction)
    tip = axes[:, 2] * length
    wings = [tip - axes[:, 2] * head + axes[:, 0] * side * head * 0.6 for side in (1, -1)]
    return [Line(np.array([np.zeros(3), tip]), 1.8), Line(np.array([wings[0], tip, wings[1]]), 1.8)]


def components(values: Any) -> np.ndarray | None:
    """Return the direction of a constant force, shape (3,), or None if it is not constant or zero."""
    try:
        numbers = [formula_value(v, t=0.0) if isinstance(v, Formula) else float(v) for v in values]
    except (FormulaError, KeyError, TypeError, ValueError):
        return None
    found = np.array([*numbers, 0.0])[:3]
    return found / np.linalg.norm(found) if np.linalg.norm(found) > 0 else None


def force(d: Draft, i: Site, _: Site) -> None:
    """Arrow at the point, in the direction of the force if that is constant."""
    direction = components(d.element.force)
    if direction is None:
        d.put(i, "force", solids.outline(solids.circle(0.55 * d.u, corners=4)[:-1], 1.6))
        return
    site = i if getattr(d.element, "axes", "body") == "body" else i.along_ground()
    d.put(site.at(-5 * d.u * direction), "force", *arrow(direction, 4.3 * d.u, 1.1 * d.u))


def torque(d: Draft, i: Site, _: Site) -> None:
    """Arrow around the point, or around the centre of mass if far away: a torque has no point of application."""
    site = replace(i, point=np.zeros(3)) if np.linalg.norm(i.point) > FAR_OFF * d.size else i
    d.put(site, "force", *arc_arrow(1.7 * d.u, -0.6 * TURN, 0.12 * TURN, 0.7 * d.u))


def stretched(role: Role, *lines: object, **strokes: Any) -> Piece:
    """Return profiles from the first marker to the second."""
    return lambda d, i, j: d.stretch(i, j, role, *lines, **strokes)


def two_headed(d: Draft, i: Site, j: Site) -> None:
    """A line with two heads."""
    d.stretch(i, j, "force", *profiles.arrows(0.6 * d.u))


def spiral(d: Draft, i: Site, _: Site) -> None:
    """A clock spring about z."""
    angles = np.linspace(0, 2.5 * TURN, 60)
    radius = np.linspace(0.5, 1.5, 60) * d.u
    points = np.column_stack([radius * np.cos(angles), radius * np.sin(angles), 0.05 * d.u + 0 * angles])
    d.put(i, "force", Line(points, 1.3))


def coupling(d: Draft) -> None:
    """A dashed line between two coupled joints."""
    one, other = d.joint_site("joint_1"), d.joint_site("joint_2")
    if one is not None and other is not None:
        d.stretch(one, other, "drive", profiles.straight(), dashed=True)


def rubbing(d: Draft, i: Site, _: Site) -> None:
    """Short strokes at sliding surfaces."""
    places = (-0.8, -0.4, 0.0, 0.4, 0.8)
    d.put(i, "force", *(Line(np.array([[x - 0.2, -1.5, 0], [x + 0.2, -1.1, 0]]) * d.u, 1.2) for x in places))


def is_damped(d: Draft) -> bool:
    """Return True if a spring-damper has a damper."""
    return bool(getattr(d.element, "damping", 0)) or getattr(d.element, "damper_law", None) is not None


def drives_a_displacement(d: Draft) -> bool:
    """Return True if a drive moves its joint along an axis, not about it."""
    name = d.element.joint
    if name is None or name.joint not in d.joints:
        return False
    return bool(name.coordinate_of(d.joints[name.joint][0]) == "displacement")


def any_joint(d: Draft, i: Site, _: Site) -> None:
    """Diamond at the point of the joint's reaction."""
    diamond = solids.circle(0.5 * d.u, corners=4)[:-1]
    d.put(i, "joint", solids.flat(diamond), solids.outline(diamond))
    if d.j is not None and np.linalg.norm(i.in_ground - d.j.in_ground) > d.u:
        d.stretch(i, d.j, "joint", profiles.straight(), dashed=True)


def any_force(d: Draft, i: Site, _: Site) -> None:
    """A dashed line between the markers, or a diamond at a single marker."""
    if d.j is not None and np.linalg.norm(i.in_ground - d.j.in_ground) > d.u:
        d.stretch(i, d.j, "force", *profiles.arrows(0.5 * d.u), dashed=True)
    else:
        d.put(i, "force", solids.outline(solids.circle(0.6 * d.u, corners=4)[:-1], 1.5))


def curve(d: Draft, _: Site, j: Site) -> None:
    """Curve on which a point stays, in the axes of marker j."""
    try:
        d.put(j, "joint", Line(_along_y(d) if d.element.y is not None else _around(d), 1.6))
    except FormulaError:  # a formula of more than the argument
        return


def _value(law: Any, name: str, x: float) -> float:
    if isinstance(law, Formula):
        variables: dict[str, Any] = {name: x}
        return formula_value(law, **variables)
    rows = np.array(law.table)
    period = {"period": rows[-1, 0] - rows[0, 0]} if law.repeats else {}
    return float(np.interp(x, rows[:, 0], rows[:, 1], **period))


def _along_y(d: Draft) -> np.ndarray:
    law = d.element.y
    half = 0.4 * d.size
    ends: tuple[float, float] = (law.table[0][0], law.table[-1][0]) if hasattr(law, "table") else (-half, half)
    return np.array([[x, _value(law, "x", x), 0.0] for x in np.linspace(*ends, 80)])


def _around(d: Draft) -> np.ndarray:
    radii = np.array([_value(d.element.radius, "angle", a) for a in np.linspace(0, TURN, 97)])
    return solids.circle(1.0, corners=96) * radii[:, None]


def gear(d: Draft) -> None:
    """Pitch circles, each with a stroke that rotates."""
    one, two = d.joint_site("joint_1"), d.joint_site("joint_2")
    if one is None or two is None:
        return
    apart = float(np.linalg.norm(one.in_ground - two.in_ground))
    ratio = d.element.ratio
    first = apart / abs(1 + ratio) if abs(1 + ratio) > 1e-9 else apart / 2
    for site, radius in ((one, first), (two, abs(ratio) * first)):
        _wheel(d, site, radius)


def _wheel(d: Draft, site: Site, radius: float) -> None:
    mark = np.array([[0.75 * radius, 0, 0], [radius, 0, 0]])
    d.put(site.at((0, 0, d.front)), "joint", Line(solids.circle(radius, corners=48), 1.3, dashed=True), Line(mark, 1.3))


def rack_and_pinion(d: Draft) -> None:
    """Pitch circle of the pinion, and the rack."""
    pinion, rack = d.joint_site("pinion"), d.joint_site("rack")
    if pinion is not None:
        _wheel(d, pinion, abs(d.element.pitch_radius))
    if rack is not None:
        ends = np.zeros((2, 3))
        ends[:, 0 if d.front else 2] = -0.3 * d.size, 0.3 * d.size  # along the axis of the prismatic joint
        d.put(rack.at((0, 0, d.front)), "joint", Line(ends, 1.5, dashed=True))


COMMON: Mapping[str, Symbol] = {
    "gear": gear, "rack_and_pinion": rack_and_pinion, "coupler": coupling, "torsion_spring": at_first(spiral),
    "line_force": at_both(two_headed), "force": at_first(force), "torque": at_first(torque), "joint_friction": at_first(rubbing),
    "joint": at_first(any_joint), "any_force": at_first(any_force),
}  # fmt: skip
"""Symbols by kind, in the plane and in space."""
