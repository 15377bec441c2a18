"""Measures of an axle at one pose on its rig.

All follow from the pose of the carriers and from their velocities per unit of the inputs, for any kind of suspension.
Definitions and signs: docs/guide/kinematics_and_compliance.md (ISO 8855).
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np

from ...dynamics.dynamics import Dynamics
from ...elements.forces.springs import AngleSpring, LineSpring, Spring
from ...model.model_data import ModelData
from ...model.wheels import Wheel
from .axle import Axle
from .rig import STEER, centre, contact_at, contact_from, contact_velocity, pad
from .tangent import SteeringAxis, Tangent, Twist, steering_axis, steering_motion
from .vehicle import Vehicle

UNITS = {
    "travel": "mm", "toe": "deg", "camber": "deg", "spin": "deg", "lateral": "mm", "longitudinal": "mm", "load": "N",
    "wheel_rate": "N/mm", "motion_ratio": "", "fvsa_length": "mm", "fvsa_angle": "deg", "svsa_length": "mm",
    "svsa_angle": "deg", "brake_angle": "deg", "drive_angle": "deg", "anti_dive": "%", "anti_lift": "%", "anti_squat": "%",
    "caster": "deg", "kingpin_inclination": "deg", "scrub_radius": "mm", "caster_trail": "mm", "spindle_offset": "mm",
    "caster_offset": "mm", "steer": "deg", "track": "mm", "roll_centre_height": "mm", "roll_centre_lateral": "mm",
    "roll_rate": "N m/deg", "roll_angle": "deg", "steering_ratio": "", "ackermann": "%", "turning_radius": "m",
}  # fmt: skip
"""Measures with their units; that of the steering ratio depends on the steering joint."""
MM: Final = 1e3
DEG: Final = 180 / np.pi
STRAIGHT = 0.02
"""Sum of both steer angles, rad, below which the axle does not turn the vehicle."""
PARALLEL = 1e-12
"""Sine of the angle between two lines below which they do not meet."""


@dataclass(frozen=True)
class Setup:
    """Data that the measures of all poses share."""

    model: ModelData  # model on the rig
    axle: Axle
    vehicle: Vehicle
    springs: dict[str, Spring]  # springs between points and torsion springs on the rig
    # springs of each side, by their names on that side
    of_wheel: dict[str, dict[str, LineSpring]]  # type: ignore[type-arg]
    angular: bool  # True if the steering joint rotates

    @property
    def plane(self) -> float:
        """Position of the middle of the contacts as described, along y of the ground, m."""
        return float(np.mean([wheel.contact[1] for wheel in self.axle.wheels]))


def setup_of(model: ModelData, axle: Axle, vehicle: Vehicle) -> Setup:
    """Return what the measures need of a model on the rig."""
    springs: dict[str, Spring] = {
        name: force for name, force in model.forces.items() if isinstance(force, LineSpring | AngleSpring)
    }
    lines = {name: force for name, force in springs.items() if isinstance(force, LineSpring)}
    of_wheel = {wheel.side: springs_of(model, axle, wheel, lines) for wheel in axle.wheels}
    return Setup(model, axle, vehicle, springs, of_wheel, axle.angular and axle.steering in model.joints)


def springs_of(model: ModelData, axle: Axle, wheel: Wheel, lines: dict[str, LineSpring]) -> dict[str, LineSpring]:  # type: ignore[type-arg]
    """Return the springs between points of one side: by the prefix of its suspension, or by their place."""
    start = wheel.suspension
    if start:
        return {
            name.removeprefix(start)[1:]: force
            for name, force in lines.items()
            if name.startswith((f"{start}.", f"{start}_"))
        }
    places = {name: model.point(force.i)[1] + model.point(force.j)[1] for name, force in lines.items()}
    return {name: lines[name] for name, y in places.items() if len(axle.wheels) == 1 or wheel.sign * y > 0}


@dataclass(frozen=True)
class Hub:
    """Pose of a wheel: centre, axis to the left, contact (m, ground axes), and an axis of the carrier."""

    wheel: Wheel
    centre: np.ndarray
    axis: np.ndarray
    contact: np.ndarray
    forward: np.ndarray

    @property
    def steer(self) -> float:
        """Angle of the wheel to the left, rad."""
        return float(np.arctan2(-self.axis[0], self.axis[1]))

    @property
    def heading(self) -> np.ndarray:
        """Horizontal unit vectors along the wheel's heading and outwards, shape (2, 2), x and y."""
        x, y = self.axis[:2] / np.linalg.norm(self.axis[:2])
        return np.array([[y, -x], [self.wheel.sign * x, self.wheel.sign * y]])


