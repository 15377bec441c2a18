"""Bodies and wheels of an axle: their names in shipped parts, or the tyres of any scene."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from numbers import Real

import numpy as np

from ...elements.element import Element
from ...elements.joints.drive import Drive
from ...elements.spatial.marker import Marker
from ...elements.spatial.tyre import Tyre
from ...errors import InputError
from ...model.model_data import ModelData
from ...reading.did_you_mean import did_you_mean, instead_of
from ...reading.formula.formula import Formula
from ...reading.marker import GROUND, MarkerReference


def bodies_of(scene: ModelData, body: str, carriers: Sequence[str]) -> set[str]:
    """Return the bodies connected to the carriers of the wheels other than through the clamped body, and that body."""
    elements = (each for each in (*scene.joints.values(), *scene.forces.values()) if not depends_on_more(each))
    return grown(carriers, elements, {body, GROUND}) | ({body} - {GROUND})


def centre_of_mass(scene: ModelData, body: str) -> np.ndarray:
    """Return the centre of mass of a described vehicle, m: of the bodies that joints and forces connect, except by ground."""
    found = grown([body], (*scene.joints.values(), *scene.forces.values()), {GROUND})
    bodies = [each for name, each in scene.bodies.items() if name in found]
    masses, places = np.array([each.mass for each in bodies]), np.array([each.coordinates()[:3] for each in bodies])
    return np.asarray(masses @ places / masses.sum())


def grown(bodies: Sequence[str], elements: Iterable[Element], without: set[str]) -> set[str]:
    """Return bodies with all those that elements connect to them, except through the bodies `without`."""
    ends = [set(bodies_at(each)) - without for each in elements]
    found, larger = set[str](), set(bodies)
    while larger != found:
        found = larger
        larger = found.union(*(each for each in ends if each & found))
    return found


def bodies_at(element: Element) -> Iterator[str]:
    """Yield the bodies that an element names."""
    yield from (marker.body for _, marker in element.parts(MarkerReference))
    yield from (marker.body for _, marker in element.markers())


def depends_on_more(element: Element) -> bool:
    """Return True if an element is a drive, or has a formula with states or inputs, which the rig lacks."""
    return isinstance(element, Drive) or any(formula.states for _, formula in element.parts(Formula))


def stays(element: Element, bodies: frozenset[str]) -> bool:
    """Return True if an element belongs on the rig: no tyre, and attached only to bodies of the axle and ground."""
    if isinstance(element, Tyre) or depends_on_more(element):
        return False
    return set(bodies_at(element)) <= bodies | {GROUND}


SIDES = ("left", "right")
STEERING = ("guide", "prismatic"), ("steering", "revolute")
"""Names and kinds of the joints that steer unless one is named."""
AXIS_ALONG_Y = 0.7
"""Smallest component along y of a wheel's axis as described; x is forward on the rig (ISO 8855)."""
SAME_AXLE = 0.3
"""Largest distance along x of the wheels of one axle, m."""
ON_MIDDLE_PLANE = 1e-6
"""Largest distance from the middle plane of a wheel that is on neither side, m."""


@dataclass(frozen=True)
class Wheel:
    """Wheel of an axle on the body that carries its bearing."""

    side: str  # ``left``, ``right``, or ``wheel`` for the only wheel of a motorcycle's axle
    suspension: str  # prefix of the names of the suspension's elements; empty if they have none
    carrier: str  # body on which the wheel rotates
    centre: np.ndarray  # shape (3,): centre of the wheel as described, ground axes, m
    axis: np.ndarray  # shape (3,): unit vector along its axis, to the left
    contact: np.ndarray  # shape (3,): centre of its contact with the road, m
    body: str | None = None  # wheel body, if it is known

    @property
    def sign(self) -> float:
        """1 on the left, -1 on the right: outwards is this times y."""
        return -1.0 if self.side == "right" else 1.0


@dataclass(frozen=True)
class Axle:
    """Parts of a scene that form an axle."""

    name: str  # name of the axle
    wheels: tuple[Wheel, ...]  # one or two, left first
    body: str  # body that carries them; ground if they stand on it
    steering: str | None = None  # prismatic or revolute joint whose travel steers
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
        found = tuple(_of_body(model, each, radius) for each in wheels)
    else:
        found = _named(model, name, start) or _with_tyres(model, name, radius)
    _check(found, name)
    body = body or _clamped(model, name, start, found)
    if body != GROUND and body not in model.bodies:
        near = did_you_mean(body, model.bodies)
        raise InputError(f"found no body '{body}'{near} to clamp, expected one of {', '.join(model.bodies)}")
    axle = Axle(name, tuple(found), body)
    axle = replace(axle, bodies=frozenset(bodies_of(model, body, [wheel.carrier for wheel in found])))
    return replace(axle, steering=_steering(model, steering, axle.bodies))


def _named(model: ModelData, name: str, start: str) -> tuple[Wheel, ...]:
    """Return the wheels on ``axle`` or ``upright`` bodies with the markers of shipped parts; none without such bodies."""
    found = []
    for side in SIDES:
        suspension = f"{start}{side}"
        if f"{suspension}.upright" in model.bodies:
            found.append(_marked(model, side, suspension, f"{suspension}.upright", ""))
        elif f"{start}axle" in model.bodies:
            found.append(_marked(model, side, suspension, f"{start}axle", f"{side}_"))
    if not found and f"{start}upright" in model.bodies:
        found.append(_marked(model, "wheel", name, f"{start}upright", ""))
    if len(found) == 1 and found[0].side in SIDES:
        found = [replace(found[0], side=_side(found[0].centre))]
    return tuple(found)


