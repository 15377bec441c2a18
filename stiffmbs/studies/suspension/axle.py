"""Axle on the rig: its wheels by the names of shipped parts or by the tyres of any scene, and the body to clamp."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from numbers import Real

import numpy as np

from ...elements.element import Element
from ...elements.joints.drive import Drive
from ...elements.spatial.tyre import Tyre
from ...errors import InputError
from ...model.model_data import ModelData
from ...model.wheels import (
    Wheel,
    angular_of_joints,
    axle_at,
    bodies_at,
    connected,
    marked_wheel,
    side_of,
    wheel_of,
    wheels_of,
)
from ...reading.did_you_mean import did_you_mean, instead_of
from ...reading.formula.formula import Formula
from ...reading.marker import GROUND


def bodies_of(scene: ModelData, body: str, carriers: Sequence[str]) -> set[str]:
    """Return the bodies connected to the carriers of the wheels other than through the clamped body, and that body."""
    elements = (each for each in (*scene.joints.values(), *scene.forces.values()) if not depends_on_more(each))
    return connected(carriers, elements, {body, GROUND}) | ({body} - {GROUND})


def depends_on_more(element: Element) -> bool:
    """Return True if an element is a drive, or has a formula with states or inputs, which the rig lacks."""
    return isinstance(element, Drive) or any(formula.states for _, formula in element.parts(Formula))


def stays(element: Element, bodies: frozenset[str]) -> bool:
    """Return True if an element belongs on the rig: no tyre, and attached only to bodies of the axle and ground."""
    if isinstance(element, Tyre) or depends_on_more(element):
        return False
    return set(bodies_at(element)) <= bodies | {GROUND}


SIDES = ("left", "right")
STEERING = {"guide": False, "steering": True}
"""Last names of the joints that steer unless one is named; True if they rotate."""
AXIS_ALONG_Y = 0.7
"""Smallest component along y of a wheel's axis as described; x is forward on the rig (ISO 8855)."""


@dataclass(frozen=True)
class Axle:
    """Parts of a scene that form an axle."""

    name: str  # name of the axle
    wheels: tuple[Wheel, ...]  # one or two, left first
    body: str  # body that carries them; ground if they stand on it
    steering: str | None = None  # prismatic or revolute joint whose travel steers
    angular: bool = False  # True if that joint rotates
    bodies: frozenset[str] = frozenset()  # bodies of the suspensions, with `body`

    @property
    def title(self) -> str:
        """Names of the suspensions."""
        return " and ".join(wheel.suspension or wheel.body or wheel.side for wheel in self.wheels)

    @property
    def solid(self) -> bool:
        """True if both wheels rotate on one body: a solid axle."""
        return len(self.wheels) == 2 and self.wheels[0].carrier == self.wheels[1].carrier


def axle_of(
    model: ModelData,
    name: str,
    body: str | None = None,
    steering: str | None = None,
    wheels: Sequence[str] = (),
    radius: float | None = None,
) -> Axle:
    """Return an axle of a scene; raise an InputError if a suspension, its markers or a named part is missing.

    `name`: prefix of the suspensions ``name.left`` and ``name.right`` or of ``name.upright``; if empty, the suspensions
    are ``left`` and ``right``. Without such bodies it is ``front`` or ``rear`` for the foremost and the last tyres, or
    the beginning of the names of the tyres or of their wheels. `body`: body to clamp; by default ``chassis``, or else
    the body to which most elements of the axle are attached. `steering`: joint that steers; by default the only
    prismatic ``guide`` or revolute ``steering`` of the axle, if any. `wheels`: bodies of the wheels, instead of the
    search by `name`. `radius`: distance from the centres of the wheels to the road, m; by default that of the markers,
    or of the tyres.
    """
    start = f"{name}." if name else ""
    if radius is not None and not (isinstance(radius, Real) and 0 < radius < np.inf):
        raise InputError(f"radius: found {radius!r}, expected a length above zero, m")
    if wheels:
        found = tuple(_on_hub(wheel_of(model, each), radius) for each in wheels)
    else:
        found = _named(model, name, start) or _with_tyres(model, name, radius)
    _check(found, name)
    body = body or _clamped(model, name, start, found)
    if body != GROUND and body not in model.bodies:
        near = did_you_mean(body, model.bodies)
        raise InputError(f"found no body '{body}'{near} to clamp, expected one of {', '.join(model.bodies)}")
    axle = Axle(name, tuple(sorted(found, key=lambda wheel: wheel.side == "right")), body)
    axle = replace(axle, bodies=frozenset(bodies_of(model, body, [wheel.carrier for wheel in found])))
    joint = _steering(model, steering, axle.bodies)
    return replace(axle, steering=joint, angular=joint is not None and angular_of_joints(model)[joint])


def _named(model: ModelData, name: str, start: str) -> tuple[Wheel, ...]:
    """Return the wheels on ``axle`` or ``upright`` bodies with the markers of shipped parts; none without such bodies."""
    found = []
    for side in SIDES:
        suspension = f"{start}{side}"
        if f"{suspension}.upright" in model.bodies:
            wheel = marked_wheel(model, f"{suspension}.upright")
        elif f"{start}axle" in model.bodies:
            wheel = marked_wheel(model, f"{start}axle", f"{side}_")
        else:
            continue
        found.append(replace(wheel, side=side, suspension=suspension))
    if not found and f"{start}upright" in model.bodies:
        return (replace(marked_wheel(model, f"{start}upright"), side="wheel", suspension=name),)
    return tuple(found) if len(found) != 1 else (replace(found[0], side=side_of(found[0].centre)),)


