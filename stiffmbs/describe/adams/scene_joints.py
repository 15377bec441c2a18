"""Joints, primitives and general constraints as joints of a scene."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import Any

import numpy as np

from .constraints import GeneralConstraint, Joint
from .geometry import Frame
from .mechanism import Mechanism, Place
from .plain import plain, quaternion, vector
from .translate import ANGULAR_VELOCITIES as TURNING
from .translate import VELOCITIES, Translation

KINDS = {
    "REVOLUTE": "revolute",
    "TRANSLATIONAL": "prismatic",
    "CYLINDRICAL": "cylindrical",
    "SPHERICAL": "spherical",
    "FIXED": "fixed",
    "UNIVERSAL": "universal",
    "PLANAR": "planar",
    "CONVEL": "constant_velocity",
    "ATPOINT": "spherical",
    "INLINE": "point_on_line",
    "INPLANE": "point_on_plane",
    "ORIENTATION": "orientation",
    "PARALLEL_AXES": "parallel",
    "PERPENDICULAR": "perpendicular",
}
"""Joints that take their two markers as they are."""
Z_ALONG_X = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
"""Axes whose z is the x axis of those that they are given in."""
Z_ALONG_Y = Z_ALONG_X.T
NEAR = 1e-6
"""Of a pitch diameter: how near a rack's line is to go through the pinion's centre."""


def joints(mechanism: Mechanism, translation: Translation) -> dict[str, Any]:
    """The joints of the scene by name, without those that motions and relations make."""
    dataset = mechanism.dataset
    found: dict[str, Any] = {}
    for joint in (*dataset.joints.values(), *dataset.primitives.values()):
        found[joint.name] = _joint(joint, mechanism)
    for constraint in dataset.general_constraints.values():
        found[constraint.name] = _general(constraint, mechanism, translation)
    return found


def held(mechanism: Mechanism) -> dict[str, Any]:
    """Joints that keep point masses from turning."""
    return {
        f"{mechanism.body_name(part)}_axes": {
            "type": "orientation", "i": mechanism.body_name(part), "j": _on_ground(mechanism.center(part).within(part.frame)),
        }
        for part in mechanism.moving
        if part.point
    }  # fmt: skip


def _on_ground(frame: Frame) -> Any:
    if np.array_equal(frame.axes, np.eye(3)):
        return "ground"
    return {"body": "ground", "orientation": quaternion(frame.axes)}


def _joint(joint: Joint, mechanism: Mechanism) -> dict[str, Any]:
    i, j = mechanism.place(joint.i, joint, "I"), mechanism.place(joint.j, joint, "J")
    match joint.kind:
        case "HOOKE":
            return {"type": "universal", "i": turned(i, Z_ALONG_X), "j": turned(j, Z_ALONG_Y)}
        case "SCREW":
            return {"type": "thread", "i": i.reference, "j": j.reference, "pitch": plain(joint.pitch)}
        case "RACKPIN":
            return {"type": "velocity_equation", "i": i.reference, "j": j.reference, "zero": _rolling(joint, i, j)}
    return {"type": KINDS[joint.kind], "i": i.reference, "j": j.reference}


def turned(place: Place, axes: np.ndarray) -> dict[str, Any]:
    """A marker with other axes, which are given in its own."""
    return {
        "body": place.body, "point": vector(place.on_body.point), "orientation": quaternion(place.on_body.axes @ axes),
    }  # fmt: skip


def _rolling(joint: Joint, i: Place, j: Place) -> str:
    """A pinion (marker i) and a rack (marker j) have one velocity along the rack where they touch.

    They touch beside the pinion's axis, at the point of the rack's line (the z axis of j) that is nearest to it.  A line
    through the pinion's centre does not tell on which side the rack is; then it is on that of -y of marker i, whose x is
    along the rack, as Adams' manual draws them (constraint modify joint rackpin).
    """
    I, J = i.reference, j.reference
    distance = _beside(i, j)
    if distance > NEAR * abs(joint.diameter):
        ratio = joint.diameter / 2 / distance
        factor = "" if abs(ratio - 1) < 1e-9 else f"{plain(ratio)!r} * "
        turning = f"wx({I}, ground, {J}) * dy({J}, {I}, {J}) - wy({I}, ground, {J}) * dx({J}, {I}, {J})"
        return f"vz({J}, {I}, {J}) - {factor}({turning})"
    along = float(i.drawn.axes[:, 0] @ j.drawn.axes[:, 2])
    if abs(along) < 0.5:
        raise joint.fault(
            "found the rack's line (the z axis of J) through the pinion's centre (I) and across its x axis, expected it half "
            "the pitch diameter beside it, or along its x axis"
        )
    return f"vz({J}, {I}, {J}) - {plain(np.sign(along) * joint.diameter / 2)!r} * wz({I}, {J}, {I})"


def _beside(i: Place, j: Place) -> float:
    """How far the z axis of j passes the origin of i, m."""
    across = j.drawn.axes.T @ (j.drawn.point - i.drawn.point)
    return float(np.hypot(across[0], across[1]))


def notes(mechanism: Mechanism) -> Iterator[str]:
    """What is taken for granted of racks, a sentence each."""
    for joint in mechanism.dataset.joints.values():
        if joint.kind != "RACKPIN":
            continue
        i, j = mechanism.place(joint.i, joint, "I"), mechanism.place(joint.j, joint, "J")
        if _beside(i, j) <= NEAR * abs(joint.diameter):
            yield (
                f"{joint.label}: the rack's line goes through the pinion's centre, and the rack is taken to be at -y of "
                f"MARKER/{joint.i}, half the pitch diameter away"
            )


def _general(constraint: GeneralConstraint, mechanism: Mechanism, translation: Translation) -> dict[str, Any]:
    distance = rod(constraint)
    if distance is not None:
        *ends, length = distance
        i, j = (mechanism.place(ident, constraint, "the marker").reference for ident in ends)
        return {"type": "distance", "i": i, "j": j, "length": plain(length * mechanism.dataset.units.length)}
    called = {name.id for node in ast.walk(constraint.function.tree) for name in _callee(node)}
    kind = "velocity_equation" if called & {*VELOCITIES, *TURNING} else "equation"
    reported = {} if constraint.i is None else {"i": mechanism.place(constraint.i, constraint, "I").reference}
    return {"type": kind, **reported, "zero": translation.formula(constraint.function)}


def _callee(node: ast.AST) -> Iterator[ast.Name]:
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
        yield node.func


def rod(constraint: GeneralConstraint) -> tuple[int, int, float] | None:
    """The markers of a distance that stays as long as a number says, and that number; None for anything else."""
    match constraint.function.tree:
        case ast.BinOp(
            ast.Call(ast.Name("DM"), [ast.Constant(int() as a), ast.Constant(int() as b)]),
            ast.Sub(),
            ast.Constant(int() | float() as length),
        ) if a and b and length:
            return (b, a, length) if constraint.i == b else (a, b, length)
    return None


def markers_of(constraint: GeneralConstraint, mechanism: Mechanism) -> tuple[int, ...]:
    """The markers that a general constraint's function names: the one that its reaction is asked for on first."""
    named = [
        argument.value
        for node in ast.walk(constraint.function.tree)
        if isinstance(node, ast.Call)
        for argument in node.args
        if isinstance(argument, ast.Constant)
        and isinstance(argument.value, int)
        and argument.value in mechanism.dataset.markers
    ]
    first = [] if constraint.i is None else [constraint.i]
    return tuple(dict.fromkeys([*first, *named]))
