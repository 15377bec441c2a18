"""Rack and pinion: equal velocity where the pitch line of the rack touches the pinion.

Marker I is on the pinion with z along its axis; marker J is on the rack with z along the teeth. The pitch line is half
the pitch diameter from the axis, on the side where the rack is drawn. If the rack is drawn through the axis, it is at
-y of marker I, whose x is along the rack (MSC Adams, constraint modify joint rackpin).
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..statements.constraints import Joint
from ..statements.geometry import PRECISION, ROUNDING
from .gears import meshed
from .mechanism import Mechanism, Place

ACROSS = 1e-3
"""Distance from the pinion's axis below which a rack's line passes through it, and from the pitch line above which it is
reported, relative to the pitch radius."""
SKEWED = 0.1
"""Cosine of the angle between z of marker I and the rack above which z is not the pinion's axis."""


def rolling(joint: Joint, mechanism: Mechanism) -> dict[str, object]:
    """Return the tooth constraint, whose force acts on the pinion at the pitch line.

    If one carrier has the pinion on a hinge and the rack on a guide, it is the position-level constraint of a gear.
    Raises DatasetFault if neither the rack's position nor marker I defines the side of the pinion.
    """
    i, j = mechanism.ends(joint)
    outward = _outward(joint, i, j)
    off = joint.diameter / 2 - float(_offset(i, j) @ outward)
    carried = _carried(joint, i, j, mechanism)
    if carried is not None:
        hinge, guide, seat = carried
        along, line = j.initial.axes[:, 2], j.initial.point + off * outward
        touched = line + ((i.initial.point - line) @ along) * along
        contact = mechanism.moved(seat, f"{seat.name}_teeth_{joint.ident}", touched - seat.initial.point)
        return meshed(joint, (hinge.ident, guide.ident), contact, mechanism) | {"i": i.reference, "j": j.reference}
    line_marker = (
        mechanism.moved(j, f"{j.name}_pitch", off * outward) if abs(off) > ROUNDING * abs(joint.diameter) else j
    )
    I, J = i.reference, line_marker.reference
    turning = f"(wx({I}, ground, {J}) * dy({J}, {I}, {J}) - wy({I}, ground, {J}) * dx({J}, {I}, {J}))"
    return {
        "type": "velocity_equation", "i": I, "j": j.reference, "zero": f"vz({J}, {I}, {J}) - {turning}",
    }  # fmt: skip


def _carried(joint: Joint, i: Place, j: Place, mechanism: Mechanism) -> tuple[Joint, Joint, Place] | None:
    """Return the pinion's hinge and the rack's guide on one carrier, and the guide's carrier marker, or None."""
    hinges = {
        seat.body: other
        for other, own, seat in _joints_of(i.body, "REVOLUTE", mechanism)
        if _alike(own.initial.axes[:, 2], i.initial.axes[:, 2])
    }
    for guide, own, seat in _joints_of(j.body, "TRANSLATIONAL", mechanism):
        if seat.body in hinges and _alike(own.initial.axes[:, 2], j.initial.axes[:, 2]):
            return hinges[seat.body], guide, seat
    return None


def _alike(one: np.ndarray, other: np.ndarray) -> bool:
    return bool(np.linalg.norm(np.cross(one, other)) < PRECISION)


def _joints_of(body: str, kind: str, mechanism: Mechanism) -> Iterator[tuple[Joint, Place, Place]]:
    """Yield the joints of a kind on a body, with their markers on it and on the other body."""
    for joint in mechanism.dataset.joints.values():
        if joint.kind == kind:
            ends = mechanism.ends(joint)
            for own, seat in (ends, ends[::-1]):
                if own.body == body:
                    yield joint, own, seat


def _axis(i: Place, j: Place) -> np.ndarray | None:
    """Return the pinion's axis normal to the rack; None if z of marker I is not the pinion's axis."""
    along, axis = j.initial.axes[:, 2], i.initial.axes[:, 2]
    if abs(along @ axis) > SKEWED:
        return None
    axis = axis - (along @ axis) * along
    return np.asarray(axis / np.linalg.norm(axis))


def _offset(i: Place, j: Place) -> np.ndarray:
    """Return the common normal from the pinion's axis to the rack's line, m; from marker I if the axis is unknown."""
    along, axis, gap = j.initial.axes[:, 2], _axis(i, j), j.initial.point - i.initial.point
    gap = gap - (gap @ along) * along
    return np.asarray(gap if axis is None else gap - (gap @ axis) * axis)


def _crosses(joint: Joint, gap: np.ndarray) -> bool:
    return bool(np.linalg.norm(gap) <= ACROSS * abs(joint.diameter) / 2)


def _outward(joint: Joint, i: Place, j: Place) -> np.ndarray:
    """Return the unit vector from the pinion's axis to the rack."""
    gap = _offset(i, j)
    if not _crosses(joint, gap):
        return np.asarray(gap / np.linalg.norm(gap))
    axis, along = _axis(i, j), float(i.initial.axes[:, 0] @ j.initial.axes[:, 2])
    if axis is None or abs(along) < 0.5:
        raise joint.fault(
            "found the rack's line (z of J) across the pinion's axis (z of I) and not along x of I, "
            "expected it half the pitch diameter from the axis, or along x of I"
        )
    return -np.sign(along) * np.cross(axis, j.initial.axes[:, 2])


def notes(mechanism: Mechanism) -> Iterator[str]:
    """Yield one sentence for each assumption about a rack."""
    for joint in mechanism.dataset.joints.values():
        if joint.kind != "RACKPIN":
            continue
        i, j = mechanism.ends(joint)
        gap, radius = _offset(i, j), abs(joint.diameter) / 2
        distance = float(np.linalg.norm(gap))
        if _crosses(joint, gap):
            yield (
                f"{joint.label}: the rack's line passes through the pinion's axis; the pitch line is assumed half the pitch diameter "
                f"from it, at -y of MARKER/{joint.i}"
            )
        elif abs(distance - radius) > ACROSS * radius:
            yield (
                f"{joint.label}: the rack's line is drawn {distance:.6g} m from the pinion's axis; the pitch line is assumed "
                f"{radius:.6g} m from it, half of PD"
            )
