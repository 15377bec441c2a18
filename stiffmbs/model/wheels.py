"""Wheels of a described vehicle: their carriers, sides and axles, the joints that may steer, and the connected bodies."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..elements.element import Element, Joint
from ..elements.spatial.marker import Marker
from ..elements.spatial.tyre import Tyre
from ..errors import InputError
from ..reading.did_you_mean import did_you_mean
from ..reading.marker import GROUND, MarkerReference
from .model_data import ModelData

ALONG = 0.1
"""Limit for two wheels on one axle: offset of one from the axis of the other, relative to the distance along it. The cosine
of the angle between their axes differs from 1 by less than the limit too."""
NAMED = 3
"""Number of coefficients in a note."""
ON_MIDDLE_PLANE = 1e-6
"""Largest distance from the middle plane of a wheel that is on neither side, m."""


@dataclass(frozen=True, eq=False)
class Wheel:
    """Wheel as described, in ground axes. Sides and contacts are those of a vehicle along x, with z up."""

    centre: np.ndarray  # shape (3,): centre of the wheel, m
    axis: np.ndarray  # shape (3,): unit vector along its axis, to the left of its heading
    side: str  # ``left``, ``right``, or ``wheel`` for one in the middle, such as that of a motorcycle
    body: str = ""  # wheel body; empty if it is not known
    hubs: tuple[str, ...] = ()  # revolute joints of that body
    carriers: tuple[str, ...] = ()  # bodies on which the wheel rotates; none without a hub
    tyre: str = ""  # tyre, if it has one
    suspension: str = ""  # prefix of the names of the suspension's elements; empty if they have none
    radius: float | None = None  # m; None if it is not known
    patch: np.ndarray | None = None  # shape (3,): described contact with the road, m

    @property
    def carrier(self) -> str:
        """Body that holds the bearing of the wheel, or has its tyre."""
        return self.carriers[0] if self.carriers else self.body

    @property
    def sign(self) -> float:
        """1 on the left, -1 on the right: outwards is this times y."""
        return -1.0 if self.side == "right" else 1.0

    @cached_property
    def contact(self) -> np.ndarray:
        """Centre of the contact with the road, m, as described, or below the centre in the plane of the wheel."""
        if self.patch is not None:
            return self.patch
        if self.radius is None:
            raise InputError(
                f"bodies.{self.body}: found no tyre with a radius, expected the radius of the wheel as an option"
            )
        up = np.array([0.0, 0.0, 1.0]) - self.axis[2] * self.axis
        return np.asarray(self.centre - self.radius * up / np.linalg.norm(up))

    def on_axle_of(self, other: Wheel) -> bool:
        """Return True if both wheels are on one axle across x, or are one."""
        x, y = np.abs(self.centre - other.centre)[:2]
        return bool(x <= max(ALONG * y, ON_MIDDLE_PLANE))

    def to_the_left_of(self, other: Wheel) -> float:
        """Return the distance along the axle of the other wheel, of any heading, m; 0 if they are not on one axle."""
        between = self.centre - other.centre
        along = float(between @ other.axis)
        aside = np.linalg.norm(between - along * other.axis)
        return along if self.axis @ other.axis > 1 - ALONG and aside < ALONG * abs(along) else 0.0


def wheels_of(model: ModelData) -> tuple[Wheel, ...]:
    """Return the wheels of a model in space that have tyres, in the order of these."""
    return tuple(wheel_of(model, tyre.i.body, name) for name, tyre in tyres_of(model).items())


def tyres_of(model: ModelData) -> dict[str, Tyre]:
    """Return the tyres of a model in space by name."""
    return {name: force for name, force in model.forces.items() if isinstance(force, Tyre)}


def wheel_of(model: ModelData, body: str, tyre: str = "") -> Wheel:
    """Return the wheel that is a body with a tyre or a hub; raise an InputError if it has neither.

    `tyre`: name of its tyre, by default the first one on the body.
    """
    if body not in model.bodies:
        raise InputError(f"found no body '{body}'{did_you_mean(body, model.bodies)}, expected the body of a wheel")
    tyres = tyres_of(model)
    tyre = tyre or next((name for name, one in tyres.items() if one.i.body == body), "")
    hubs = {name: joint for name, joint in model.joints.items() if _turns(joint, body)}
    ends = [(joint.i, joint.j) if joint.i.body == body else (joint.j, joint.i) for joint in hubs.values()]
    if not tyre and not hubs:
        raise InputError(f"bodies.{body}: found 0 revolute joints (none), expected one, the hub of the wheel")
    held = model.initial_marker(tyres[tyre].i if tyre else ends[0][0])
    axis = held.axes[:, 1] if tyre else held.axes[:, 2] * (1.0 if held.axes[1, 2] >= 0 else -1.0)
    centre = np.array(held.point)
    return Wheel(
        centre, axis, side_of(centre), body, tuple(hubs), tuple(dict.fromkeys(other.body for _, other in ends)), tyre,
        radius=radius_of(tyres[tyre]) if tyre else None,
    )  # fmt: skip


def side_of(centre: np.ndarray) -> str:
    """Return the side of a wheel of a vehicle along x."""
    return "wheel" if abs(centre[1]) < ON_MIDDLE_PLANE else "left" if centre[1] > 0 else "right"


def _turns(joint: Joint, body: str) -> bool:
    return joint.kind == "revolute" and body in (joint.i.body, joint.j.body)  # type: ignore[attr-defined]


def marked_wheel(model: ModelData, carrier: str, prefix: str = "") -> Wheel:
    """Return the wheel at the markers ``spindle`` and ``patch`` of its carrier, as shipped parts have them.

    `prefix`: beginning of the names of the markers. Raises InputError if a marker is missing.
    """
    for name in ("spindle", "patch"):
        if f"{prefix}{name}" not in model.bodies[carrier].markers:
            raise InputError(f"bodies.{carrier}: found no marker '{prefix}{name}', expected it where the wheel is held")
    return _at_markers(model, carrier, prefix)


def _at_markers(model: ModelData, carrier: str, prefix: str) -> Wheel:
    """Return the wheel with a marker ``patch``, which is in the place of ``spindle`` too where that is missing."""
    patch = model.initial_marker(Marker(body=carrier, marker=f"{prefix}patch"))
    has_spindle = f"{prefix}spindle" in model.bodies[carrier].markers
    spindle = model.initial_marker(Marker(body=carrier, marker=f"{prefix}spindle")) if has_spindle else patch
    centre = np.array(spindle.point)
    return Wheel(centre, spindle.axes[:, 1], side_of(centre), carriers=(carrier,), patch=np.array(patch.point))


def marked_or_tyred(model: ModelData) -> tuple[Wheel, ...]:
    """Return all wheels of a model in space: those at markers of their carriers, and others with tyres."""
    places = [(body, marker) for body, one in model.bodies.items() for marker in one.markers]
    marked = [_at_markers(model, body, name[: -len("patch")]) for body, name in places if name.endswith("patch")]
    known = {wheel.carrier for wheel in marked}
    return (*marked, *(wheel for wheel in wheels_of(model) if wheel.carrier not in known))


def axle_at(wheels: Sequence[Wheel], end: str) -> list[Wheel]:
    """Return the wheels of the ``front`` or ``rear`` axle of a vehicle along x."""
    sign = 1.0 if end == "front" else -1.0
    outermost = max(wheels, key=lambda wheel: float(sign * wheel.centre[0]))
    return [wheel for wheel in wheels if wheel.on_axle_of(outermost)]


def corners(wheels: Sequence[Wheel]) -> dict[str, Wheel]:
    """Return the wheels of a car along x by corner: ``front_left`` ... ``rear_right``.

    Raises InputError if they are not two on each of two axles.
    """
    if len(wheels) != 4:
        names = ", ".join(wheel.tyre for wheel in wheels)
        raise InputError(f"found {len(wheels)} tyres ({names or 'none'}), expected the 4 of a car")
    axles = {end: axle_at(wheels, end) for end in ("front", "rear")}
    for end, axle in axles.items():
        if len(axle) != 2:
            names = ", ".join(wheel.tyre for wheel in axle)
            raise InputError(f"found {len(axle)} tyres on the {end} axle ({names}), expected 2 next to each other")
    return {
        f"{end}_{side}": wheel
        for end, axle in axles.items()
        for side, wheel in zip(("left", "right"), sorted(axle, key=lambda wheel: -wheel.centre[1]), strict=True)
    }


def radius_of(tyre: object) -> float | None:
    """Return the unloaded radius of a tyre, m, from its field or its property file."""
    return getattr(tyre, "radius", None) or coefficient(tyre, "UNLOADED_RADIUS")


def coefficient(tyre: object, name: str) -> float | None:
    """Return a coefficient of the property file of a tyre, SI units."""
    properties = getattr(tyre, "properties", None)
    found = getattr(properties, "coefficients", properties)
    value = found.get(name) if isinstance(found, Mapping) else getattr(found, name, None)
    return float(value) if isinstance(value, float | int) else None


def mounted_alike(model: ModelData) -> Iterator[str]:
    """Yield notes on axles whose outer tyres have the same hand, although left and right tyres differ."""
    tyres = tyres_of(model)
    wheels = wheels_of(model)
    for right in wheels:
        distances = [right.to_the_left_of(other) for other in wheels]
        if not any(distances) or max(distances) > 0:
            continue  # not the rightmost one of an axle
        left = wheels[int(np.argmin(distances))]
        data, hand, differing = tyres[right.tyre].mounted_side()
        if differing and (data, hand) == tyres[left.tyre].mounted_side()[:2]:
            names = ", ".join(differing[:NAMED]) + (" and others" if len(differing) > NAMED else "")
            yield (
                f"{left.tyre} and {right.tyre} are on both sides of an axle and not mirrored to each other: side forces of "
                f"ply steer and conicity ({names}) add up; hand: -1 mirrors one of them"
            )


def angular_of_joints(model: ModelData) -> dict[str, bool]:
    """Return the joints that may steer, by name: prismatic ones, and revolute ones with True."""
    kinds = {name: joint.kind for name, joint in model.joints.items()}
    return {name: kind == "revolute" for name, kind in kinds.items() if kind in ("prismatic", "revolute")}


def bodies_at(element: Element) -> Iterator[str]:
    """Yield the bodies that an element names."""
    yield from (marker.body for _, marker in element.parts(MarkerReference))
    yield from (marker.body for _, marker in element.markers())


def connected(bodies: Sequence[str], elements: Iterable[Element], without: set[str]) -> set[str]:
    """Return bodies with all those that elements connect to them, except through the bodies `without`."""
    ends = [set(bodies_at(each)) - without for each in elements]
    found, larger = set[str](), set(bodies)
    while larger != found:
        found = larger
        larger = found.union(*(each for each in ends if each & found))
    return found


def centre_of_mass(model: ModelData, body: str) -> np.ndarray:
    """Return the centre of mass of a described vehicle, m: of the bodies that joints and forces connect, except by ground."""
    found = connected([body], (*model.joints.values(), *model.forces.values()), {GROUND})
    bodies = [each for name, each in model.bodies.items() if name in found]
    masses, places = np.array([each.mass for each in bodies]), np.array([each.coordinates()[:3] for each in bodies])
    return np.asarray(masses @ places / masses.sum())
