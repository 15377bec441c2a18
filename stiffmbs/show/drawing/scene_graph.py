"""What a drawing of a mechanism consists of: shapes on bodies, stretched symbols between them, names, loads.

All of it is in space, the plane being its x-y plane, in metres and in the axes of bodies: the origin of each is its centre of
mass.  A pose of every body (`stiffmbs.show.drawing.poses`) makes a picture of it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

Role = Literal["body", "ground", "joint", "drive", "force", "rubber"]
"""What something drawn stands for; decides on its color."""
Mark = Literal["redundant", "not unique"]
"""What `stiffmbs check` says of a joint."""


@dataclass(frozen=True, eq=False)
class Solid:
    """A surface of flat faces.

    Attributes
    ----------
    vertices : ndarray, shape (n, 3)
    faces : tuple of ndarray of int
        The vertices of each face in turn, counterclockwise seen from outside.
    closed : bool
        Whether it encloses a volume, so that faces that point away are hidden.
    edges : ndarray of int, shape (m, 4)
        Edges that are drawn: two vertices, and the two faces that meet there.
    """

    vertices: np.ndarray
    faces: tuple[np.ndarray, ...]
    closed: bool = True
    edges: np.ndarray = field(default_factory=lambda: np.zeros((0, 4), dtype=int))


@dataclass(frozen=True, eq=False)
class Line:
    """A line through points.

    Attributes
    ----------
    points : ndarray, shape (n, 3)
    width : float
        Relative to that of an ordinary line.
    dashed : bool
    """

    points: np.ndarray
    width: float = 1.0
    dashed: bool = False


@dataclass(frozen=True, eq=False)
class Part:
    """What moves with a body: a shape of it, or a symbol.

    Attributes
    ----------
    owner : str
        The body, joint or force that it is drawn for.
    role : Role
    body : str
        What it moves with; ``ground`` does not move.
    solids, lines : tuples
        In the body's axes from its centre of mass.
    color : str
        Of its faces, ``#rrggbb``; that of its role where it is empty.
    """

    owner: str
    role: Role
    body: str
    solids: tuple[Solid, ...] = ()
    lines: tuple[Line, ...] = ()
    color: str = ""


@dataclass(frozen=True, eq=False)
class Anchor:
    """A point of a body, from its centre of mass, m."""

    body: str
    point: np.ndarray


@dataclass(frozen=True, eq=False)
class Link:
    """A symbol that is stretched between two points, such as a spring.

    Attributes
    ----------
    owner : str
    role : Role
    i, j : Anchor
    profiles : tuple of ndarray, shape (n, 3)
        Lines: the fraction of the way from i to j, and two distances across it, m.
    width : float
        Of the lines, relative to an ordinary one.
    dashed : bool
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
    """A name and the point that it stands at."""

    text: str
    role: Role
    anchor: Anchor


@dataclass(frozen=True, eq=False)
class Drawing:
    """A mechanism as drawables.

    Attributes
    ----------
    name : str
    dimensions : int
        2: drawn as seen along z.
    size : float
        Of the mechanism, m, to which arrows are scaled.
    unit : float
        To which symbols are scaled, m.
    bodies : mapping of str to str
        Bodies with their colors.
    parts, links, names : tuples
    loads : mapping of str to Anchor
        Where the force of each joint and force acts on its first body.
    heaviest : str
        The body with the largest mass; empty without bodies.
    gravity : ndarray, shape (3,)
    weight : float
        Of all bodies, N (at 1 m/s^2 without gravity).
    marks : mapping of str to Mark
        Joints of which there is something to say.
    """

    name: str
    dimensions: int
    size: float
    unit: float
    bodies: Mapping[str, str]
    parts: tuple[Part, ...]
    links: tuple[Link, ...]
    names: tuple[Name, ...]
    loads: Mapping[str, Anchor]
    heaviest: str
    gravity: np.ndarray
    weight: float
    marks: Mapping[str, Mark] = field(default_factory=dict)
