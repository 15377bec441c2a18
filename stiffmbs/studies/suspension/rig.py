"""Test rig of an axle: the body is clamped, pads hold the wheels' heights, and inputs push, turn and steer.

The rig holds only the parts of the axle: tyres, drivers and other axles are left out.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ...compile.quaternions import CONJUGATE, rotated, times
from ...elements.element import Force, Joint
from ...elements.joints.constraint_equation import ConstraintEquation
from ...elements.joints.drive import Drive
from ...elements.spatial.body import Body
from ...elements.spatial.forces.applied import AppliedForce, AppliedTorque
from ...elements.spatial.joints.fixed import Fixed
from ...elements.spatial.marker import Marker, Placement
from ...elements.spatial.orientation import from_matrix
from ...model.model_data import ModelData
from ...model.spatial_model import Model
from ...model.wheels import Wheel
from ...reading.marker import GROUND
from ...reading.table import Table
from .axle import Axle, stays

UP = np.array([0.0, 0.0, 1.0])


def wheel_axes(axis: np.ndarray) -> np.ndarray:
    """Return the axes of a wheel as rows: horizontal and forward, along its axis to the left, and upwards between them."""
    forward = np.cross(axis, UP)
    forward /= np.linalg.norm(forward)
    return np.array([forward, axis, np.cross(forward, axis)])


def contact_from(centre: np.ndarray, axis: np.ndarray, contact: np.ndarray) -> tuple[float, float, float]:
    """Return the position of the contact from the centre along the axis, forward and upwards in the wheel's plane, m."""
    forward, along, upward = wheel_axes(axis) @ (contact - centre)
    return float(along), float(forward), float(upward)


def contact_at(centre: np.ndarray, axis: np.ndarray, place: tuple[float, float, float]) -> np.ndarray:
    """Return the contact in ground axes, m, from its position as `contact_from` returns it."""
    along, forward, upward = place
    found: np.ndarray = centre + np.array([forward, along, upward]) @ wheel_axes(axis)
    return found


def contact_velocity(axis: np.ndarray, arm: np.ndarray, v: np.ndarray, omega: np.ndarray) -> np.ndarray:
    """Return the velocity of the contact with an arm from the centre, for a motion of the carrier.

    The wheel's axes rotate with omega - s axis, where s keeps `forward` horizontal. `axis`, `arm` of shape (3,): axis
    of the wheel, and contact from its centre, m. `v`, `omega` of shape (3,): velocity of the centre and angular
    velocity of the carrier.
    """
    forward, _, upward = wheel_axes(axis)
    spin = -np.cross(omega, forward)[2] / upward[2]
    found: np.ndarray = v + np.cross(omega - spin * axis, arm)
    return found


FORCES = ("kc_rack", "kc_lateral", "kc_parallel", "kc_brake", "kc_traction", "kc_torque", "kc_turn")
"""Travel of the steering joint (m or rad), forces (N) and torques (N m) on each wheel.

Forces are outwards, to the left, backwards and forwards; torques are inwards and to the left.
"""
STEER = "kc.steer"
"""Name of the drive of the steering joint."""


def inputs_of(axle: Axle) -> tuple[str, ...]:
    """Return the names of the inputs: the height of the contact of each wheel, and `FORCES`."""
    return (*(f"kc_{wheel.side}" for wheel in axle.wheels), *FORCES)


def pad(wheel: Wheel) -> str:
    """Return the name of the constraint that holds a wheel at its height."""
    return f"kc.{wheel.side}.pad"


def centre(wheel: Wheel) -> Marker:
    """Return the marker at the centre of a wheel on its carrier, y along the wheel's axis."""
    return Marker(body=wheel.carrier, marker=f"kc_{wheel.side}_centre")


def on_rig(scene: ModelData, axle: Axle, tables: dict[str, Table]) -> ModelData:
    """Return the model of an axle on its rig, whose inputs are tables of time."""

    model = Model(f"{scene.name}, {axle.title} on a rig", scene.gravity)
    model.markers.update(scene.markers)
    for name, body in scene.bodies.items():
        if name in axle.bodies:
            added: dict[str, Placement] = {}
            for wheel in axle.wheels:
                added |= _markers(body, wheel) if wheel.carrier == name else {}
            changes = {"velocity": (0.0, 0.0, 0.0), "omega": (0.0, 0.0, 0.0), "markers": {**body.markers, **added}}
            model.bodies[name] = body.model_copy(update=changes)
    for section, elements in ((model.joints, scene.joints), (model.forces, scene.forces)):
        section.update({name: each for name, each in elements.items() if stays(each, axle.bodies)})
    for name, table in tables.items():
        model.add_input(name, table)
    if axle.body != GROUND:
        place = scene.bodies[axle.body]
        held = Marker(body=GROUND, point=place.position, orientation=place.orientation)
        model.add("kc.clamp", Fixed(i=axle.body, j=held))
    if axle.steering in model.joints:
        model.add(STEER, Drive(joint=axle.steering, position=tables["kc_rack"]))
    for wheel in axle.wheels:
        _hold_wheel(model, wheel)
    data: ModelData = model.data()
    return data


def _markers(body: Body, wheel: Wheel) -> dict[str, Placement]:
    """Return the markers of a wheel on its carrier: centre, a point 1 m along the axis, and contact."""
    axes = np.array(from_matrix(wheel_axes(wheel.axis).T))
    back = np.array(body.orientation) * CONJUGATE
    places = {"centre": wheel.centre, "axle": wheel.centre + wheel.axis, "patch": wheel.contact}
    return {
        f"kc_{wheel.side}_{name}": Placement(
            point=tuple(rotated(back, place - np.array(body.position)).tolist()),
            orientation=tuple(times(back, axes).tolist()),
        )
        for name, place in places.items()
    }


def _hold_wheel(model: Any, wheel: Wheel) -> None:
    """Add a pad, forces and a torque to a wheel; those of a single wheel are mirrored on the right.

    The wheel rolls on its pad: the contact stays below its centre when the carrier rotates about the wheel's axis.
    """

    sign = "-" if wheel.side == "right" else ""
    middle, along, patch = (f"{wheel.carrier}.kc_{wheel.side}_{name}" for name in ("centre", "axle", "patch"))
    lateral, _, upward = contact_from(wheel.centre, wheel.axis, wheel.contact)
    lean = f"((dz({along}) - dz({middle}))/(1 m))"
    height = f"dz({middle}) + ({lateral!r} m)*{lean} + ({upward!r} m)*sqrt(1 - {lean}^2)"
    parts: dict[str, Joint | Force] = {
        "pad": ConstraintEquation(i=patch, zero=f"{height} - kc_{wheel.side}"),
        "ground_force": AppliedForce(i=patch, force=("-kc_brake", f"{sign}(kc_lateral) + kc_parallel", 0)),
        "axle_force": AppliedForce(i=middle, force=("kc_traction", 0, 0)),
        "torque": AppliedTorque(i=patch, torque=(0, 0, f"{'' if sign else '-'}(kc_torque) + kc_turn")),
    }
    for name, part in parts.items():
        model.add(f"kc.{wheel.side}.{name}", part)
