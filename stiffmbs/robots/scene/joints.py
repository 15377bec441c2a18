"""Conversion of joints, with their springs, dampers and friction."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from ...elements.spatial.marker import ORIGIN
from ...elements.spatial.number_format import plain
from ...elements.spatial.orientation import IDENTITY
from ..robot import Connection, Link, LinkJoint, Relation, Robot
from .mechanism import Hold, Mechanism

KINDS = {"hinge": "revolute", "slide": "prismatic", "ball": "spherical"}
CREEP = {"hinge": 1e-3, "slide": 1e-4}
"""Transition rate of smoothed dry friction, rad/s or m/s."""


def joints(robot: Robot, mechanism: Mechanism) -> dict[str, Any]:
    """Return the scene's joints by name."""
    found = {hold.name: {"type": KINDS[hold.joint.kind], "i": hold.i, "j": hold.j} for hold in mechanism.holds.values()}
    found |= {name: {"type": "fixed", "i": i, "j": j} for name, (i, j) in mechanism.fixed.items()}
    found |= {name: entry for relation in robot.relations for name, entry in _relation(mechanism, relation)}
    found |= {name: entry for connection in robot.connections for name, entry in _connection(mechanism, connection)}
    return found


def passive(robot: Robot, mechanism: Mechanism) -> dict[str, Any]:
    """Return springs, dampers and dry friction of the joints, and dampers of free links."""
    found = {name: entry for hold in mechanism.holds.values() for name, entry in _passive(mechanism, hold)}
    free = [(link, joint) for link in robot.links for joint in link.joints if joint.kind == "free" and joint.damping]
    return found | {name: entry for link, joint in free for name, entry in _damped(mechanism, link, joint)}


def _damped(mechanism: Mechanism, link: Link, joint: LinkJoint) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield a damping force at the origin of a free link, and a damping torque."""
    names = [mechanism.names.take(f"{joint.name}_{what}") for what in ("damper", "rotary_damper")]
    marker = mechanism.mark(link.name, names[0], ORIGIN)
    for name, kind, rate in zip(names, ("force", "torque"), "vw", strict=True):
        formulas = [f"-{plain(joint.damping)}*{rate}{axis}({marker})" for axis in "xyz"]
        yield name, {"type": kind, "i": marker, kind: formulas}


def _passive(mechanism: Mechanism, hold: Hold) -> Iterator[tuple[str, dict[str, Any]]]:
    joint, ends = hold.joint, {"i": hold.i, "j": hold.j}
    rest = plain(joint.rest - joint.zero)
    k, d = plain(joint.stiffness), plain(joint.damping)
    if (k or d) and joint.kind == "hinge":
        spring: dict[str, Any] = {"type": "torsion_spring", **ends}
        spring |= {"stiffness": k, "free_angle": rest} if k else {}
        yield mechanism.names.take(f"{hold.name}_spring"), spring | ({"damping": d} if d else {})
    elif k or d:
        along = (lambda x: [0, 0, x, 0, 0, 0]) if joint.kind == "slide" else (lambda x: [0, 0, 0, x, x, x])
        spring = {"type": "bushing", **ends}
        spring |= {"stiffness": along(k)} if k else {}
        spring |= {"preload": along(plain(joint.stiffness * (joint.rest - joint.zero)))} if k and rest else {}
        yield mechanism.names.take(f"{hold.name}_spring"), spring | ({"damping": along(d)} if d else {})
    if joint.friction:
        formula = f"-{plain(joint.friction)}*tanh({hold.rate}/{CREEP[joint.kind]})"
        yield mechanism.names.take(f"{hold.name}_friction"), along_axis(hold, formula)


def along_axis(hold: Hold, formula: str) -> dict[str, Any]:
    """Return a torque about a hinge axis, or a force along a slide axis, on marker i with its reaction on j."""
    kind = "torque" if hold.joint.kind == "hinge" else "force"
    return {"type": kind, "i": hold.i, "j": hold.j, "frame": hold.j, kind: [0, 0, formula]}


def _relation(mechanism: Mechanism, relation: Relation) -> Iterator[tuple[str, dict[str, Any]]]:
    hold = mechanism.holds.get(relation.joint)
    other = None if relation.other is None else mechanism.holds.get(relation.other)
    if hold is None or (relation.other is not None and other is None):
        return  # a joint that moves no mass
    name = mechanism.names.take(relation.name)
    first, *rest = relation.coefficients
    if other is not None and rest and rest[0] and not any(rest[1:]):
        ratio = {"joint_1": hold.name, "joint_2": other.name, "scale": plain(rest[0])}
        yield name, {"type": "coupler", **ratio, "offset": plain(first)}
        return
    x = "" if other is None else f"({other.coordinate} - {other.joint.zero!r})"
    terms = [repr(first), *(f"{c!r}*{x}^{k}" for k, c in enumerate(rest, 1) if c and x)]
    yield name, {"type": "equation", "zero": f"{hold.coordinate} - {hold.joint.zero!r} - ({' + '.join(terms)})"}


def _connection(mechanism: Mechanism, connection: Connection) -> Iterator[tuple[str, dict[str, Any]]]:
    name = mechanism.names.take(connection.name)
    i = mechanism.mark(connection.link, name, connection.point, connection.orientation or IDENTITY)
    j = mechanism.mark(connection.other, f"{name}_j", connection.other_point)
    yield name, {"type": "spherical" if connection.orientation is None else "fixed", "i": i, "j": j}
