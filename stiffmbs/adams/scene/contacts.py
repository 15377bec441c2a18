"""Contacts between spheres and planes as formula forces.  MSC Adams/Solver, CONTACT: IMPACT, and Coulomb friction.

The force acts at the point of contact. The normal force is applied at the sphere's centre. Friction adds a torque about
that centre, with the opposite torque on the other body.
"""

from __future__ import annotations

from typing import Any

from ..functions.translate import Translation
from ..statements.contact import PLANE, SPHERE, Contact, Friction, Shape, read_shape
from ..statements.fault import of_each
from .forces import TORQUE
from .friction import SLOW
from .mechanism import Mechanism
from .solids import between_solids, is_swapped


def contacts(mechanism: Mechanism, translation: Translation) -> dict[str, Any]:
    """Return the forces of all contacts by name."""
    pairs = [pair for contact in mechanism.dataset.contacts.values() for pair in contact.pairs()]
    return of_each(pairs, lambda contact: _made(contact, mechanism, translation))


def _made(contact: Contact, mechanism: Mechanism, translation: Translation) -> dict[str, Any]:
    first, second = (_shape(contact, ident, mechanism) for ident in contact.shapes)
    if (first.sort, second.sort) == (SPHERE, SPHERE) and not contact.friction:
        return _of_spheres(contact, first, second, mechanism, translation)
    if {first.sort, second.sort} == {SPHERE, PLANE}:
        sphere, plane = (first, second) if first.sort == SPHERE else (second, first)
        return _on_plane(contact, sphere, plane, mechanism, translation)
    return {contact.name: between_solids(contact, first, second, mechanism)}


def swapped(contact: Contact, mechanism: Mechanism) -> bool:
    """Return True if the scene's force acts on the part of JGEOM."""
    if contact.others:
        raise contact.fault(
            "found a function of its force and several geometries on a side, expected one GRAPHICS on each side"
        )
    first, second = (_shape(contact, ident, mechanism) for ident in contact.shapes)
    return is_swapped(first, second)


def _shape(contact: Contact, ident: int, mechanism: Mechanism) -> Shape:
    statement = mechanism.dataset.graphics.get(ident)
    if statement is None:
        raise contact.fault(f"found the geometry {ident}, expected the number of a GRAPHICS")
    return read_shape(statement)


def _impact(contact: Contact, gap: str, rate: str) -> str:
    return (
        f"IMPACT({gap}, {rate}, 0, {contact.stiffness!r}, {contact.exponent!r}, {contact.damping!r}, {contact.depth!r})"
    )


def _of_spheres(
    contact: Contact, one: Shape, other: Shape, mechanism: Mechanism, translation: Translation
) -> dict[str, Any]:
    i, j = (mechanism.place(shape.marker, contact, "CM").reference for shape in (one, other))
    ends = f"({one.marker}, {other.marker})"
    law = _impact(contact, f"DM{ends} - {one.sizes[0] + other.sizes[0]!r}", f"VR{ends}")
    force = translation.law(law, contact)
    return {contact.name: {"type": "line_force", "i": i, "j": j, "force": force}}


def _on_plane(
    contact: Contact, sphere: Shape, plane: Shape, mechanism: Mechanism, translation: Translation
) -> dict[str, Any]:
    """Return the force in the axes of the plane's marker, whose z axis is the outward normal."""
    center, other = mechanism.place(sphere.marker, contact, "CM"), mechanism.place(plane.marker, contact, "RM")
    i, j, r = sphere.marker, plane.marker, sphere.sizes[0]
    normal = _impact(contact, f"DZ({i},{j},{j}) - {r!r}", f"VZ({i},{j},{j},{j})")
    ends: dict[str, Any] = {"i": center.reference, "j": other.body, "frame": other.reference}
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
    speed = f"SQRT({x}**2 + {y}**2 + {(SLOW * slow) ** 2!r})"
    mu = (
        f"(STEP({speed}, {-slow!r}, {-friction.static!r}, {slow!r}, {friction.static!r}) + "
        f"STEP({speed}, {slow!r}, 0, {fast!r}, {friction.dynamic - friction.static!r}))"
    )
    return f"(-{mu}*{normal}/{speed})"
