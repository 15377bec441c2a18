"""The test rig of an axle: the body is clamped, pads hold the wheels' heights, and inputs push, turn and steer.

What is on the rig besides are the parts of the axle alone: tyres, drivers and other axles are left out.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from ...describe.element import Element, Force, Joint
from ...describe.formula.formula import Formula
from ...describe.joints.constraint_equation import ConstraintEquation
from ...describe.joints.drive import Drive
from ...describe.marker import GROUND, MarkerReference
from ...describe.model_data import ModelData
from ...describe.spatial.forces.applied import AppliedForce, AppliedTorque
from ...describe.spatial.joints.fixed import Fixed
from ...describe.spatial.marker import Marker
from ...describe.spatial.model import Model
from ...describe.spatial.tyre import Tyre
from ...describe.table import Table
from ...errors import InputError

INPUTS = ("kc_left", "kc_right", "kc_rack", "kc_lateral", "kc_brake", "kc_traction", "kc_torque")
"""Heights of the patches (m), travel of the rack (m), forces on each wheel (N), and the torque that turns it in (N m)."""
SIDES = ("left", "right")


@dataclass(frozen=True)
class Axle:
    """Which parts of a scene are an axle.

    Attributes
    ----------
    left, right : str
        Names of the suspensions, whose body ``upright`` has the markers ``spindle`` (centre of the wheel, its y axis the axle's)
        and ``patch``.
    body : str
        The body that carries them; ground where they stand on it.
    steering : str or None
        A prismatic joint whose travel steers.
    """

    left: str
    right: str
    body: str
    steering: str | None

    def upright(self, side: str) -> str:
        """The name of an upright."""
        return f"{getattr(self, side)}.upright"


def axle_of(model: ModelData, name: str, body: str | None = None, steering: str | None = None) -> Axle:
    """The axle of a scene: the suspensions ``name.left`` and ``name.right``.

    Parameters
    ----------
    model : ModelData
    name : str
        Such as ``front``; without it the suspensions are ``left`` and ``right``.
    body : str, optional
        The body to clamp: ``chassis`` where there is one, else ground.
    steering : str, optional
        The prismatic joint that steers: the only one named ``guide``, if there is one.

    Raises
    ------
    InputError
        Where a suspension, its markers or what is named is not in the scene.
    """
    start = f"{name}." if name else ""
    axle = Axle(f"{start}left", f"{start}right", body or ("chassis" if "chassis" in model.bodies else GROUND), steering)
    for side in SIDES:
        upright = axle.upright(side)
        known = sorted({each.removesuffix(".upright") for each in model.bodies if each.endswith(".upright")})
        if upright not in model.bodies:
            raise InputError(
                f"found no body '{upright}', expected a suspension with one: {', '.join(known) or 'none in the scene'}"
            )
        for marker in ("spindle", "patch"):
            if marker not in model.bodies[upright].markers:
                raise InputError(f"bodies.{upright}: found no marker '{marker}', expected it where the wheel is held")
    if axle.body != GROUND and axle.body not in model.bodies:
        raise InputError(f"found no body '{axle.body}' to clamp, expected one of {', '.join(model.bodies)}")
    return Axle(axle.left, axle.right, axle.body, _steering(model, steering))


def _steering(model: ModelData, given: str | None) -> str | None:
    slides = [name for name, joint in model.joints.items() if joint.kind == "prismatic"]
    if given is not None and given not in slides:
        raise InputError(f"found no prismatic joint '{given}', expected one of {', '.join(slides) or 'none'}")
    guides = [name for name in slides if name.rpartition(".")[2] == "guide"]
    return given or (guides[0] if len(guides) == 1 else None)


def on_rig(scene: ModelData, axle: Axle, tables: dict[str, Table]) -> ModelData:
    """A model of an axle on its rig, whose inputs are tables of time."""

    bodies = _bodies_of(scene, axle)
    model = Model(f"{scene.name}, {axle.left} and {axle.right} on a rig", scene.gravity)
    model.markers.update(scene.markers)
    model.bodies.update({name: _at_rest(body) for name, body in scene.bodies.items() if name in bodies})
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
    """A pad under a wheel, and the forces and the torque on it; mirrored on the right."""

    upright, sign = axle.upright(side), "" if side == "left" else "-"
    patch, spindle = f"{upright}.patch", f"{upright}.spindle"
    parts: dict[str, Joint | Force] = {
        "pad": ConstraintEquation(i=patch, zero=f"dz({patch}) - kc_{side}"),
        "ground_force": AppliedForce(i=patch, force=("-kc_brake", f"{sign}(kc_lateral)", 0)),
        "axle_force": AppliedForce(i=spindle, force=("kc_traction", 0, 0)),
        "torque": AppliedTorque(i=patch, torque=(0, 0, f"{'-' if side == 'left' else ''}(kc_torque)")),
    }
    for name, part in parts.items():
        model.add(f"kc.{side}.{name}", part)


def _at_rest(body: Any) -> Any:
    return body.model_copy(update={"velocity": (0.0, 0.0, 0.0), "omega": (0.0, 0.0, 0.0)})


def _bodies_of(scene: ModelData, axle: Axle) -> set[str]:
    """The bodies that hang together with the uprights otherwise than through the body that carries them."""
    ends = [set(_bodies_at(each)) - {axle.body, GROUND} for each in _elements(scene) if not _depends_on_more(each)]
    found: set[str] = set()
    grown = {axle.upright(side) for side in SIDES}
    while grown != found:
        found = grown
        grown = found.union(*(each for each in ends if each & found))
    return found | ({axle.body} - {GROUND})


def _elements(scene: ModelData) -> Iterator[Element]:
    yield from scene.joints.values()
    yield from scene.forces.values()


def _bodies_at(element: Element) -> Iterator[str]:
    yield from (marker.body for _, marker in element.parts(MarkerReference))
    yield from (marker.body for _, marker in element.markers())


def _depends_on_more(element: Element) -> bool:
    """Whether an element has a formula with states or inputs, of which the rig has none, or is a drive."""
    return isinstance(element, Drive) or any(formula.states for _, formula in element.parts(Formula))


def _stays(element: Element, bodies: set[str]) -> bool:
    if isinstance(element, Tyre) or _depends_on_more(element):
        return False
    return set(_bodies_at(element)) <= bodies | {GROUND}


def design_height(scene: ModelData, axle: Axle, side: str) -> float:
    """The height of a patch as described, m."""
    return scene.point(Marker(body=axle.upright(side), marker="patch"))[2]
