"""Test rig of an axle: the body is clamped, pads hold the wheels' heights, and inputs push, turn and steer.

The rig holds only the parts of the axle: tyres, drivers and other axles are left out.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

from ...elements.element import Element, Force, Joint
from ...elements.joints.constraint_equation import ConstraintEquation
from ...elements.joints.drive import Drive
from ...elements.spatial.forces.applied import AppliedForce, AppliedTorque
from ...elements.spatial.joints.fixed import Fixed
from ...elements.spatial.marker import Marker
from ...elements.spatial.tyre import Tyre
from ...errors import InputError
from ...model.model_data import ModelData
from ...model.spatial_model import Model
from ...reading.did_you_mean import did_you_mean
from ...reading.formula.formula import Formula
from ...reading.marker import GROUND, MarkerReference
from ...reading.table import Table

INPUTS = (
    "kc_left", "kc_right", "kc_rack", "kc_lateral", "kc_parallel", "kc_brake", "kc_traction", "kc_torque", "kc_turn"
)  # fmt: skip
"""Heights of the patches, travel of the rack (m), forces (N) and torques (N m) on each wheel.

Forces are outwards, to the left, backwards and forwards; torques are inwards and to the left.
"""
SIDES = ("left", "right")


@dataclass(frozen=True)
class Axle:
    """Parts of a scene that form an axle.

    Attributes
    ----------
    left, right : str
        Names of the suspensions, whose body ``upright`` has the markers ``spindle`` (centre of the wheel, with y along
        its axis) and ``patch``.
    body : str
        Body that carries them; ground if they stand on it.
    steering : str or None
        Prismatic joint whose travel steers.
    rigid : str or None
        Body of a rigid axle instead of uprights, with the markers ``left_spindle``, ``left_patch`` and those of the
        right.
    """

    left: str
    right: str
    body: str
    steering: str | None
    rigid: str | None = None

    def carrier(self, side: str) -> str:
        """Return the body on which a wheel rotates."""
        return self.rigid or f"{getattr(self, side)}.upright"

    def marker(self, side: str, name: str) -> str:
        """Return the name of a marker on the carrier: ``spindle`` or ``patch`` of a side."""
        return f"{side}_{name}" if self.rigid else name

    def at(self, side: str, name: str) -> Marker:
        """Return a marker on the carrier."""
        return Marker(body=self.carrier(side), marker=self.marker(side, name))


def axle_of(model: ModelData, name: str, body: str | None = None, steering: str | None = None) -> Axle:
    """Return the axle of a scene: the suspensions ``name.left`` and ``name.right``.

    Parameters
    ----------
    model : ModelData
    name : str
        Name such as ``front``; if empty, the suspensions are ``left`` and ``right``.
    body : str, optional
        Body to clamp; by default ``chassis``, or else the body to which most elements of the axle are attached.
    steering : str, optional
        Prismatic joint that steers; by default the only one named ``guide``, if any.

    Raises
    ------
    InputError
        If a suspension, its markers or a named part is missing in the scene.
    """
    start = f"{name}." if name else ""
    body = body or ("chassis" if "chassis" in model.bodies else _carrying(model, start))
    rigid = f"{start}axle" if f"{start}axle" in model.bodies and f"{start}left.upright" not in model.bodies else None
    axle = Axle(f"{start}left", f"{start}right", body, steering, rigid)
    for side in SIDES:
        _check_carrier(model, axle, side)
    if axle.body != GROUND and axle.body not in model.bodies:
        near = did_you_mean(axle.body, model.bodies)
        raise InputError(f"found no body '{axle.body}'{near} to clamp, expected one of {', '.join(model.bodies)}")
    return replace(axle, steering=_steering(model, steering))


def _carrying(model: ModelData, start: str) -> str:
    """Return the body, outside the suspensions, to which most of their elements are attached, or ground."""
    parts = tuple(f"{start}{side}" for side in SIDES) if not start else (start,)
    elements = [
        element
        for name, element in (*model.joints.items(), *model.forces.items())
        if name.startswith(parts) and not isinstance(element, Tyre)
    ]
    touched = Counter(marker.body for element in elements for _, marker in element.markers())
    others = [(count, body) for body, count in touched.items() if not body.startswith(parts)]
    return max(others, key=lambda found: found[0], default=(0, GROUND))[1]


def _check_carrier(model: ModelData, axle: Axle, side: str) -> None:
    carrier = axle.carrier(side)
    if carrier not in model.bodies:
        endings = (".upright", ".axle")
        known = sorted({each.rpartition(".")[0] for each in model.bodies if each.endswith(endings)})
        raise InputError(
            f"found no body '{carrier}', expected a suspension with one: {', '.join(known) or 'none in the scene'}"
        )
    for name in ("spindle", "patch"):
        if axle.marker(side, name) not in model.bodies[carrier].markers:
            raise InputError(
                f"bodies.{carrier}: found no marker '{axle.marker(side, name)}', expected it where the wheel is held"
            )


def _steering(model: ModelData, given: str | None) -> str | None:
    slides = [name for name, joint in model.joints.items() if joint.kind == "prismatic"]
    if given is not None and given not in slides:
        near = did_you_mean(given, slides)
        raise InputError(f"found no prismatic joint '{given}'{near}, expected one of {', '.join(slides) or 'none'}")
    guides = [name for name in slides if name.rpartition(".")[2] == "guide"]
    return given or (guides[0] if len(guides) == 1 else None)


def on_rig(scene: ModelData, axle: Axle, tables: dict[str, Table]) -> ModelData:
    """Return the model of an axle on its rig, whose inputs are tables of time."""

    bodies = _bodies_of(scene, axle)
    model = Model(f"{scene.name}, {axle.left} and {axle.right} on a rig", scene.gravity)
    model.markers.update(scene.markers)
    model.bodies.update(
        {
            name: body.model_copy(update={"velocity": (0.0, 0.0, 0.0), "omega": (0.0, 0.0, 0.0)})
            for name, body in scene.bodies.items()
            if name in bodies
        }
    )
    for section, elements in ((model.joints, scene.joints), (model.forces, scene.forces)):
        section.update({name: each for name, each in elements.items() if _stays(each, bodies)})
    for name, table in tables.items():
        model.add_input(name, table)
    if axle.body != GROUND:
        place = scene.bodies[axle.body]
        held = Marker(body=GROUND, point=place.position, orientation=place.orientation)
        model.add("kc.clamp", Fixed(i=axle.body, j=held))
    if axle.steering in model.joints:
        model.add("kc.steer", Drive(joint=axle.steering, position=tables["kc_rack"]))
    for side in SIDES:
        _hold_wheel(model, axle, side)
    data: ModelData = model.data()
    return data


def _hold_wheel(model: Any, axle: Axle, side: str) -> None:
    """Add a pad, forces and a torque to a wheel; those of one wheel alone are mirrored on the right."""

    sign = "" if side == "left" else "-"
    patch, spindle = (f"{axle.carrier(side)}.{axle.marker(side, name)}" for name in ("patch", "spindle"))
    parts: dict[str, Joint | Force] = {
        "pad": ConstraintEquation(i=patch, zero=f"dz({patch}) - kc_{side}"),
        "ground_force": AppliedForce(i=patch, force=("-kc_brake", f"{sign}(kc_lateral) + kc_parallel", 0)),
        "axle_force": AppliedForce(i=spindle, force=("kc_traction", 0, 0)),
        "torque": AppliedTorque(i=patch, torque=(0, 0, f"{'-' if side == 'left' else ''}(kc_torque) + kc_turn")),
    }
    for name, part in parts.items():
        model.add(f"kc.{side}.{name}", part)


def _bodies_of(scene: ModelData, axle: Axle) -> set[str]:
    """Return the bodies connected to the uprights other than through the body that carries them."""
    elements = (*scene.joints.values(), *scene.forces.values())
    ends = [set(_bodies_at(each)) - {axle.body, GROUND} for each in elements if not _depends_on_more(each)]
    found: set[str] = set()
    grown = {axle.carrier(side) for side in SIDES}
    while grown != found:
        found = grown
        grown = found.union(*(each for each in ends if each & found))
    return found | ({axle.body} - {GROUND})


def _bodies_at(element: Element) -> Iterator[str]:
    yield from (marker.body for _, marker in element.parts(MarkerReference))
    yield from (marker.body for _, marker in element.markers())


def _depends_on_more(element: Element) -> bool:
    """Return True if an element is a drive, or has a formula with states or inputs, which the rig lacks."""
    return isinstance(element, Drive) or any(formula.states for _, formula in element.parts(Formula))


def _stays(element: Element, bodies: set[str]) -> bool:
    if isinstance(element, Tyre) or _depends_on_more(element):
        return False
    return set(_bodies_at(element)) <= bodies | {GROUND}


def design_height(scene: ModelData, axle: Axle, side: str) -> float:
    """Return the described height of a patch, m."""
    return scene.point(axle.at(side, "patch"))[2]