def _with_tyres(model: ModelData, name: str, radius: float | None) -> tuple[Wheel, ...]:
    """Return the wheels of an axle by the tyres of the scene, each body once."""
    wheels = [wheel_of(model, body) for body in dict.fromkeys(wheel.body for wheel in wheels_of(model))]
    if not wheels:
        endings = (".left.upright", ".right.upright")
        known = sorted({each.rpartition(".")[0] for each in model.bodies if each.endswith(endings)})
        start = f"{name}." if name else ""
        raise InputError(
            f"found no body '{start}left.upright', expected a suspension with one: {', '.join(known) or 'none in the scene'}"
        )
    chosen = [
        wheel for wheel in wheels if name and any(f"{own}.".startswith(f"{name}.") for own in (wheel.tyre, wheel.body))
    ]
    if not chosen and name in ("front", "rear"):
        chosen = axle_at(wheels, name)
    if not 1 <= len(chosen) <= 2:
        raise InputError(
            f"axle '{name}': found {len(chosen)} wheels with tyres, expected one or two: name the bodies of the wheels "
            f"(of {', '.join(wheel.body for wheel in wheels)})"
        )
    return tuple(_on_hub(wheel, radius) for wheel in chosen)


def _on_hub(wheel: Wheel, radius: float | None) -> Wheel:
    """Return a wheel with its axis to the left and a given radius; raise an InputError without a radius or a single carrier."""
    if len(wheel.carriers) != 1:
        raise InputError(
            f"bodies.{wheel.body}: found {len(wheel.hubs)} revolute joints ({', '.join(wheel.hubs) or 'none'}), "
            "expected one, the hub of the wheel"
        )
    found = replace(wheel, axis=wheel.axis if wheel.axis[1] >= 0 else -wheel.axis, radius=radius or wheel.radius)
    return replace(found, patch=found.contact)


def _check(wheels: Sequence[Wheel], name: str) -> None:
    for wheel in wheels:
        if wheel.axis[1] < AXIS_ALONG_Y:
            x, y, z = wheel.axis
            raise InputError(
                f"bodies.{wheel.carrier}: found the axis of the wheel along [{x:.3g}, {y:.3g}, {z:.3g}], expected it along y, "
                "to the left: on the rig the vehicle points along x and z is up"
            )
        if wheel.side != "wheel" and wheel.sign * wheel.centre[1] < 0:
            raise InputError(
                f"bodies.{wheel.carrier}: found the {wheel.side} wheel at y = {wheel.centre[1]:.3g} m, expected y to the left"
            )
    sides = [wheel.side for wheel in wheels]
    if len(wheels) > 2 or (len(wheels) == 2 and sorted(sides) != ["left", "right"]):
        raise InputError(f"axle '{name}': found the wheels {', '.join(sides)}, expected one, or a left and a right one")


def _clamped(model: ModelData, name: str, start: str, wheels: Sequence[Wheel]) -> str:
    """Return the body to clamp: `chassis`, or the one that carries the axle.

    Raises InputError if the suspensions are attached to another body than `chassis`, such as a trailer.
    """
    carrying = _carrying(model, start, wheels)
    if "chassis" not in model.bodies:
        return carrying
    of_wheels = [wheel.carrier for wheel in wheels]
    if carrying not in ("chassis", GROUND) and not _reaches(model, "chassis", of_wheels, carrying):
        raise InputError(
            f"axle '{name}': found its suspension on {carrying} and not on chassis, expected the name of the body to clamp: "
            f"--body {carrying}"
        )
    return "chassis"


def _reaches(model: ModelData, body: str, carriers: Sequence[str], without: str) -> bool:
    """Return True if elements connect the carriers of the wheels to a body also without another body."""
    linked = bodies_of(model, without, carriers) - {without}
    elements = [each for each in (*model.joints.values(), *model.forces.values()) if not depends_on_more(each)]
    return any(body in ends and ends & linked for ends in (set(bodies_at(each)) for each in elements))


def _carrying(model: ModelData, start: str, wheels: Sequence[Wheel]) -> str:
    """Return the body that carries an axle.

    With suspensions by name it is the body outside them to which most of their elements are attached; else ground, if
    the axle stands on it, or the heaviest body connected to the wheels.
    """
    if any(not wheel.suspension for wheel in wheels):
        own = {wheel.carrier for wheel in wheels} | {wheel.body for wheel in wheels}
        linked = bodies_of(model, GROUND, [wheel.carrier for wheel in wheels])
        elements = [each for each in (*model.joints.values(), *model.forces.values()) if stays(each, frozenset(linked))]
        if any(GROUND in bodies_at(each) for each in elements):
            return GROUND
        return max(linked - own, key=lambda name: model.bodies[name].mass, default=GROUND)
    parts = tuple(f"{start}{side}" for side in SIDES) if not start else (start,)
    elements = [
        element
        for name, element in (*model.joints.items(), *model.forces.items())
        if name.startswith(parts) and not isinstance(element, Tyre)
    ]
    touched = Counter(marker.body for element in elements for _, marker in element.markers())
    others = [(count, body) for body, count in touched.items() if not body.startswith(parts)]
    return max(others, key=lambda found: found[0], default=(0, GROUND))[1]


def _steering(model: ModelData, given: str | None, bodies: frozenset[str]) -> str | None:
    known = angular_of_joints(model)
    if given is not None and given not in known:
        raise InputError(f"found no prismatic or revolute joint '{given}'{instead_of(given, known)}")
    if given is not None and not set(bodies_at(model.joints[given])) & (bodies - {GROUND}):
        raise InputError(f"steering: found the joint '{given}' on other bodies, expected one that steers the axle")
    named = [
        name
        for name, angular in known.items()
        if STEERING.get(name.rpartition(".")[2]) is angular and set(bodies_at(model.joints[name])) <= bodies | {GROUND}
    ]
    return given or (named[0] if len(named) == 1 else None)
