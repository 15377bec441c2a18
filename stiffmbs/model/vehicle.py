"""Section `vehicle` of a spatial scene: channels of a road vehicle in the axes of ISO 8855, as requests."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Annotated

from pydantic import Field

from ..elements.element import Element
from ..elements.requests.names import OF_SPACE
from ..elements.requests.output import Output
from ..elements.requests.output_field import output_field
from ..elements.spatial.body import Body
from ..elements.spatial.marker import ORIGIN, Placement, Point
from ..elements.spatial.orientation import IDENTITY, Orientation
from ..elements.spatial.spatial_kinds import FORCES
from ..elements.spatial.tyre import Tyre
from ..errors import InputError
from ..reading.did_you_mean import instead_of
from ..reading.fields import Described, located, mapping

VEHICLE = "vehicle"
WHOLE = {
    "x": "dx({m})",
    "y": "dy({m})",
    "z": "dz({m})",
    "yaw": "az({m}, ground)",
    "pitch": "asin(2*(q0({m})*q2({m}) - q1({m})*q3({m})))",
    "roll": "atan2(2*(q0({m})*q1({m}) + q2({m})*q3({m})), 1 - 2*(q1({m})^2 + q2({m})^2))",
    "yaw_rate": "wz({m})",
    "pitch_rate": "wy({m}) - (1 - cos(vehicle.yaw))*wy({m}) - sin(vehicle.yaw)*wx({m})",
    "roll_rate": "wx({m}) - (1 - cos(vehicle.yaw))*wx({m}) + sin(vehicle.yaw)*wy({m})",
}
"""Channels of the body with the marker {m}. The term 1 - cos instead of cos keeps the unit of the first summand."""
OF_POINT = {
    "vx": "vx({m}) - (1 - cos(vehicle.yaw))*vx({m}) + sin(vehicle.yaw)*vy({m})",
    "vy": "vy({m}) - (1 - cos(vehicle.yaw))*vy({m}) - sin(vehicle.yaw)*vx({m})",
    "vz": "vz({m})",
    "ax": "accx({m}) - (1 - cos(vehicle.yaw))*accx({m}) + sin(vehicle.yaw)*accy({m})",
    "ay": "accy({m}) - (1 - cos(vehicle.yaw))*accy({m}) - sin(vehicle.yaw)*accx({m})",
    "az": "accz({m})",
    "speed": "sqrt({p}vx^2 + {p}vy^2)",
    "sideslip": "atan2({p}vy, {p}vx)",
}
"""Channels of a point in the horizontal axes that yaw with the vehicle; {p} precedes the names of its channels."""
OF_TYRE = {
    "kappa": "slip", "alpha": "slip_angle", "camber": "camber", "load": "load", "deflection": "deflection",
    "longitudinal": "longitudinal", "lateral": "lateral", "aligning": "aligning",
}  # fmt: skip
"""Channels of a tyre by their names among those of the vehicle."""


class Steering(Described):
    """Formulas of the steering wheel, for the channels ``vehicle.steering_angle`` and ``vehicle.steering_torque``."""

    angle: Annotated[Output, output_field(OF_SPACE)] = Field(
        description="angle of the steering wheel, to the left, rad"
    )
    torque: Annotated[Output, output_field(OF_SPACE)] | None = Field(
        None, description="torque of the driver on the steering wheel, to the left, N m"
    )


class Vehicle(Described):
    """Section ``vehicle``: the sprung body whose motion becomes channels ``vehicle.*`` in the axes of ISO 8855.

    The vehicle axes are x forward, y to the left, z upwards on the body. Velocities and accelerations are resolved in
    the intermediate axes: horizontal, with x below the vehicle's x axis. ISO 8855:2011, Road vehicles, vehicle dynamics
    and road-holding ability, vocabulary.
    """

    body: str = Field(description="the sprung body")
    point: Point = Field(ORIGIN, description="reference point in the body's axes, m")
    orientation: Orientation = Field(
        IDENTITY, description="orientation of the vehicle axes, x forward and z upwards, relative to the body's"
    )
    points: dict[str, Point] = Field(
        default_factory=dict,
        description="further points on the body by name, in its axes, m, with velocity, acceleration and sideslip vehicle.NAME.vx ...",
    )
    steering: Steering | None = Field(None, description="formulas of the steering wheel's angle and torque")
    tyres: tuple[str, ...] | None = Field(
        None, description="tyres with slips and loads vehicle.TYRE.kappa ...; all of the scene by default"
    )


def with_vehicle(raw: dict[str, object], context: Mapping[str, object]) -> dict[str, object]:
    """Return a scene with the channels of its section ``vehicle`` among its requests.

    `raw`: spatial scene with its parts expanded. `context`: validation context. Raises InputError if the section is
    invalid, or names a body or a tyre that the scene lacks.
    """
    with located(VEHICLE):
        vehicle = Vehicle.model_validate(raw[VEHICLE], context=context)
    bodies, forces, requests = (mapping(raw.get(name) or {}, name) for name in ("bodies", "forces", "requests"))
    if vehicle.body not in bodies:
        raise InputError(f"{VEHICLE}.body: found '{vehicle.body}'{instead_of(vehicle.body, bodies)}")
    if VEHICLE in requests:
        raise InputError(f"requests.{VEHICLE}: found the name of the section {VEHICLE}, expected another")
    markers = {
        VEHICLE: {"point": vehicle.point, "orientation": vehicle.orientation},
        **{f"{VEHICLE}_{name}": {"point": point} for name, point in vehicle.points.items()},
    }
    found = {**requests, VEHICLE: _requests(vehicle, _tyres(vehicle, forces))}
    return {
        **raw,
        VEHICLE: vehicle,
        "bodies": {**bodies, vehicle.body: _with_markers(bodies[vehicle.body], markers)},
        "requests": found,
    }


def _requests(vehicle: Vehicle, tyres: Iterable[str]) -> dict[str, object]:
    body = f"{vehicle.body}.{VEHICLE}"
    found: dict[str, object] = {name: formula.format(m=body) for name, formula in WHOLE.items()}
    for marker, start in ((body, ""), *((f"{body}_{name}", f"{name}.") for name in vehicle.points)):
        found |= {
            f"{start}{name}": formula.format(m=marker, p=f"{VEHICLE}.{start}") for name, formula in OF_POINT.items()
        }
    if vehicle.steering is not None:
        found["steering_angle"] = vehicle.steering.angle
        found |= {} if vehicle.steering.torque is None else {"steering_torque": vehicle.steering.torque}
    for tyre in tyres:
        found |= {f"{tyre}.{name}": f"{tyre}.{own}" for name, own in OF_TYRE.items()}
    return found


def _tyres(vehicle: Vehicle, forces: Mapping[str, object]) -> tuple[str, ...]:
    """Return the names of the tyres to report."""
    known = tuple(name for name, force in forces.items() if _is_tyre(force))
    for name in vehicle.tyres or ():
        if name not in known:
            raise InputError(f"{VEHICLE}.tyres: found '{name}'{instead_of(name, known)}")
    return known if vehicle.tyres is None else vehicle.tyres


def _is_tyre(force: object) -> bool:
    if isinstance(force, Element):
        return isinstance(force, Tyre)
    kind = force.get("type") if isinstance(force, dict) else None
    return isinstance(kind, str) and kind in FORCES and issubclass(FORCES[kind], Tyre)


def _with_markers(body: object, markers: Mapping[str, object]) -> object:
    """Return a body, as written or validated, with further markers."""
    found = body.markers if isinstance(body, Body) else body.get("markers") if isinstance(body, dict) else None
    own = found if isinstance(found, Mapping) else {}
    twice = next((name for name in markers if name in own), None)
    if twice is not None:
        raise InputError(f"{VEHICLE}.body: found a marker '{twice}' on it, expected no marker of that name")
    if isinstance(body, Body):
        placed = {name: Placement.model_validate(marker) for name, marker in markers.items()}
        return body.model_copy(update={"markers": {**own, **placed}})
    return {**body, "markers": {**own, **markers}} if isinstance(body, dict) else body
