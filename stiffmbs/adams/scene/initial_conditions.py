"""Initial conditions of joints.  MSC Adams/Solver, JOINT statement, IC, ICROT, ICTRAN.

A joint's initial velocity applies to a part without one of its own. A part without any information is assumed at rest
and follows the others at assembly. If displacements or velocities differ from those of the parts, all joint initial
conditions become constraints at the start only, and assembly moves the parts.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ...elements.spatial.number_format import plain
from ..statements.bodies import Part, Vector
from ..statements.changes import Key
from ..statements.constraints import ROTATIONAL, Joint, Start
from ..statements.dataset import Dataset
from ..statements.geometry import IDENTITY, PRECISION
from .mechanism import Mechanism, Place
from .relations import coordinate, initial_displacement

Twist = tuple[np.ndarray, np.ndarray]
"""Velocity of the centre of mass and angular velocity of a part, in ground axes."""


def set_in_motion(mechanism: Mechanism) -> Dataset:
    """Return the dataset with joint initial velocities assigned to parts without velocities."""
    dataset = mechanism.dataset
    known = {key: _stated(mechanism, part) for key, part in mechanism.parts.items() if _states(part)}
    reported = set(known)
    waiting = [joint for joint in _stating(dataset) if any(velocity is not None for _, _, velocity in joint.start)]
    while waiting:
        joint = next((joint for joint in waiting if any(key in known for key in _joined(mechanism, joint))), waiting[0])
        waiting.remove(joint)
        if not any(key in known for key in _joined(mechanism, joint)):  # assumed at rest
            at_rest = _joined(mechanism, joint)[1]
            known[at_rest] = np.zeros(3), np.zeros(3)
            reported.add(at_rest)
        _move(mechanism, joint, known)
    statements = {keyword: dict(numbered) for keyword, numbered in dataset.statements.items()}
    for key, twist in known.items():
        if key not in reported:
            statements[key[0]][key[1]] = _moving(mechanism, mechanism.parts[key], twist)
    return replace(dataset, statements=statements)


def at_start(mechanism: Mechanism) -> dict[str, object]:
    """Return the joint initial conditions as drives at the start only, by name; empty if the parts satisfy them."""
    stating = _stating(mechanism.dataset)
    if not any(_differs(mechanism, joint) for joint in stating):
        return {}
    drives: dict[str, object] = {}
    for joint in stating:
        for sort, displacement, velocity in joint.start:
            given = {"position": displacement, "velocity": velocity}
            for what, value in given.items():
                if value is not None:
                    name = f"{joint.name}_{'turn' if sort == ROTATIONAL else 'slide'}_{what}"
                    drives[name] = {"type": "drive", "joint": coordinate(joint, sort), what: plain(value)}
    return drives


def _stating(dataset: Dataset) -> list[Joint]:
    """Return the joints with initial conditions of coordinates without a motion, and only with these conditions."""
    free = (replace(joint, start=_undriven(joint, dataset)) for joint in dataset.joints.values())
    return [joint for joint in free if joint.start]


def _undriven(joint: Joint, dataset: Dataset) -> tuple[Start, ...]:
    sorts = [motion.sort for motion in dataset.motions.values() if motion.joint == joint.ident]
    return tuple(start for start in joint.start if not {start[0], None} & {*sorts})


def _differs(mechanism: Mechanism, joint: Joint) -> bool:
    """Return True if a joint's initial conditions differ from those of its parts."""
    i, j = mechanism.ends(joint)
    known = {key: _stated(mechanism, mechanism.parts[key]) for key in _joined(mechanism, joint)}
    pairs = []
    for sort, displacement, velocity in joint.start:
        pairs += [(displacement, initial_displacement(sort, i, j))] if displacement is not None else []
        pairs += [(velocity, _relative(mechanism, joint, sort, known))] if velocity is not None else []
    return any(abs(stated - found) > PRECISION * max(1.0, abs(found)) for stated, found in pairs)


