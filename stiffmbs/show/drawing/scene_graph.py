"""Scene graph of a mechanism: shapes on bodies, stretched symbols between them, names, loads.

All of it is spatial, the plane being the x-y plane, in metres and in the axes of bodies with origins at the centres of
mass.  The poses of all bodies (`stiffmbs.show.drawing.poses`) make a picture of it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

Role = Literal["body", "ground", "joint", "drive", "force", "rubber", "floor"]
"""Role of a drawn object; it determines the color."""
Mark = Literal["redundant", "not unique"]
"""Findings of `stiffmbs check` on a joint."""


@dataclass(frozen=True, eq=False)
class Solid:
    """Surface of flat faces."""

    vertices: np.ndarray  # shape (n, 3)
    faces: tuple[np.ndarray, ...]  # of int: vertices of each face in order, counterclockwise as seen from outside
    closed: bool = True  # True if the surface encloses a volume, so that faces that point away are hidden
    # of int, shape (m, 4): edges to draw: two vertices, and the two adjacent faces
    edges: np.ndarray = field(default_factory=lambda: np.zeros((0, 4), dtype=int))
    # shape (3, n, 3): displacements of the vertices by unit coordinates x, y, z of bodies that hold modal coordinates
    modes: Mapping[str, np.ndarray] = field(default_factory=dict)
    # shape (3, n, 5): stress deviators at the vertices by the same coordinates: the norm of their sum is the von Mises
    # stress, N/m^2
    stresses: Mapping[str, np.ndarray] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Line:
    """A line through points. `points` of shape (n, 3). `width`: width relative to an ordinary line."""

    points: np.ndarray
    width: float = 1.0
    dashed: bool = False


@dataclass(frozen=True, eq=False)
class Part:
    """Shape or symbol that moves with a body."""

    owner: str  # body, joint or force that it represents
    role: Role
    body: str  # body that it moves with; ``ground`` does not move
    # solids, lines: shapes in the body's axes, relative to its centre of mass
    solids: tuple[Solid, ...] = ()
    lines: tuple[Line, ...] = ()
    color: str = ""  # color of its faces, ``#rrggbb``; empty for that of its role


@dataclass(frozen=True, eq=False)
class Anchor:
    """Point of a body, relative to its centre of mass, m."""

    body: str
    point: np.ndarray


@dataclass(frozen=True, eq=False)
class Link:
    """Symbol stretched between two points, such as a spring.

    `profiles` of shape (n, 3): lines: the fraction of the distance from i to j, and two distances across it, m.
    `width`: width of the lines, relative to an ordinary one.
    """

    owner: str
    role: Role
    i: Anchor
    j: Anchor
    profiles: tuple[np.ndarray, ...]
    width: float = 1.0
    dashed: bool = False


@dataclass(frozen=True, eq=False)
class Name:
    """Name and its point."""

    text: str
    role: Role
    anchor: Anchor


@dataclass(frozen=True, eq=False)
class Drawing:
    """Drawables of a mechanism."""

    name: str
    dimensions: int  # 2: drawn as seen along z
    size: float  # size of the mechanism, m; the scale of arrows
    unit: float  # unit of symbols, m
    bodies: Mapping[str, str]  # bodies with their colors
    parts: tuple[Part, ...]
    links: tuple[Link, ...]
    names: tuple[Name, ...]
    loads: Mapping[str, Anchor]  # point at which each joint and force acts on its first body
    heaviest: str  # body with the largest mass; empty without bodies
    gravity: np.ndarray  # shape (3,)
    weight: float  # weight of all bodies, N (at 1 m/s^2 without gravity)
    marks: Mapping[str, Mark] = field(default_factory=dict)  # joints to mark
    # factors of the drawn deformation of flexible bodies
    deformations: Mapping[str, float] = field(default_factory=dict)
    # largest von Mises stress of bodies in stress colors, the end of the scale, N/m^2; zero without them
    stress: float = 0.0


BODIES = ("#56b4e9", "#e6c229", "#2f9e8f", "#d48fb5", "#8fb339", "#c9733a", "#8da0cb", "#b7a57a")
"""Colors of bodies, in turn."""
ROLES: Mapping[Role, str] = {
    "body": "#56b4e9", "ground": "#8a8a8a", "joint": "#f2f2f2", "drive": "#7b3294", "force": "#00633c", "rubber": "#4d4d4d",
    "floor": "#fbfbfa",
}  # fmt: skip
EDGES: Mapping[Role, str] = {
    "body": "#333333", "ground": "#555555", "joint": "#1a1a1a", "drive": "#7b3294", "force": "#00633c", "rubber": "#1a1a1a",
    "floor": "#d4d4d0",
}  # fmt: skip
MARKS: Mapping[Mark, str] = {"redundant": "#d55e00", "not unique": "#e69f00"}
LOAD, LOAD_NOT_UNIQUE = "#b2182b", "#e69f00"
PAPER = "#ffffff"
RAMP = ("#440154", "#472d7b", "#3b528b", "#2c728e", "#21918c", "#28ae80", "#5ec962", "#addc30", "#fde725")
"""Colors of a scale from its least to its largest value: viridis, from dark to bright."""


def body_colors(bodies: Iterable[str]) -> dict[str, str]:
    """Return a color for each body, in turn."""
    return {body: BODIES[k % len(BODIES)] for k, body in enumerate(bodies)}


def edge_color(drawing: Drawing, owner: str, role: Role) -> str:
    """Return the color of the lines of an element."""
    mark = drawing.marks.get(owner)
    return MARKS[mark] if mark else EDGES[role]


def face_color(drawing: Drawing, part: Part) -> str:
    """Return the color of the faces of a part."""
    mark = drawing.marks.get(part.owner)
    if mark and part.role in ("joint", "drive"):
        return MARKS[mark]
    return part.color or (drawing.bodies.get(part.owner, "") if part.role == "body" else "") or ROLES[part.role]


def on_ramp(part: float) -> str:
    """Return the color at a part of the scale, 0 to 1."""
    return RAMP[min(round(max(part, 0.0) * (len(RAMP) - 1)), len(RAMP) - 1)]


def shaded(color: str, brightness: float) -> str:
    """Return a color darkened by a factor below 1."""
    parts = (int(color[k : k + 2], 16) for k in (1, 3, 5))
    return "#" + "".join(f"{max(0, min(255, round(part * brightness))):02x}" for part in parts)
