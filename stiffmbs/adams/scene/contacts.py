"""Contacts of spheres, planes, cylinders, boxes and ellipsoids.  MSC Adams/Solver, CONTACT: IMPACT, and Coulomb friction.

The force acts at the point of contact. The normal force is applied at the sphere's centre. Friction adds a torque about
that centre, with the opposite torque on the other body.
"""

from __future__ import annotations

import numpy as np

from ...elements.forces.friction import AT_REST
from ...elements.spatial.number_format import plain
from ..functions.translate import Translation
from ..statements.contact import BOX, CYLINDER, ELLIPSOID, PLANE, SPHERE, Contact, Friction, Shape, read_shape
from ..statements.text import DatasetFault, of_each
from ..statements.units import Units
from .forces import TORQUE
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


def between_solids(contact: Contact, first: Shape, second: Shape, mechanism: Mechanism) -> dict[str, object]:
    """Return the element of a contact. Raises DatasetFault if no element supports this pair of shapes."""
    one, other = (second, first) if is_swapped(first, second) else (first, second)
    kind = PAIRS.get((one.sort, other.sort))
    if kind is None and not (one.sort in SHAPES and other.sort in SHAPES):
        known = ", ".join(" and ".join(pair) for pair in ((SPHERE, PLANE), *PAIRS))
        raise contact.fault(f"found {first.sort} and {second.sort}, expected {known}, or two of {', '.join(SHAPES)}")
    units = mechanism.dataset.units
    made: dict[str, object] = {
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


def _solid(end: str, shape: Shape, units: Units) -> dict[str, object]:
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
    offset = place.initial.axes @ np.array(half) / 2 * mechanism.dataset.units.length
    return mechanism.moved(place, f"{place.name}_middle_of_{contact.name}", offset).reference


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


def contacts(translation: Translation) -> dict[str, object]:
    """Return the forces of all contacts by name."""
    pairs = [pair for contact in translation.mechanism.dataset.contacts.values() for pair in contact.of_pairs()]
    return of_each(pairs, lambda contact: _made(contact, translation))


def _made(contact: Contact, translation: Translation) -> dict[str, object]:
    first, second = (_shape(contact, ident, translation.mechanism) for ident in contact.pairs[0])
    if (first.sort, second.sort) == (SPHERE, SPHERE) and not contact.friction:
        return _of_spheres(contact, first, second, translation)
    if {first.sort, second.sort} == {SPHERE, PLANE}:
        sphere, plane = sorted((first, second), key=lambda shape: shape.sort == PLANE)
        return _on_plane(contact, sphere, plane, translation)
    return {contact.name: between_solids(contact, first, second, translation.mechanism)}


def swapped(contact: Contact, mechanism: Mechanism) -> bool:
    """Return True if the scene's force acts on the part of JGEOM."""
    if len(contact.pairs) > 1:
        raise contact.fault(
            "found a function of its force and several geometries on a side, expected one GRAPHICS on each side"
        )
    first, second = (_shape(contact, ident, mechanism) for ident in contact.pairs[0])
    return is_swapped(first, second)


def _shape(contact: Contact, ident: int, mechanism: Mechanism) -> Shape:
    statement = mechanism.dataset.graphics.get(ident)
    if statement is None:
        raise contact.fault(f"found the geometry {ident}, expected the number of a GRAPHICS")
    try:
        return read_shape(statement)
    except DatasetFault as fault:
        raise DatasetFault(fault.line, fault.label, f"{fault.reason} (used by {contact.label})") from None


def _impact(contact: Contact, gap: str, rate: str) -> str:
    return (
        f"IMPACT({gap}, {rate}, 0, {contact.stiffness!r}, {contact.exponent!r}, {contact.damping!r}, {contact.depth!r})"
    )


def _of_spheres(contact: Contact, one: Shape, other: Shape, translation: Translation) -> dict[str, object]:
    i, j = (translation.mechanism.place(shape.marker, contact, "CM").reference for shape in (one, other))
    ends = f"({one.marker}, {other.marker})"
    law = _impact(contact, f"DM{ends} - {one.sizes[0] + other.sizes[0]!r}", f"VR{ends}")
    force = translation.law(law, contact)
    return {contact.name: {"type": "line_force", "i": i, "j": j, "force": force}}


def _on_plane(contact: Contact, sphere: Shape, plane: Shape, translation: Translation) -> dict[str, object]:
    """Return the force in the axes of the plane's marker, whose z axis is the outward normal."""
    place = translation.mechanism.place
    center, other = place(sphere.marker, contact, "CM"), place(plane.marker, contact, "RM")
    i, j, r = sphere.marker, plane.marker, sphere.sizes[0]
    normal = _impact(contact, f"DZ({i},{j},{j}) - {r!r}", f"VZ({i},{j},{j},{j})")
    ends: dict[str, object] = {"i": center.reference, "j": other.body, "frame": other.reference}
    if contact.friction is None:
        force = [0, 0, translation.law(normal, contact)]
        return {contact.name: {"type": "force", **ends, "force": force}}
    x = f"(VX({i},{j},{j},{j}) - {r!r}*(WY({i},{j},{j})))"
    y = f"(VY({i},{j},{j},{j}) + {r!r}*(WX({i},{j},{j})))"
    drag = _drag(contact.friction, x, y, normal)
    force = [translation.law(law, contact) for law in (f"{drag}*{x}", f"{drag}*{y}", normal)]
    torque = [translation.law(law, contact, arm=1) for law in (f"{r!r}*{drag}*{y}", f"-{r!r}*{drag}*{x}")]
    return {
        contact.name: {"type": "force", **ends, "force": force},
        contact.name + TORQUE: {"type": "torque", **ends, "torque": [*torque, 0]},
    }


def _drag(friction: Friction, x: str, y: str, normal: str) -> str:
    """Return -mu N divided by the sliding speed."""
    slow, fast = friction.stiction_velocity, friction.friction_velocity
    speed = f"SQRT({x}**2 + {y}**2 + {(AT_REST * slow) ** 2!r})"
    mu = (
        f"(STEP({speed}, {-slow!r}, {-friction.static!r}, {slow!r}, {friction.static!r}) + "
        f"STEP({speed}, {slow!r}, 0, {fast!r}, {friction.dynamic - friction.static!r}))"
    )
    return f"(-{mu}*{normal}/{speed})"
