"""Contacts of the links of URDF files with the ground."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import isfinite, nan

from ..reading.files.quoted import quoted
from ..reading.files.xml_nodes import Node
from .contact import BOX, CAPSULE, CYLINDER, PLANE, SPHERE, USUAL, Contact, Given, PerMass, Shape, split
from .robot import RobotFault
from .urdf_values import numbers, origin, value_of

SIZES: Mapping[str, tuple[str, ...]] = {
    SPHERE: ("radius",),
    CAPSULE: ("radius", "length"),
    CYLINDER: ("radius", "length"),
}
"""Attributes of round shapes."""


@dataclass(frozen=True)
class Surface:
    """Properties of a link's surface, by default those of files that state none."""

    softness: PerMass | Given = USUAL
    friction: float = 1.0


def contacts(root: Node, links: Mapping[str, Node], ground: float | None) -> tuple[tuple[Contact, ...], list[str]]:
    """Return the contacts of all links with the ground, a plane at a height in m, and notes; none without a height.

    Friction and stiffness are Gazebo's, ``mu1``, ``kp`` and ``kd`` in ``<gazebo reference=...>``, where the file states
    them. Links do not touch each other.
    """
    if ground is None:
        return (), ["URDF states no ground that the links could touch (convert --ground HEIGHT adds one)"]
    plane = Shape("ground_plane", None, PLANE, position=(0.0, 0.0, ground))
    surfaces = dict(_surfaces(root))
    shapes = [shape for name, link in links.items() for shape in _shapes(name, link)]
    held, notes = split((shape, plane) for shape in shapes)
    found = []
    for shape, _ in held:
        surface = surfaces.get(shape.link or "", Surface())
        found.append(Contact(shape, plane, surface.softness, surface.friction))
    return tuple(found), notes


def _shapes(link: str, node: Node) -> Iterator[Shape]:
    for number, collision in enumerate(node.findall("collision"), 1):
        name = collision.get("name") or (f"{link}_shape" if number == 1 else f"{link}_shape_{number}")
        where = f"link {link}: the collision {name}"
        geometry = collision.find("geometry")
        for shape in [] if geometry is None else geometry.children():
            yield Shape(name, link, shape.tag, _size(where, shape), *origin(where, collision))


def _size(where: str, shape: Node) -> tuple[float, ...]:
    if shape.tag == BOX:
        size = tuple(numbers(where, "size", shape.get("size") or ""))
    else:
        size = tuple(value_of(where, shape, key, 0.0) for key in SIZES.get(shape.tag, ()))
    if any(length < 0 for length in size):
        raise RobotFault(f"{where}: found a negative size, expected positive ones")
    return size


def _surfaces(root: Node) -> Iterator[tuple[str, Surface]]:
    """Yield the properties of links in Gazebo's extension of the format."""
    for node in root.findall("gazebo"):
        if link := node.get("reference"):
            where = f"<gazebo> of {link}"
            friction, kp, kd = (_number(where, node, tag) for tag in ("mu1", "kp", "kd"))
            softness = USUAL if kp is None or kp <= 0 else Given(kp, kd or 0.0)
            yield link, Surface(softness, 1.0 if friction is None else friction)


def _number(where: str, node: Node, tag: str) -> float | None:
    """Return the number in a child element, as its text or attribute ``value``."""
    found = node.find(tag)
    if found is None:
        return None
    text = found.get("value") or found.text
    try:
        value = float(text)
    except ValueError:
        value = nan
    if not (isfinite(value) and value >= 0):
        raise RobotFault(f"{where}: found '{quoted(text)}' in <{tag}>, expected a number of at least 0")
    return value
