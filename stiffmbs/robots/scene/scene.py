"""Conversion of a robot to a scene mapping."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import inf

import numpy as np
from numpy.polynomial import Polynomial

from ...elements.spatial.number_format import plain, vector
from ...reading.files.yaml_text import Content
from ...reading.marker import GROUND
from ..robot import LinkJoint, Robot, RobotFault
from .actuators import actuators
from .contacts import contacts
from .joints import Masses, bodies, joints, passive
from .joints import notes as body_notes
from .limits import stops
from .mechanism import Mechanism, along_z

RUN = {"duration": 1, "output": 0.01}
"""Default run settings, which robot files lack."""


def scene(robot: Robot, coordinates: Mapping[str, float], rates: Mapping[str, float], limits: bool) -> Content:
    """Return the scene of a robot for `stiffmbs.model.read_scene.read_scene`.

    `coordinates`, `rates`: initial coordinates of hinges and slides, rad or m, and their rates; others follow these, or
    are as drawn, and at rest. `limits`: True if stops hold joints within their limits. Raises RobotFault if the robot has features without an equivalent in a scene.
    """
    _check_joints(robot, {**coordinates, **rates})
    coordinates, rates = _with_followers(robot, coordinates, rates)
    mechanism = Mechanism(robot, coordinates, rates)
    masses = Masses(robot.links, [frame for _, frame in mechanism.bodies.values()])
    acting = actuators(robot, mechanism)
    of_stops, stopping = stops(robot, mechanism, coordinates) if limits else ({}, {})
    touching = contacts(robot, mechanism, coordinates)
    found: Content = {
        "name": robot.name,
        "dimensions": 3,
        "gravity": vector(robot.gravity),
        "parameters": of_stops | touching.parameters,
        "markers": mechanism.markers.get(GROUND, {}),
        "bodies": {},
        "joints": joints(robot, mechanism),
        "inputs": acting.inputs,
        "states": acting.states,
        "variables": acting.variables,
        "forces": passive(robot, mechanism) | acting.forces | stopping | touching.forces | _lifted(robot, mechanism),
        "run": dict(RUN),
    }
    found["bodies"] = bodies(mechanism, masses)  # includes markers added by the other sections
    found["markers"] = mechanism.markers.get(GROUND, {})
    add_rotors(found, robot, mechanism, masses, rates)
    found["notes"] = [
        *robot.notes,
        *body_notes(mechanism),
        *_limits(mechanism, coordinates, limits),
        *touching.notes,
        *_notes(mechanism),
    ]
    return {key: value for key, value in found.items() if value or key == "bodies"}


def _check_joints(robot: Robot, given: Mapping[str, float]) -> None:
    known = {name for name, joint in robot.joints().items() if joint.is_single}
    for name in given:
        if name not in known:
            raise RobotFault(
                f"found the joint {name}, expected one of {', '.join(sorted(known)) or 'none (the robot has no joints)'}"
            )


def _lifted(robot: Robot, mechanism: Mechanism) -> Content:
    """Return the forces that balance the weight of links, at their centres of mass."""
    found = {}
    for link in robot.links:
        if link.lifted and link.mass:
            name = mechanism.names.take(f"{link.name}_lift")
            marker = mechanism.mark(link.name, name, link.center_of_mass)
            force = -link.lifted * link.mass * np.array(robot.gravity)
            found[name] = {"type": "force", "i": marker, "force": vector(force)}
    return found


def _limits(mechanism: Mechanism, coordinates: Mapping[str, float], held: bool) -> Iterator[str]:
    """Yield notes on the limits of joints: whether a run holds them, and joints that start beyond theirs."""
    words, beyond = [], []
    for hold in mechanism.holds.values():
        if not hold.joint.is_limited:
            continue
        unit = "rad" if hold.joint.is_rotary else "m"
        limits, speed = hold.joint.limits or (-inf, inf), hold.joint.speed
        parts = [] if hold.joint.limits is None else [f"{plain(limits[0]):g} .. {plain(limits[1]):g} {unit}"]
        parts += [] if speed is None else [f"{plain(speed):g} {unit}/s"]
        words.append(f"{hold.name} {' and '.join(parts)}")
        start = coordinates.get(hold.joint.name, hold.joint.zero)
        if not limits[0] <= start <= limits[1]:
            beyond.append(f"{hold.name} at {plain(start):g} {unit}")
    if words and held:
        yield f"stops hold joints within their limits: {', '.join(words)}"
    elif words:
        yield f"joints have limits that a run does not hold (convert --limits adds stops): {', '.join(words)}"
    if beyond:
        yield f"joints start beyond their limits: {', '.join(beyond)}"


def _notes(mechanism: Mechanism) -> Iterator[str]:
    if mechanism.unmoved:
        yield f"joints that move no mass stay where they are: {', '.join(mechanism.unmoved)}"
    slight = [name for name, (link, _) in mechanism.bodies.items() if name in mechanism.between or link.mass == 0]
    if slight:
        yield f"bodies without mass have a slight one, 1e-8 of another's: {', '.join(slight)}"
    rubbing = [hold.name for hold in mechanism.holds.values() if hold.joint.friction]
    if rubbing:
        yield f"dry friction is smooth within 1e-3 rad/s or 1e-4 m/s: {', '.join(rubbing)}"


def add_rotors(
    found: dict[str, dict[str, object]], robot: Robot, mechanism: Mechanism, masses: Masses, rates: Mapping[str, float]
) -> None:
    """Add a rotor for each joint with an armature to the bodies and joints of a scene."""
    across = along_z(_across(robot.gravity))
    for hold in mechanism.holds.values():
        joint = hold.joint
        if joint.armature == 0:
            continue
        if joint.kind not in ("hinge", "slide") or joint.armature < 0:
            raise RobotFault(
                f"joint {joint.name}: found an armature on a {joint.kind} joint, expected a hinge or slide"
            )
        rotor, shaft, tie = (mechanism.names.take(f"{hold.name}_{part}") for part in ("rotor", "shaft", "armature"))
        axes = {} if joint.kind == "hinge" else {"orientation": vector(across)}
        found["bodies"][rotor] = _inertia(joint, masses) | axes | _rate(joint, rates.get(joint.name, 0.0), robot)
        kind = "revolute" if joint.kind == "hinge" else "prismatic"
        found["joints"][shaft] = {"type": kind, "i": rotor, "j": {"body": "ground"} | axes}
        found["joints"][tie] = {"type": "coupler", "joint_1": hold.name, "joint_2": shaft, "scale": 1}


def _inertia(joint: LinkJoint, masses: Masses) -> dict[str, object]:
    if joint.kind == "hinge":
        return {"mass": plain(masses.lightest), "inertia": [plain(joint.armature)] * 3}
    return {"mass": plain(joint.armature), "inertia": [masses.moment] * 3}


def _rate(joint: LinkJoint, rate: float, robot: Robot) -> dict[str, object]:
    if not rate:
        return {}
    if joint.kind == "hinge":
        return {"omega": [0, 0, plain(rate)]}
    return {"velocity": vector(rate * np.array(_across(robot.gravity)))}


def _across(gravity: tuple[float, ...]) -> tuple[float, ...]:
    g = np.array(gravity)
    direction = np.eye(3)[np.argmin(np.abs(g))]
    if np.any(g):
        direction = direction - (direction @ g) / (g @ g) * g
    return tuple(map(float, direction / np.linalg.norm(direction)))


def _with_followers(
    robot: Robot, coordinates: Mapping[str, float], rates: Mapping[str, float]
) -> tuple[dict[str, float], dict[str, float]]:
    """Return the initial coordinates and rates of joints with those of the joints that follow them.

    A follower whose coordinate is given moves the joint that it follows. Without this, the assembly would share an offset
    among both joints.
    """
    found, moving, joints = dict(coordinates), dict(rates), robot.joints()
    for one in robot.relations * len(robot.relations):  # backwards along chains of any order
        if one.joint in found and one.other in joints and one.other not in found:
            first, *slope = np.trim_zeros(one.coefficients, "b") or (0.0,)
            if len(slope) == 1:
                s = found[one.joint] - joints[one.joint].zero
                found[one.other] = joints[one.other].zero + (s - first) / slope[0]
    left = {one.joint: one for one in robot.relations if one.joint not in found and one.joint in joints}
    while left:
        ready = [one for one in left.values() if one.other not in left]
        if not ready:  # joints that follow each other in a circle
            break
        for one in ready:
            del left[one.joint]
            law, joint = Polynomial(np.array(one.coefficients or (0.0,))), joints[one.joint]
            other = joints.get(one.other) if one.other is not None else None
            s = 0.0 if other is None else found.get(other.name, other.zero) - other.zero
            found[one.joint] = joint.zero + float(law(s))
            rate = 0.0 if other is None else moving.get(other.name, 0.0) * float(law.deriv()(s))
            if rate:
                moving.setdefault(one.joint, rate)
    return found, moving