class Pose:
    """Axle at an equilibrium on its rig.

    `dynamics`: at the equilibrium. `t`: s. `mode`: factors of the pads' displacements in the motion that is measured:
    (1, 1) in bump, (1, -1) in roll.
    """

    def __init__(self, setup: Setup, dynamics: Dynamics, t: float, mode: tuple[float, ...]) -> None:
        self.setup, self.mode = setup, mode
        self.tangent = Tangent(setup.model, dynamics, t)
        self.hubs = [self._hub(wheel) for wheel in setup.axle.wheels]
        self.loads = [self.tangent.load(pad(wheel)) for wheel in setup.axle.wheels]

    def with_mode(self, mode: tuple[float, ...]) -> Pose:
        """Return the same pose for another motion."""
        other = copy(self)
        other.__dict__.pop("motion", None)
        other.mode = mode
        return other

    def _hub(self, wheel: Wheel) -> Hub:
        marker = centre(wheel)
        point, axis = self.tangent.columns(marker)[0], self.tangent.axis(marker, 1)
        contact = contact_at(point, axis, contact_from(wheel.centre, wheel.axis, wheel.contact))
        return Hub(wheel, point, axis, contact, self.tangent.axis(marker, 0))

    @cached_property
    def lifted(self) -> list[np.ndarray]:
        """Change of the pose per displacement of each pad."""
        return [self.tangent.held.moved(pad(hub.wheel)) for hub in self.hubs]

    @cached_property
    def motion(self) -> np.ndarray:
        """Change of the pose in the mode."""
        return np.asarray(sum(factor * x for factor, x in zip(self.mode, self.lifted, strict=True)))

    @cached_property
    def steered(self) -> np.ndarray | None:
        """Change of the pose per displacement of the steering joint, the pads at rest; None without one."""
        return self.tangent.held.moved(STEER) if STEER in self.setup.model.joints else None

    @cached_property
    def steering_locked(self) -> np.ndarray | None:
        """Change of the pose by steering with the springs locked and the pads released; None if there is none."""
        pads = [pad(hub.wheel) for hub in self.hubs]
        return steering_motion(self.tangent, pads, [*self.setup.springs.values()])

    def twist(self, hub: Hub, x: np.ndarray) -> Twist:
        """Return the motion of a carrier, at the centre of its wheel, in a change of the pose."""
        _, v, omega = self.tangent.columns(centre(hub.wheel))
        return Twist(v @ x, omega @ x)

    def contact_velocity(self, hub: Hub, x: np.ndarray) -> np.ndarray:
        """Return the velocity of the contact of a wheel, which rolls, in a change of the pose."""
        twist = self.twist(hub, x)
        return contact_velocity(hub.axis, hub.contact - hub.centre, twist.v, twist.omega)

    def load_change(self, hub: Hub, x: np.ndarray) -> float:
        """Return the change of the load of a wheel in a change of the pose."""
        return -self.tangent.held.reaction(pad(hub.wheel), x)


def displacements(hub: Hub, start: Hub, load: float) -> dict[str, float]:
    """Return the measures of a wheel's pose relative to that at the described heights."""
    sign = hub.wheel.sign
    leant, at_start = (np.arctan2(each.forward[2], np.hypot(*each.forward[:2])) for each in (hub, start))
    return {
        "travel": MM * (hub.centre[2] - start.centre[2]),
        "toe": DEG * sign * np.arctan2(hub.axis[0], hub.axis[1]),
        "camber": DEG * -sign * np.arcsin(hub.axis[2]),
        "spin": DEG * (leant - at_start),
        "lateral": MM * sign * (hub.contact[1] - start.contact[1]),
        "longitudinal": MM * (hub.centre[0] - start.centre[0]),
        "load": load,
    }


