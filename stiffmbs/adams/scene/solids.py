"""Contacts of cylinders, boxes and ellipsoids.  MSC Adams/Solver, CONTACT and GRAPHICS statements."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...elements.spatial.number_format import plain
from ..statements.contact import BOX, CYLINDER, ELLIPSOID, PLANE, SPHERE, Contact, Shape
from ..statements.units import Units
from .mechanism import Mechanism

PAIRS = {
    (SPHERE, SPHERE): "sphere_sphere_impact",
    (SPHERE, CYLINDER): "sphere_cylinder_impact",
    (SPHERE, BOX): "sphere_box_impact",
    (CYLINDER, PLANE): "cylinder_plane_impact",
    (BOX, PLANE): "box_plane_impact",
    (ELLIPSOID, PLANE): "ellipsoid_plane_impact",
}
SHAPES = {SPHERE: "ellipsoid", ELLIPSOID: "ellipsoid", CYLINDER: "cylinder", BOX: "box"}
"""Scene names of the solids, any two of which may be in contact."""


def between_solids(contact: Contact, first: Shape, second: Shape, mechanism: Mechanism) -> dict[str, Any]:
    """Return the element of a contact. Raises DatasetFault if no element supports this pair of shapes."""
    one, other = (second, first) if is_swapped(first, second) else (first, second)
    kind = PAIRS.get((one.sort, other.sort))
    if kind is None and not (one.sort in SHAPES and other.sort in SHAPES):
        known = ", ".join(" and ".join(pair) for pair in ((SPHERE, PLANE), *PAIRS))
        raise contact.fault(f"found {first.sort} and {second.sort}, expected {known}, or two of {', '.join(SHAPES)}")
    units = mechanism.dataset.units
    made: dict[str, Any] = {
        "type": kind or "solid_impact",
        "i": _middle(one, contact, mechanism),
        "j": _middle(other, contact, mechanism),
        **_law(contact, units),
    }
    if kind is None:
        return made | _solid("i", one, units) | _solid("j", other, units)
    if (one.sort, other.sort) == (SPHERE, SPHERE):
        sizes = {"radius": one.sizes[0], "other_radius": other.sizes[0]}
    else:
        sizes = _sizes(one, with_sphere=False) | _sizes(other, with_sphere=one.sort == SPHERE)
    return made | {name: plain(size * units.length) for name, size in sizes.items()}


def is_swapped(first: Shape, second: Shape) -> bool:
    """Return True if the scene's element has the second shape at its marker i."""
    pairs = ((SPHERE, PLANE), *PAIRS)
    return (first.sort, second.sort) not in pairs and (second.sort, first.sort) in pairs


def _solid(end: str, shape: Shape, units: Units) -> dict[str, Any]:
    """Return shape and full dimensions at one end of a contact between two solids."""
    if shape.sort == CYLINDER:
        radius, length = shape.sizes
        whole: tuple[float, ...] = (2 * radius, 2 * radius, abs(length))
    elif shape.sort == BOX:
        whole = tuple(map(abs, shape.sizes))
    else:
        whole = tuple(2 * semi for semi in (shape.sizes if shape.sort == ELLIPSOID else 3 * shape.sizes))
    sizes = [plain(size * units.length) for size in whole]
    return {f"{end}_shape": SHAPES[shape.sort], f"{end}_size": sizes}


def _sizes(shape: Shape, with_sphere: bool) -> dict[str, float]:
    sizes = [abs(size) for size in shape.sizes]
    names: tuple[str, ...]
    if shape.sort == CYLINDER:
        names = ("cylinder_radius", "cylinder_length") if with_sphere else ("radius", "length")
    else:
        names = {SPHERE: ("radius",), PLANE: ()}.get(shape.sort, ("x", "y", "z"))
    return dict(zip(names, sizes, strict=True))


def _middle(shape: Shape, contact: Contact, mechanism: Mechanism) -> str:
    place = mechanism.place(shape.marker, contact, "the marker of GRAPHICS")
    half = {BOX: shape.sizes, CYLINDER: (0.0, 0.0, *shape.sizes[1:])}.get(shape.sort)
    if half is None:
        return place.reference
    way = place.initial.axes @ np.array(half) / 2 * mechanism.dataset.units.length
    return mechanism.moved(place, f"{place.name}_middle_of_{contact.name}", way).reference


def _law(contact: Contact, units: Units) -> dict[str, float]:
    speed, friction = units.of(length=1, time=-1), contact.friction
    law = {
        "stiffness": contact.stiffness * units.force / units.length**contact.exponent,
        "exponent": contact.exponent,
        "damping": contact.damping * units.of(force=1, length=-1, time=1),
        "depth": contact.depth * units.length,
    }
    if friction is not None:
        law |= {
            "static_friction": friction.static,
            "friction": friction.dynamic,
            "stiction_velocity": friction.stiction_velocity * speed,
            "friction_velocity": friction.friction_velocity * speed,
        }
    return {name: plain(value) for name, value in law.items()}