def _relative(mechanism: Mechanism, joint: Joint, sort: str, known: dict[Key, Twist]) -> float:
    """Return the velocity of a joint from the velocities of its parts."""
    i, j = mechanism.ends(joint)
    one, other = _joined(mechanism, joint)
    if sort == ROTATIONAL:
        found = known[one][1] - known[other][1]
    else:
        found = _at(mechanism, one, known[one], i) - _at(mechanism, other, known[other], i)
    return float(found @ j.initial.axes[:, 2])


def notes(dataset: Dataset) -> Iterator[str]:
    """Yield a sentence that lists the initial conditions without effect."""
    left_out = [joint.label for joint in dataset.joints.values() if joint.start != _undriven(joint, dataset)]
    if left_out:
        yield f"initial conditions of {', '.join(left_out)} are left out: a MOTION prescribes these coordinates"


def _states(part: Part) -> bool:
    return part.ground or part.velocity is not None or part.omega is not None


def _stated(mechanism: Mechanism, part: Part) -> Twist:
    """Return the stated velocities of a part, zero if unspecified."""
    initial = mechanism.center(part).within(part.frame)
    return (
        in_ground(mechanism, part, part.velocity, part.velocity_marker, IDENTITY),
        in_ground(mechanism, part, part.omega, part.omega_marker, initial.axes),
    )


def _joined(mechanism: Mechanism, joint: Joint) -> tuple[Key, Key]:
    """Return the parts of markers I and J."""
    mechanism.ends(joint)
    return mechanism.dataset.markers[joint.i].owner, mechanism.dataset.markers[joint.j].owner


def _move(mechanism: Mechanism, joint: Joint, known: dict[Key, Twist]) -> None:
    """Add the motion of the second part of a joint if only one is known."""
    i, j = mechanism.ends(joint)
    one, other = _joined(mechanism, joint)
    axis = j.initial.axes[:, 2]
    rates = {sort == ROTATIONAL: velocity or 0.0 for sort, _, velocity in joint.start}
    sliding, turning = rates.get(False, 0.0) * axis, rates.get(True, 0.0) * axis
    if one in known and other in known:
        return
    if one in known:
        omega = known[one][1] - turning
        at_i = _at(mechanism, one, known[one], i)
        velocity = at_i - sliding - np.cross(omega, i.initial.point - j.initial.point)
        known[other] = _of_center(mechanism, other, velocity, omega, j)
        return
    at_i = _at(mechanism, other, known[other], i) + sliding
    known[one] = _of_center(mechanism, one, at_i, known[other][1] + turning, i)


def _center(mechanism: Mechanism, key: Key) -> np.ndarray:
    part = mechanism.parts[key]
    return mechanism.center(part).within(part.frame).point


def _at(mechanism: Mechanism, key: Key, twist: Twist, place: Place) -> np.ndarray:
    """Return the velocity of a part at a marker, m/s."""
    velocity, omega = twist
    return np.asarray(velocity + np.cross(omega, place.initial.point - _center(mechanism, key)))


def _of_center(mechanism: Mechanism, key: Key, velocity: np.ndarray, omega: np.ndarray, place: Place) -> Twist:
    """Return the motion of a part from the velocity of its marker."""
    return velocity + np.cross(omega, _center(mechanism, key) - place.initial.point), omega


def _moving(mechanism: Mechanism, part: Part, twist: Twist) -> Part:
    """Return the part with a velocity in ground axes and an angular velocity in centre-of-mass marker axes."""
    velocity, omega = twist[0], mechanism.center(part).within(part.frame).axes.T @ twist[1]
    stated: list[Vector] = [(float(v[0]), float(v[1]), float(v[2])) for v in (velocity, omega)]
    return replace(part, velocity=stated[0], omega=stated[1], velocity_marker=None, omega_marker=None)


def in_ground(
    mechanism: Mechanism, part: Part, rates: Vector | None, marker: int | None, axes: np.ndarray
) -> np.ndarray:
    """Return rates given in marker axes (without a marker, in `axes`) in ground axes; zero if not given."""
    if rates is None:
        return np.zeros(3)
    return (axes if marker is None else mechanism.place(marker, part, "VM or WM").initial.axes) @ np.array(rates)
