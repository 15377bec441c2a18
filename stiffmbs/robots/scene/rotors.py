"""Rotor inertias of joints (MJCF: armature; Featherstone, Rigid Body Dynamics Algorithms, sec. 9.6).

A joint with the armature I has the additional kinetic energy I q'^2/2. A rotor on ground that rotates, or slides
perpendicular to gravity, by the joint's coordinate has exactly that energy and no other effect.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...elements.spatial.number_format import plain, vector
from ..robot import LinkJoint, Robot, RobotFault
from .bodies import Masses
from .mechanism import Mechanism, along_z


def add_rotors(
    found: dict[str, dict[str, Any]], robot: Robot, mechanism: Mechanism, masses: Masses, rates: Mapping[str, float]
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


def _inertia(joint: LinkJoint, masses: Masses) -> dict[str, Any]:
    if joint.kind == "hinge":
        return {"mass": plain(masses.lightest), "inertia": [plain(joint.armature)] * 3}
    return {"mass": plain(joint.armature), "inertia": [masses.moment] * 3}


def _rate(joint: LinkJoint, rate: float, robot: Robot) -> dict[str, Any]:
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