def of_travel(pose: Pose, hub: Hub) -> dict[str, float]:
    """Return the measures of a wheel that follow from its motion in bump or roll."""
    sign, twist = hub.wheel.sign, pose.twist(hub, pose.motion)
    rise = twist.v[2]
    found = {"wheel_rate": 1e-3 * pose.load_change(hub, pose.motion) / rise}
    for name, spring in pose.setup.of_wheel[hub.wheel.side].items():
        found[f"motion_ratio.{name}"] = -float(pose.tangent.lengthening(spring) @ pose.motion) / rise
    found |= {
        "fvsa_length": MM * _length(sign * rise, twist.v[1], twist.omega[0]),
        "fvsa_angle": DEG * np.arctan2(sign * twist.v[1] * np.sign(rise), abs(rise)),
        "svsa_length": MM * _length(-rise, twist.v[0], twist.omega[1]),
        "svsa_angle": DEG * np.arctan2(twist.v[0] * np.sign(rise), abs(rise)),
    }
    return found | _support(pose, hub)


def _length(along: float, across: float, omega: float) -> float:
    """Return the distance to the centre of a plane motion, with the sign of its component `along` / omega; inf if none."""
    if abs(omega) * 1e9 < np.hypot(along, across):
        return float("inf")
    return float(np.hypot(along, across) / omega * np.sign(along))


def _support(pose: Pose, hub: Hub) -> dict[str, float]:
    """Return the support angles, and anti-dive, anti-lift and anti-squat, by the virtual work of the mode."""
    vehicle, twist = pose.setup.vehicle, pose.twist(hub, pose.motion)
    rise = pose.contact_velocity(hub, pose.motion)[2]
    on_carrier = twist.at(hub.contact - hub.centre)[0] / rise
    on_body = twist.v[0] / rise
    brake = on_body if vehicle.inboard_brakes else on_carrier
    drive = on_carrier if vehicle.outboard_drive else on_body
    found = {"brake_angle": DEG * np.arctan(brake), "drive_angle": DEG * np.arctan(drive)}
    if vehicle.wheelbase and vehicle.height and vehicle.front is not None:
        names, sign = (("anti_dive", "anti_lift"), 100) if vehicle.front else (("anti_lift", "anti_squat"), -100)
        parts = vehicle.brake_share * brake, vehicle.drive_share * drive
        found |= {
            name: sign * part * vehicle.wheelbase / vehicle.height for name, part in zip(names, parts, strict=True)
        }
    return found


def of_steering_axis(pose: Pose, hub: Hub) -> dict[str, float]:
    """Return the measures of the steering axis of a wheel."""
    assert pose.steered is not None
    locked = pose.steering_locked
    held, bump = pose.twist(hub, pose.steered), pose.twist(hub, pose.motion)
    found: SteeringAxis | None = steering_axis(None if locked is None else pose.twist(hub, locked), held, bump)
    if found is None:
        return {}
    direction, point = found.direction, hub.centre + found.arm
    sign, (heading, outwards) = hub.wheel.sign, hub.heading

    def offset(place: np.ndarray) -> tuple[float, float]:
        """Return the position of the axis at the height of a place: ahead of it and inwards of it, m."""
        there = point + direction * (place[2] - point[2]) / direction[2] - place
        return float(heading @ there[:2]), float(-outwards @ there[:2])

    (trail, scrub), (ahead, inwards) = offset(hub.contact), offset(hub.centre)
    return {
        "caster": DEG * np.arctan2(-direction[0], direction[2]),
        "kingpin_inclination": DEG * np.arctan2(-sign * direction[1], direction[2]),
        "scrub_radius": MM * scrub,
        "caster_trail": MM * trail,
        "spindle_offset": MM * inwards,
        "caster_offset": MM * ahead,
    }


def of_axle(pose: Pose, lifted: bool) -> dict[str, float]:
    """Return the measures of both wheels together."""
    left, right = pose.hubs
    across = left.contact - right.contact
    track = float(np.hypot(across[1], across[2]))
    found = {"track": MM * track, "roll_angle": DEG * np.arctan2(across[2], across[1])}
    if lifted:
        roll = np.asarray(pose.lifted[0] - pose.lifted[1])
        found |= _roll_centre(pose, roll)
        found["roll_rate"] = _roll_rate(pose, roll)
    if pose.steered is not None and not lifted:
        found |= _steering(pose)
    return found


