"""Couplers and gears: linear equations between the displacements of joints."""

from __future__ import annotations

from typing import Any

import numpy as np

from .constraints import ROTATIONAL, TRANSLATIONAL, Coupler, Gear, Joint, Numbered
from .mechanism import Mechanism, Place
from .plain import plain
from .starts import drawn_displacement

SORTS = {"REVOLUTE": ROTATIONAL, "TRANSLATIONAL": TRANSLATIONAL}
"""Of the joints with one displacement."""


def relations(mechanism: Mechanism) -> dict[str, Any]:
    """The scene's couplers by name, of COUPLER and GEAR statements."""
    dataset = mechanism.dataset
    found = {coupler.name: _coupled(coupler, mechanism) for coupler in dataset.couplers.values()}
    return found | {gear.name: _geared(gear, mechanism) for gear in dataset.gears.values()}


def _coupled(coupler: Coupler, mechanism: Mechanism) -> dict[str, Any]:
    """Scales times displacements add up to nothing."""
    tied = [_joint(coupler, ident, mechanism) for ident in coupler.joints]
    sorts = [_sort(coupler, joint, sort) for joint, sort in zip(tied, coupler.sorts, strict=True)]
    units = [1.0 if sort == ROTATIONAL else mechanism.dataset.units.length for sort in sorts]
    scales = [scale / unit for scale, unit in zip(coupler.scales, units, strict=True)]
    return _tied(tied, sorts, [scale / scales[0] for scale in scales], mechanism)


def _geared(gear: Gear, mechanism: Mechanism) -> dict[str, Any]:
    """Two parts on one carrier have one velocity at a marker of it, along its z axis, as seen from the carrier."""
    contact = mechanism.place(gear.contact, gear, "CV")
    tied = [_joint(gear, ident, mechanism) for ident in gear.joints]
    sorts = [_sort(gear, joint, _gear_sort(joint)) for joint in tied]
    one, other = (_velocity(gear, joint, s, contact, mechanism) for joint, s in zip(tied, sorts, strict=True))
    return _tied(tied, sorts, [1.0, -other / one], mechanism)


def _gear_sort(joint: Joint) -> str | None:
    return ROTATIONAL if joint.kind == "CYLINDRICAL" else None


def _velocity(gear: Gear, joint: Joint, sort: str, contact: Place, mechanism: Mechanism) -> float:
    """The velocity of the joint's moving part at the contact, along its z axis, per unit of the joint's own rate."""
    i, j = mechanism.place(joint.i, joint, "I"), mechanism.place(joint.j, joint, "J")
    if contact.body not in (i.body, j.body):
        raise gear.fault(
            f"found the marker CV on {contact.body}, expected it on the carrier, which {joint.label} joins too"
        )
    axis = j.drawn.axes[:, 2]
    moved = axis if sort == TRANSLATIONAL else np.cross(axis, contact.drawn.point - j.drawn.point)
    along = float(moved @ contact.drawn.axes[:, 2]) * (1 if contact.body == j.body else -1)
    reach = 1.0 if sort == TRANSLATIONAL else float(np.linalg.norm(contact.drawn.point - j.drawn.point))
    if not abs(along) > 1e-9 * max(reach, 1e-9):
        raise gear.fault(
            f"found the z axis of the marker CV across the motion that {joint.label} allows there, expected it along the "
            "motion of the teeth"
        )
    return along


def _tied(tied: list[Joint], sorts: list[str], scales: list[float], mechanism: Mechanism) -> dict[str, Any]:
    """A coupler of two joints; for more an equation between their displacements, which holds as the parts are drawn."""
    if len(tied) == 2:
        first, second = (coordinate(joint, sort) for joint, sort in zip(tied, sorts, strict=True))
        return {"type": "coupler", "joint_1": first, "joint_2": second, "scale": plain(-scales[1])}
    terms, at_start = [], 0.0
    for joint, sort, scale in zip(tied, sorts, scales, strict=True):
        i, j = mechanism.place(joint.i, joint, "I"), mechanism.place(joint.j, joint, "J")
        I, J = i.reference, j.reference
        measure = f"az({I}, {J})" if sort == ROTATIONAL else f"dz({I}, {J}, {J})"
        terms.append(f"{plain(scale)!r} * {measure}")
        at_start += scale * drawn_displacement(sort, i, j)
    return {"type": "equation", "zero": " + ".join([*terms, *([repr(plain(-at_start))] if at_start else [])])}


def coordinate(joint: Joint, sort: str) -> str:
    """A displacement of a joint as the scene names it."""
    if joint.kind in SORTS:
        return joint.name
    return f"{joint.name}.{'angle' if sort == ROTATIONAL else 'displacement'}"


def _joint(user: Numbered, ident: int, mechanism: Mechanism) -> Joint:
    joint = mechanism.dataset.joints.get(ident)
    if joint is None:
        raise user.fault(f"found JOINTS = {ident}, expected the number of a JOINT")
    if joint.kind not in (*SORTS, "CYLINDRICAL"):
        raise user.fault(f"found {joint.label}, {joint.kind}, expected a revolute, translational or cylindrical joint")
    return joint


def _sort(user: Numbered, joint: Joint, sort: str | None) -> str:
    """Which displacement of a joint is meant."""
    own = SORTS.get(joint.kind, sort)
    if own is None or (sort is not None and sort != own):
        raise user.fault(f"found {sort or 'no TYPE'} of {joint.label}, {joint.kind}, expected {own or 'T or R'}")
    return own
