"""Conversion of parts to bodies."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from ...elements.spatial.massless import MASSLESS, breaks_triangle, filled, lacks_inertia, massless_moment
from ...elements.spatial.number_format import plain, quaternion, vector
from ..statements.bodies import Marker, Part
from ..statements.geometry import IDENTITY, Frame
from .initial_conditions import in_ground
from .mechanism import Mechanism


def bodies(mechanism: Mechanism) -> dict[str, object]:
    """Return the bodies of the scene by name, with their markers."""
    return {part.name: _body(mechanism, part) for part in mechanism.moving}


def ground_markers(mechanism: Mechanism) -> dict[str, object]:
    """Return the markers of the scene's ground."""
    return {
        name: placement
        for part in mechanism.parts.values()
        if part.ground
        for name, placement in _markers(mechanism, part)
    }


def _body(mechanism: Mechanism, part: Part) -> dict[str, object]:
    initial = mechanism.center(part).within(part.frame)
    body: dict[str, object] = {
        "mass": plain(part.mass),
        **({"any_moments": True} if _breaks_triangle(mechanism, part) else {}),
        "inertia": _inertia(mechanism, part),
        **_pose("position", initial),
    }
    if part.velocity is not None:
        body["velocity"] = vector(in_ground(mechanism, part, part.velocity, part.velocity_marker, IDENTITY))
    if part.omega is not None:
        omega = in_ground(mechanism, part, part.omega, part.omega_marker, initial.axes)
        body["omega"] = vector(initial.axes.T @ omega)
    if mechanism.moves_at_start:
        body |= _left_open(part)
    markers = dict(_markers(mechanism, part))
    return body | ({"markers": markers} if markers else {})


def _left_open(part: Part) -> dict[str, object]:
    """Return the unspecified velocities of a part, which Adams treats as free."""
    rates = {"velocity": part.velocity, "omega": part.omega}
    names = [name for name, rate in rates.items() if rate is None]
    return {"open": names} if names else {}


def _pose(point: str, frame: Frame) -> dict[str, object]:
    """Return the position of a frame, and its orientation unless it is the identity."""
    turned = {} if np.array_equal(frame.axes, IDENTITY) else {"orientation": quaternion(frame.axes)}
    return {point: vector(frame.point), **turned}


def _markers(mechanism: Mechanism, part: Part) -> list[tuple[str, dict[str, object]]]:
    own: list[Marker] = [m for m in mechanism.dataset.markers.values() if mechanism.part_of(m) is part]
    places = [mechanism.placed(marker) for marker in own if not marker.floating]
    places += [place for place in mechanism.further.values() if place.body == part.name]
    return [(place.name, _pose("point", place.on_body)) for place in places]


def _inertia(mechanism: Mechanism, part: Part) -> list[Any]:
    """Return the inertia about the centre of mass in the axes of its marker; small moments if the part has none."""
    if part.point:
        return vector([part.mass] * 3)  # its orientation is held: the value has no effect
    tensor = _tensor(mechanism, part)
    if lacks_inertia(tensor):
        places = (mechanism.placed(marker).initial.point for marker in mechanism.dataset.markers.values())
        tensor = filled(tensor, massless_moment(mechanism.least, places))
    _check(part, tensor)
    if np.array_equal(tensor, np.diag(np.diag(tensor))):
        return vector(np.diag(tensor))
    return [vector(row) for row in (tensor + tensor.T) / 2]


def notes(mechanism: Mechanism) -> Iterator[str]:
    """Yield one sentence each for parts with added inertia and with impossible moments of inertia."""
    lacking = [p.label for p in mechanism.moving if not p.point and lacks_inertia(_tensor(mechanism, p))]
    if lacking:
        yield (
            f"{', '.join(lacking)} {'have' if len(lacking) > 1 else 'has'} no moment of inertia about some axis, set to "
            f"{MASSLESS:g} m L^2 with the mass m of the lightest part and the extent L of the markers"
        )
    unreal = [p.label for p in mechanism.moving if _breaks_triangle(mechanism, p)]
    if unreal:
        yield (
            f"warning: {', '.join(unreal)} {'have' if len(unreal) > 1 else 'has'} a principal moment of inertia greater than "
            "the sum of the other two, which no body has; it is used unchanged"
        )


def _tensor(mechanism: Mechanism, part: Part) -> np.ndarray:
    """Return the inertia tensor about the centre of mass, in the axes of its marker.

    A dataset's products of inertia are positive integrals of xy, xz and yz, and the moments are about the origin of the
    inertia marker. The products are negated, and m (d^2 - d d^T) is subtracted, d from the centre of mass to that
    origin.
    """
    xx, yy, zz, xy, xz, yz = part.moments
    tensor = np.array([[xx, -xy, -xz], [-xy, yy, -yz], [-xz, -yz, zz]])
    if part.inertia_marker is not None and part.inertia_marker != part.center:
        marker = mechanism.dataset.markers[part.inertia_marker].frame.seen_from(mechanism.center(part))
        d = marker.point
        with np.errstate(all="ignore"):
            tensor = marker.axes @ tensor @ marker.axes.T - part.mass * (d @ d * IDENTITY - np.outer(d, d))
    if not np.all(np.isfinite(tensor)):
        raise part.fault("found moments of inertia about CM above 1e308 kg m^2, expected finite values")
    return tensor


def _breaks_triangle(mechanism: Mechanism, part: Part) -> bool:
    """Return True if a principal moment exceeds the sum of the other two beyond rounding."""
    tensor = _tensor(mechanism, part)
    return not (part.point or lacks_inertia(tensor)) and breaks_triangle(tensor)


def _check(part: Part, tensor: np.ndarray) -> None:
    small, middle, large = np.linalg.eigvalsh(tensor)
    if small <= 0:
        raise part.fault(
            f"found principal moments of inertia {small:.4g}, {middle:.4g} and {large:.4g} kg m^2, expected three above zero"
        )