def _roll_centre(pose: Pose, roll: np.ndarray) -> dict[str, float]:
    """Return the point, in the rear view, in which the normals of the contacts' paths in roll meet."""
    middle = (pose.hubs[0].contact + pose.hubs[1].contact) / 2
    paths = np.array([pose.contact_velocity(hub, roll)[1:] for hub in pose.hubs])
    right = [path @ (hub.contact - middle)[1:] for path, hub in zip(paths, pose.hubs, strict=True)]
    if abs(np.linalg.det(paths)) < PARALLEL * np.linalg.norm(paths[0]) * np.linalg.norm(paths[1]):
        parallel = float(paths[0] @ (pose.hubs[0].contact - middle)[1:])
        level = abs(parallel) < PARALLEL and abs(right[1]) < PARALLEL
        return {"roll_centre_height": 0.0 if level else np.nan, "roll_centre_lateral": 0.0 if level else np.nan}
    y, z = np.linalg.solve(paths, right)
    return {"roll_centre_height": MM * z, "roll_centre_lateral": MM * (y + middle[1] - pose.setup.plane)}


def _roll_rate(pose: Pose, roll: np.ndarray) -> float:
    """Return the change of the moment of the loads about the middle of the contacts per roll angle, N m/deg."""
    left, right = pose.hubs
    (v_left, v_right), across = ((pose.contact_velocity(hub, roll) for hub in pose.hubs), left.contact - right.contact)
    moving = v_left - v_right
    angle = (moving[2] * across[1] - moving[1] * across[2]) / (across[1] ** 2 + across[2] ** 2)
    changes = [pose.load_change(hub, roll) for hub in pose.hubs]
    moment = ((changes[0] - changes[1]) * across[1] + (pose.loads[0] - pose.loads[1]) * moving[1]) / 2
    return float(moment / angle / DEG)


def _steering(pose: Pose) -> dict[str, float]:
    """Return steer angles, the ratio of the steering, and Ackermann, which compares both wheels with a common centre."""
    assert pose.steered is not None
    rates = []
    for hub in pose.hubs:
        turn = np.cross(pose.twist(hub, pose.steered).omega, hub.axis)
        x, y = hub.axis[:2]
        rates.append((-turn[0] * y + x * turn[1]) / (x * x + y * y))
    rate, mean = float(np.mean(rates)), float(np.mean([hub.steer for hub in pose.hubs]))
    found = {
        "steer": DEG * mean,
        "steering_ratio": (1.0 if pose.setup.angular else MM / DEG) / rate if rate else np.nan,
    }
    wheelbase = pose.setup.vehicle.wheelbase
    if wheelbase:
        track = float(pose.hubs[0].contact[1] - pose.hubs[1].contact[1])
        # rear wheels that steer to the left turn to the right
        sign = -1.0 if pose.setup.vehicle.front is False else 1.0
        found |= _ackermann([sign * hub.steer for hub in pose.hubs], track / wheelbase, wheelbase)
    return found


def _ackermann(steer: list[float], part: float, wheelbase: float) -> dict[str, float]:
    """Return the difference of the steer angles relative to that of Ackermann, %, and the radius of the turn, m.

    Angles are positive in a turn to the left.
    The inner wheel's ideal angle follows from the outer one's: cot(outer) - cot(inner) = track / wheelbase.
    """
    left, right = steer
    inner, outer = (abs(left), abs(right)) if left + right > 0 else (abs(right), abs(left))
    if abs(left + right) < STRAIGHT or left * right <= 0:
        return {"ackermann": np.nan, "turning_radius": np.inf}
    ideal = float(np.arctan2(1.0, 1 / np.tan(outer) - part))
    mean = (1 / np.tan(inner) + 1 / np.tan(outer)) / 2
    return {"ackermann": 100 * (inner - outer) / (ideal - outer), "turning_radius": wheelbase * mean}
