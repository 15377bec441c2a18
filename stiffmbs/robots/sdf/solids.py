"""Mass and inertia of links by their shapes, for ``<inertial auto="true">``."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from ...elements.spatial.orientation import matrix
from ...reading.files.xml_nodes import Node
from ..robot import RobotFault
from .poses import Pose, number, numbers, pose_of, text_of
from .scopes import Scope

WATER: Final = 1000.0
"""Density of a shape without another one, kg/m^3; the format's default."""
Solid = tuple[float, tuple[float, float, float]]
"""Volume, m^3, and principal moments of inertia of 1 kg about the centre, m^2."""


@dataclass(frozen=True)
class Part:
    """Shape of a link: its mass, kg, its centre, m, and its inertia about it in the axes of the link, kg m^2."""

    mass: float
    centre: np.ndarray
    inertia: np.ndarray


def of_shapes(where: str, name: str, link: Node, inertial: Node, scope: Scope) -> tuple[float, np.ndarray, np.ndarray]:
    """Return the mass of a link's shapes, its centre, and the inertia about it in the link's axes.

    A given mass replaces that by the densities. Raises RobotFault for other shapes than a box, sphere, cylinder, capsule
    or ellipsoid.
    """
    parts = list(_parts(where, name, link, number(where, inertial, "density", WATER), scope))
    mass = sum(part.mass for part in parts)
    if not parts or not 0 < mass < math.inf:
        raise RobotFault(f"{where}: found shapes with a mass of {mass:g} kg, expected a positive one of <collision>")
    centre = sum((part.mass * part.centre for part in parts), np.zeros(3)) / mass
    inertia = sum((part.inertia + part.mass * _about(part.centre - centre) for part in parts), np.zeros((3, 3)))
    factor = number(where, inertial, "mass", mass) / mass
    return factor * mass, centre, factor * (inertia + inertia.T) / 2


def _parts(where: str, name: str, link: Node, density: float, scope: Scope) -> Iterator[Part]:
    for collision in link.findall("collision"):
        own = f"{where}: the collision {collision.get('name') or 'without a name'}"
        volume, moments = _solid(own, collision.find("geometry"))
        mass = number(own, collision, "density", density) * volume
        pose = placed(own, name, collision.find("pose"), scope)
        A = matrix(pose.orientation)
        yield Part(mass, np.array(pose.position), mass * (A * np.array(moments)) @ A.T)


def placed(where: str, link: str, pose: Node | None, scope: Scope) -> Pose:
    """Return the pose of a shape in the frame of its link."""
    base = None if pose is None else pose.get("relative_to")
    found = pose_of(where, pose)
    return scope.pose(link, where).inverse().on(scope.pose(base, where)).on(found) if base else found


def _about(r: np.ndarray) -> np.ndarray:
    """Return the inertia of 1 kg at a point about the origin, m^2."""
    return (r @ r) * np.eye(3) - np.outer(r, r)


def _box(where: str, node: Node) -> Solid:
    x, y, z = numbers(where, "size", text_of(node.find("size")))
    return x * y * z, ((y**2 + z**2) / 12, (x**2 + z**2) / 12, (x**2 + y**2) / 12)


def _ellipsoid(where: str, node: Node) -> Solid:
    a, b, c = numbers(where, "radii", text_of(node.find("radii")))
    return 4 / 3 * math.pi * a * b * c, ((b**2 + c**2) / 5, (a**2 + c**2) / 5, (a**2 + b**2) / 5)


def _sphere(where: str, node: Node) -> Solid:
    r = _size(where, node, "radius")
    return 4 / 3 * math.pi * r**3, (0.4 * r**2,) * 3


def _cylinder(where: str, node: Node) -> Solid:
    r, length = _size(where, node, "radius"), _size(where, node, "length")
    across = (3 * r**2 + length**2) / 12
    return math.pi * r**2 * length, (across, across, r**2 / 2)


def _capsule(where: str, node: Node) -> Solid:
    """Return a cylinder of the given length with half a sphere at each end."""
    r, length = _size(where, node, "radius"), _size(where, node, "length")
    barrel, ends = math.pi * r**2 * length, 4 / 3 * math.pi * r**3
    whole = barrel + ends or math.nan
    across = (barrel * (3 * r**2 + length**2) / 12 + ends * (0.4 * r**2 + length**2 / 4 + 3 / 8 * length * r)) / whole
    return barrel + ends, (across, across, (barrel * r**2 / 2 + ends * 0.4 * r**2) / whole)


def _size(where: str, node: Node, tag: str) -> float:
    return numbers(where, tag, text_of(node.find(tag)), 1)[0]


SOLIDS: dict[str, Callable[[str, Node], Solid]] = {
    "box": _box, "sphere": _sphere, "cylinder": _cylinder, "capsule": _capsule, "ellipsoid": _ellipsoid,
}  # fmt: skip


def _solid(where: str, geometry: Node | None) -> Solid:
    shapes = [] if geometry is None else geometry.among(*SOLIDS)
    if len(shapes) != 1:
        raise RobotFault(f"{where}: found no shape with a known inertia, expected one of {', '.join(SOLIDS)}")
    volume, moments = SOLIDS[shapes[0].tag](where, shapes[0])
    if not volume > 0:
        raise RobotFault(f"{where}: found a volume of {volume:g} m^3, expected a positive one")
    return volume, moments
