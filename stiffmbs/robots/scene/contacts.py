"""Contacts between the shapes of links, as impact forces."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np

from ...elements.spatial.number_format import plain
from ...elements.spatial.orientation import rotated
from ...reading.files.quoted import listed
from ...reading.files.yaml_text import Content
from ..contact import BOX, CAPSULE, CYLINDER, ELLIPSOID, PLANE, SPHERE, Contact, Shape
from ..effective_mass import inverse_masses
from ..overlaps import Overlaps
from ..robot import GRAVITY, Robot
from .mechanism import Mechanism

STIFFNESS, DAMPING, FRICTION, SLIP = "contact_stiffness", "contact_damping", "contact_friction", "contact_slip"
CONTACTS: Mapping[str, float] = {STIFFNESS: 1.0, DAMPING: 1.0, FRICTION: 1.0, SLIP: 1e-3}
"""Parameters of a scene with contacts: factors of all stiffnesses, dampings and frictions, and the stiction velocity, m/s."""
WEIGHT: Final = -GRAVITY[2]
"""Acceleration for the depth under a shape's own effective mass, also in files without gravity, m/s^2."""


@dataclass
class Contacts:
    """Contacts in a scene: parameters and forces by name, and notes."""

    parameters: Content = field(default_factory=dict)
    forces: Content = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)


def contacts(robot: Robot, mechanism: Mechanism, coordinates: Mapping[str, float]) -> Contacts:
    """Return the contacts of a robot between bodies that can move relative to each other.

    The normal force at a penetration x is max(0, k x + c x'). The damper acts fully from half the depth at which the
    effective mass of both links rests. Friction is smooth below the stiction velocity.
    """
    markers, found, deep = _Markers(mechanism), Contacts(), []
    if not robot.contacts:
        return found
    names = {name: mechanism.names.take(name) for name in CONTACTS}
    found.parameters = {names[name]: plain(value) for name, value in CONTACTS.items()}
    inverse = inverse_masses(robot, coordinates)
    overlaps = Overlaps(robot, coordinates)
    for contact in robot.contacts:
        first, second = contact.first, contact.second
        mobility = inverse[first.link] + inverse[second.link]
        if not mobility > 0 or mechanism.seats[first.link].body == mechanism.seats[second.link].body:
            continue
        law, depth = _law(contact, 1.0 / mobility, names)
        for kind, fields, i, j in parts(contact):
            name = mechanism.names.take(f"{i.name}_on_{j.name}")
            found.forces[name] = {"type": kind, "i": markers.of(i), "j": markers.of(j), **fields, **law}
            if (inside := overlaps.of(i, j)) > 2.0 * depth:
                deep.append(f"{name} by {inside:.3g} m")
    if deep:
        found.notes = [f"shapes that overlap at the start are pushed apart: {listed(deep)}"]
    return found


def _law(contact: Contact, mass: float, names: Mapping[str, str]) -> tuple[Content, float]:
    """Return the fields of the force law, and the penetration at which its damping is full, m."""
    k, c = contact.softness.of(mass)
    depth = WEIGHT * mass / k / 2.0
    fields: Content = {"stiffness": f"{k!r}*{names[STIFFNESS]}", "exponent": 1, "depth": depth}
    if c:
        fields["damping"] = f"{c!r}*{names[DAMPING]}"
    if contact.friction:
        coefficient = f"{float(contact.friction)!r}*{names[FRICTION]}"
        fields |= {"friction": coefficient, "static_friction": coefficient}
        fields |= {"stiction_velocity": names[SLIP], "friction_velocity": f"2*{names[SLIP]}"}
    return fields, depth


Part = tuple[str, Content, Shape, Shape]
"""Kind of a force with its fields of geometry, and the shapes of markers i and j."""


def parts(contact: Contact) -> Iterator[Part]:
    """Yield the forces of a contact: two for a capsule, one for other shapes."""
    first, second = contact.first, contact.second
    if first.kind == PLANE or (first.kind != second.kind and second.kind == SPHERE):
        first, second = second, first
    if second.kind == PLANE:
        second = _raised(second, contact.margin)
        ends = list(_ends(first)) if first.kind == CAPSULE else [first]
        yield from ((*ON_PLANE[each.kind](each), each, second) for each in ends)
    else:
        first = replace(first, size=(first.size[0] + contact.margin, *first.size[1:]))
        yield (*ON_SOLID[second.kind](first, second), first, second)


def _raised(plane: Shape, margin: float) -> Shape:
    place = np.array(plane.position) + rotated(plane.orientation, (0.0, 0.0, margin))
    return replace(plane, position=tuple(map(float, place))) if margin else plane


def _ends(capsule: Shape) -> Iterator[Shape]:
    """Yield the spheres at both ends of a capsule, which alone touch a plane."""
    radius, length = capsule.size
    for number, along in enumerate((length / 2, -length / 2), 1):
        place = np.array(capsule.position) + rotated(capsule.orientation, (0.0, 0.0, along))
        name = f"{capsule.name}_end_{number}"
        yield replace(capsule, name=name, kind=SPHERE, size=(radius,), position=tuple(map(float, place)))


def _lengths(names: str, values: tuple[float, ...]) -> Content:
    return {name: plain(value) for name, value in zip(names.split(), values, strict=True)}


ON_PLANE: Mapping[str, Callable[[Shape], tuple[str, Content]]] = {
    SPHERE: lambda i: ("ellipsoid_plane_impact", _lengths("x y z", i.size * 3)),
    ELLIPSOID: lambda i: ("ellipsoid_plane_impact", _lengths("x y z", i.size)),
    BOX: lambda i: ("box_plane_impact", _lengths("x y z", i.size)),
    CYLINDER: lambda i: ("cylinder_plane_impact", _lengths("radius length", i.size)),
}
ON_SOLID: Mapping[str, Callable[[Shape, Shape], tuple[str, Content]]] = {
    SPHERE: lambda i, j: ("sphere_sphere_impact", _lengths("radius other_radius", i.size + j.size)),
    CAPSULE: lambda i, j: (
        "capsule_impact",
        _lengths("radius length", (*i.size, 0.0)[:2]) | _lengths("other_radius other_length", j.size),
    ),
    BOX: lambda i, j: ("sphere_box_impact", _lengths("radius x y z", i.size + j.size)),
    CYLINDER: lambda i, j: (
        "sphere_cylinder_impact",
        _lengths("radius cylinder_radius cylinder_length", i.size + j.size),
    ),
}


class _Markers:
    """Markers of shapes, one for each shape."""

    def __init__(self, mechanism: Mechanism) -> None:
        self._mechanism, self._found = mechanism, dict[Shape, str]()

    def of(self, shape: Shape) -> str:
        """Return the reference of a shape's marker."""
        if shape not in self._found:
            name = self._mechanism.names.take(shape.name, "shape")
            self._found[shape] = self._mechanism.mark(shape.link, name, shape.position, shape.orientation)
        return self._found[shape]
