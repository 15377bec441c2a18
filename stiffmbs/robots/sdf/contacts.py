"""Contacts between the collisions of SDFormat files."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Final

import numpy as np

from ...elements.spatial.orientation import product
from ...reading.files.quoted import quoted
from ...reading.files.xml_nodes import Node
from ..contact import BOX, CAPSULE, CYLINDER, ELLIPSOID, PLANE, SPHERE, USUAL, Contact, Given, Shape, split
from ..robot import RobotFault
from ..scene.mechanism import along_z
from .poses import Pose, flag, number, numbers, text_of
from .scopes import Scope
from .solids import placed

ALL_BITS: Final = 0xFFFF
"""Default of ``collide_bitmask``."""
GROUND_FRICTION: Final = 100.0
"""Friction of Gazebo's ground plane; a contact has the smaller one of both surfaces."""


@dataclass(frozen=True)
class Surface:
    """Properties of the surface of a collision. `softness`: N/m and N s/m; None if the file states none."""

    bits: int = ALL_BITS
    friction: float = 1.0
    softness: Given | None = None


@dataclass(frozen=True)
class Collision:
    """Collision of a link.

    `model`: number of the outermost model around it. `static`: True if it does not move. `within`: True if it touches
    other links of its model.
    """

    shape: Shape
    model: int
    static: bool
    within: bool = False
    surface: Surface = Surface()


def contacts(
    root: Scope, joined: Collection[tuple[str | None, str | None]], grounds: Sequence[Pose]
) -> tuple[tuple[Contact, ...], list[str]]:
    """Return the contacts of collisions that may touch, and notes on others.

    Links of a model touch each other by ``self_collide`` alone. `joined`: pairs of links with a joint between them.
    `grounds`: poses of ground planes without a file, in the world.
    """
    planes = [Shape("ground_plane", None, PLANE, (), pose.position, pose.orientation) for pose in grounds]
    found = [Collision(plane, -1, True, surface=Surface(friction=GROUND_FRICTION)) for plane in planes]
    for model, scope in enumerate((*root.merged, *root.models.values())):
        for inner in scope.scopes():
            found += _collisions(inner, model)
    of_shape = {one.shape: one for one in found}
    apart = {frozenset(pair) for pair in joined}
    pairs = [(a.shape, b.shape) for a, b in combinations(found, 2) if _may_touch(a, b, apart)]
    held, notes = split(pairs)
    return tuple(_contact(of_shape[a], of_shape[b]) for a, b in held), notes


def _may_touch(a: Collision, b: Collision, apart: Collection[frozenset[str | None]]) -> bool:
    if (a.static and b.static) or a.shape.link == b.shape.link or not a.surface.bits & b.surface.bits:
        return False
    if frozenset((a.shape.link, b.shape.link)) in apart:
        return False
    return a.model != b.model or (a.within and b.within)


def _contact(a: Collision, b: Collision) -> Contact:
    """Return the contact of two surfaces: springs in series, dampers added, and the smaller friction, as in Gazebo."""
    stated = [each.surface.softness for each in (a, b) if each.surface.softness is not None]
    friction = min(a.surface.friction, b.surface.friction)
    if not stated:
        return Contact(a.shape, b.shape, USUAL, friction)
    softness = stated[0]
    for other in stated[1:]:
        stiffness = softness.stiffness * other.stiffness / (softness.stiffness + other.stiffness)
        softness = Given(stiffness, softness.damping + other.damping)
    return Contact(a.shape, b.shape, softness, friction)


def _collisions(scope: Scope, model: int) -> Iterator[Collision]:
    within = flag(scope.where, scope.node, "self_collide")
    for name, link in scope.links.items():
        full = f"{scope.prefix}{name}"
        own = flag(f"link {quoted(full)}", link, "self_collide", within)
        for k, node in enumerate(link.findall("collision"), 1):
            called = f"{full}_{node.get('name') or f'shape_{k}'}"
            where = f"link {quoted(full)}: the collision {node.get('name') or 'without a name'}"
            pose = placed(where, name, node.find("pose"), scope)
            geometry = node.find("geometry")
            for shape in [] if geometry is None else geometry.children():
                kind, size, turn = shape.tag, *_geometry(where, shape)
                turned = product(pose.orientation, turn)
                solid = Shape(called, full, kind, size, pose.position, turned)
                yield Collision(solid, model, scope.static, own, _surface(where, node.find("surface")))


def _geometry(where: str, node: Node) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return the size of a shape, and the orientation of its axes in its pose."""
    if node.tag == PLANE:
        normal = np.array(numbers(where, "normal", text_of(node.find("normal")) or "0 0 1"))
        node.without_effect("size")
        length = float(np.linalg.norm(normal))
        if length == 0:
            raise RobotFault(f"{where}: found a normal of length 0, expected a direction")
        return (), along_z(tuple(map(float, normal / length)))
    size = SIZES[node.tag](where, node) if node.tag in SIZES else ()
    if not all(0 < length < math.inf for length in size):
        raise RobotFault(f"{where}: found a size that is not positive, expected positive ones")
    return size, (1.0, 0.0, 0.0, 0.0)


def _three(tag: str) -> Callable[[str, Node], tuple[float, ...]]:
    return lambda where, node: tuple(numbers(where, tag, text_of(node.find(tag))))


def _round(*tags: str) -> Callable[[str, Node], tuple[float, ...]]:
    return lambda where, node: tuple(number(where, node, tag, 0.0) for tag in tags)


SIZES: Mapping[str, Callable[[str, Node], tuple[float, ...]]] = {
    SPHERE: _round("radius"),
    CYLINDER: _round("radius", "length"),
    CAPSULE: _round("radius", "length"),
    BOX: _three("size"),
    ELLIPSOID: _three("radii"),
}


def _surface(where: str, surface: Node | None) -> Surface:
    """Return the bits, friction and stiffness of a ``<surface>``."""
    contact, friction = (None if surface is None else surface.find(tag) for tag in ("contact", "friction"))
    bits = "" if contact is None else text_of(contact.find("collide_bitmask"))
    of_contact, of_friction = (None if each is None else each.find("ode") for each in (contact, friction))
    kp, kd = number(where, of_contact, "kp", 0.0), number(where, of_contact, "kd", 0.0)
    return Surface(
        _bits(where, bits) if bits else ALL_BITS,
        number(where, of_friction, "mu", 1.0),
        Given(kp, max(kd, 0.0)) if kp > 0 else None,
    )


def _bits(where: str, text: str) -> int:
    try:
        return int(text, 0)
    except ValueError:
        raise RobotFault(f"{where}: found '{quoted(text)}' in <collide_bitmask>, expected an integer") from None