def _marked(model: ModelData, side: str, suspension: str, carrier: str, prefix: str) -> Wheel:
    for name in ("spindle", "patch"):
        if f"{prefix}{name}" not in model.bodies[carrier].markers:
            raise InputError(f"bodies.{carrier}: found no marker '{prefix}{name}', expected it where the wheel is held")
    spindle = model.initial_marker(Marker(body=carrier, marker=f"{prefix}spindle"))
    patch = model.point(Marker(body=carrier, marker=f"{prefix}patch"))
    return Wheel(side, suspension, carrier, np.array(spindle.point), spindle.axes[:, 1], np.array(patch))


def _with_tyres(model: ModelData, name: str, radius: float | None) -> tuple[Wheel, ...]:
    """Return the wheels of an axle by the tyres of the scene."""
    tyres = {key: force for key, force in model.forces.items() if isinstance(force, Tyre)}
    bodies = {tyre.i.body: model.point(tyre.i)[0] for key, tyre in tyres.items()}
    if not bodies:
        endings = (".left.upright", ".right.upright")
        known = sorted({each.rpartition(".")[0] for each in model.bodies if each.endswith(endings)})
        start = f"{name}." if name else ""
        raise InputError(
            f"found no body '{start}left.upright', expected a suspension with one: {', '.join(known) or 'none in the scene'}"
        )
    ends = {"front": max(bodies.values()), "rear": min(bodies.values())}
    chosen = [
        tyre.i.body
        for key, tyre in tyres.items()
        if (f"{key}.".startswith(f"{name}.") or f"{tyre.i.body}.".startswith(f"{name}.")) and name
    ]
    if not chosen and name in ends:
        chosen = [body for body, x in bodies.items() if abs(x - ends[name]) < SAME_AXLE]
    if not 1 <= len(set(chosen)) <= 2:
        raise InputError(
            f"axle '{name}': found {len(set(chosen))} wheels with tyres, expected one or two: name the bodies of the wheels "
            f"(of {', '.join(bodies)})"
        )
    return tuple(_of_body(model, body, radius) for body in dict.fromkeys(chosen))


def _of_body(model: ModelData, body: str, radius: float | None) -> Wheel:
    """Return the wheel that is a body with a hub."""
    if body not in model.bodies:
        raise InputError(f"found no body '{body}'{did_you_mean(body, model.bodies)}, expected the body of a wheel")
    hubs = {
        name: joint
        for name, joint in model.joints.items()
        if joint.kind == "revolute" and body in (joint.i.body, joint.j.body)  # type: ignore[attr-defined]
    }
    if len(hubs) != 1:
        raise InputError(
            f"bodies.{body}: found {len(hubs)} revolute joints ({', '.join(hubs) or 'none'}), expected one, the hub of the wheel"
        )
    ((_, hub),) = hubs.items()
    own, carrier = (hub.i, hub.j) if hub.i.body == body else (hub.j, hub.i)  # type: ignore[attr-defined]
    tyre = next((each for each in model.forces.values() if isinstance(each, Tyre) and each.i.body == body), None)
    centre = np.array(model.point(tyre.i if tyre is not None else own))
    axis = model.initial_marker(own).axes[:, 2]
    axis = axis if axis[1] >= 0 else -axis
    distance = radius or (None if tyre is None else _radius(tyre))
    if distance is None:
        raise InputError(f"bodies.{body}: found no tyre with a radius, expected the radius of the wheel as an option")
    up = np.array([0.0, 0.0, 1.0]) - axis[2] * axis
    contact = centre - distance * up / np.linalg.norm(up)
    return Wheel(_side(centre), "", carrier.body, centre, axis, contact, body)


def _radius(tyre: Tyre) -> float | None:
    """Return the unloaded radius of a tyre, m, from its field or its property file."""
    properties = getattr(tyre, "properties", None)
    if properties is not None:
        found = dict(properties.coefficients).get("UNLOADED_RADIUS")
    else:
        found = getattr(tyre, "radius", None)
    return None if found is None else float(found)


def _side(centre: np.ndarray) -> str:
    return "wheel" if abs(centre[1]) < ON_MIDDLE_PLANE else "left" if centre[1] > 0 else "right"


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
    slides = [name for name, joint in model.joints.items() if joint.kind in ("prismatic", "revolute")]
    if given is not None and given not in slides:
        raise InputError(f"found no prismatic or revolute joint '{given}'{instead_of(given, slides)}")
    if given is not None and not set(bodies_at(model.joints[given])) & (bodies - {GROUND}):
        raise InputError(f"steering: found the joint '{given}' on other bodies, expected one that steers the axle")
    guides = [
        name
        for name in slides
        if (name.rpartition(".")[2], model.joints[name].kind) in STEERING
        and set(bodies_at(model.joints[name])) <= bodies | {GROUND}
    ]
    return given or (guides[0] if len(guides) == 1 else None)
