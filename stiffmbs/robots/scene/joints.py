"""Conversion of bodies and joints, with their springs, dampers and friction."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

import numpy as np

from ...elements.spatial.body import MOMENT_ROUNDING
from ...elements.spatial.marker import ORIGIN
from ...elements.spatial.massless import MASSLESS, breaks_triangle, filled, lacks_inertia, massless_moment
from ...elements.spatial.number_format import plain, vector
from ...elements.spatial.orientation import IDENTITY, conjugate, rotated
from ...reading.files.yaml_text import Content
from ..pose import Placed
from ..robot import Connection, Link, LinkJoint, Relation, Robot, RobotFault
from .mechanism import Hold, Mechanism


class Masses:
    """Small mass and inertia for massless links: fractions of the lightest mass, at the mechanism's size.

    `word`: what the links are called in messages.
    """

    def __init__(self, links: Iterable[Link], frames: Iterable[Placed], word: str = "link") -> None:
        least = min((link.mass for link in links if link.mass > 0), default=0.0)
        if least == 0:
            raise RobotFault(f"found no {word} with a mass, expected one at least")
        self.lightest = least
        self.mass = MASSLESS * least
        self.moment = massless_moment(least, [frame.position for frame in frames])


def bodies(mechanism: Mechanism, masses: Masses) -> Content:
    """Return the bodies by name, with their markers."""
    found = {}
    for name, (link, frame) in mechanism.bodies.items():
        between = name in mechanism.between
        body = _between(link, masses) if between else rigid_body(link, masses)
        markers = mechanism.markers.get(name)
        centre = (0.0, 0.0, 0.0) if between else link.center_of_mass
        found[name] = body | motion(frame, centre) | ({"markers": markers} if markers else {})
    return found


def notes(mechanism: Mechanism) -> list[str]:
    """Return a note on inertias that no distribution of mass has."""
    return odd_inertias({name: link for name, (link, _) in mechanism.bodies.items() if name not in mechanism.between})


def odd_inertias(links: Mapping[str, Link]) -> list[str]:
    """Return a note on the inertias of links, by name, that no distribution of mass has."""
    odd = [name for name, link in links.items() if breaks_triangle(link.inertia)]
    return (
        [f"the largest moment of inertia of {', '.join(odd)} is greater than the sum of the other two"] if odd else []
    )


def _between(link: Link, masses: Masses) -> dict[str, object]:
    """Return a massless body between joints of a link: small fractions of the link's mass and inertia, if any."""
    c = np.array(link.center_of_mass)
    moment = float(np.linalg.eigvalsh(link.inertia)[-1] + link.mass * (c @ c)) * MASSLESS
    return {"mass": link.mass * MASSLESS or masses.mass, "inertia": [moment or masses.moment] * 3}


def rigid_body(link: Link, masses: Masses, word: str = "link") -> dict[str, object]:
    """Return the body of a link; missing mass and inertia are small ones. `word`: what it is called in messages."""
    tensor = link.inertia
    if not np.all(np.isfinite(tensor)):
        raise RobotFault(f"{word} {link.name}: found moments of inertia above 1e308 kg m^2, expected finite values")
    moments = np.linalg.eigvalsh(tensor)
    if moments[0] < -MOMENT_ROUNDING * max(moments[-1], masses.moment) or not np.all(np.isfinite(moments)):
        raise RobotFault(
            f"{word} {link.name}: found the principal moments of inertia {', '.join(f'{x:g}' for x in moments)} kg m^2, expected none below 0"
        )
    body: dict[str, object] = {"mass": plain(link.mass or masses.mass)}
    if moments[0] < 0:  # rounding error
        axes = np.linalg.eigh(tensor)[1]
        tensor = (axes * np.maximum(moments, 0.0)) @ axes.T
    if moments[-1] <= MOMENT_ROUNDING * masses.moment:
        tensor = np.diag([masses.moment] * 3)
    elif lacks_inertia(tensor):
        tensor = filled(tensor, masses.moment)
    if breaks_triangle(tensor):
        body["any_moments"] = True
    diagonal = not np.any(tensor - np.diag(np.diag(tensor)))
    body["inertia"] = vector(np.diag(tensor)) if diagonal else [vector(row) for row in tensor]
    if any(link.center_of_mass):
        body["center_of_mass"] = vector(link.center_of_mass)
    return body


def motion(frame: Placed, center_of_mass: tuple[float, ...]) -> Content:
    """Return the initial pose and velocities of a body."""
    found: dict[str, object] = {"position": vector(frame.position)}
    if frame.orientation != (1.0, 0.0, 0.0, 0.0):
        found["orientation"] = vector(frame.orientation)
    velocity, omega = (
        frame.velocity_at(frame.point(center_of_mass)),
        rotated(conjugate(frame.orientation), tuple(frame.omega)),
    )
    return found | {key: vector(rate) for key, rate in (("velocity", velocity), ("omega", omega)) if np.any(rate)}


KINDS = {"hinge": "revolute", "slide": "prismatic", "screw": "screw", "ball": "spherical"}
CREEP = {"hinge": 1e-3, "slide": 1e-4, "screw": 1e-3}
"""Transition rate of smoothed dry friction, rad/s or m/s."""


def joints(robot: Robot, mechanism: Mechanism) -> Content:
    """Return the scene's joints by name."""
    found = {hold.name: _joint(hold) for hold in mechanism.holds.values()}
    found |= {name: {"type": "fixed", "i": i, "j": j} for name, (i, j) in mechanism.fixed.items()}
    found |= {name: entry for relation in robot.relations for name, entry in _relation(mechanism, relation)}
    found |= {name: entry for connection in robot.connections for name, entry in _connection(mechanism, connection)}
    return found


def _joint(hold: Hold) -> Content:
    entry: Content = {"type": KINDS[hold.joint.kind], "i": hold.i, "j": hold.j}
    if hold.joint.kind == "screw":
        pitch = hold.joint.pitch
        entry |= {"pitch": plain(pitch), "offset": plain(pitch * hold.turns / (2 * np.pi))}
    return entry


def passive(robot: Robot, mechanism: Mechanism) -> Content:
    """Return springs, dampers and dry friction of the joints, and dampers of free links."""
    found = {name: entry for hold in mechanism.holds.values() for name, entry in _passive(mechanism, hold)}
    free = [(link, joint) for link in robot.links for joint in link.joints if joint.kind == "free" and joint.damping]
    return found | {name: entry for link, joint in free for name, entry in _damped(mechanism, link, joint)}


def _damped(mechanism: Mechanism, link: Link, joint: LinkJoint) -> Iterator[tuple[str, dict[str, object]]]:
    """Yield a damping force at the origin of a free link, and a damping torque."""
    names = [mechanism.names.take(f"{joint.name}_{what}") for what in ("damper", "rotary_damper")]
    marker = mechanism.mark(link.name, names[0], ORIGIN)
    for name, kind, rate in zip(names, ("force", "torque"), "vw", strict=True):
        formulas = [f"-{plain(joint.damping)}*{rate}{axis}({marker})" for axis in "xyz"]
        yield name, {"type": kind, "i": marker, kind: formulas}


def _passive(mechanism: Mechanism, hold: Hold) -> Iterator[tuple[str, dict[str, object]]]:
    joint, ends = hold.joint, {"i": hold.i, "j": hold.j}
    rest = plain(joint.rest - hold.zero)
    k, d = plain(joint.stiffness), plain(joint.damping)
    if (k or d) and joint.is_rotary:
        spring: dict[str, object] = {"type": "torsion_spring", **ends}
        spring |= {"stiffness": k, "free_angle": rest} if k else {}
        yield mechanism.names.take(f"{hold.name}_spring"), spring | ({"damping": d} if d else {})
    elif k or d:
        along = (lambda x: [0, 0, x, 0, 0, 0]) if joint.kind == "slide" else (lambda x: [0, 0, 0, x, x, x])
        spring = {"type": "bushing", **ends}
        spring |= {"stiffness": along(k)} if k else {}
        spring |= {"preload": along(plain(joint.stiffness * rest))} if k and rest else {}
        yield mechanism.names.take(f"{hold.name}_spring"), spring | ({"damping": along(d)} if d else {})
    if joint.friction:
        formula = f"-{plain(joint.friction)}*tanh({hold.rate}/{CREEP[joint.kind]})"
        yield mechanism.names.take(f"{hold.name}_friction"), along_axis(hold, formula)


def along_axis(hold: Hold, formula: str) -> dict[str, object]:
    """Return a torque about the axis of a hinge or screw, or a force along a slide axis, on marker i with its reaction on j."""
    kind = "torque" if hold.joint.is_rotary else "force"
    return {"type": kind, "i": hold.i, "j": hold.j, "frame": hold.j, kind: [0, 0, formula]}


def _relation(mechanism: Mechanism, relation: Relation) -> Iterator[tuple[str, Content]]:
    hold = mechanism.holds.get(relation.joint)
    other = None if relation.other is None else mechanism.holds.get(relation.other)
    if hold is None or (relation.other is not None and other is None):
        return  # a joint that moves no mass
    name = mechanism.names.take(relation.name)
    first, *rest = relation.coefficients
    if other is not None and rest and rest[0] and not any(rest[1:]):
        ratio = {"joint_1": hold.reference, "joint_2": other.reference, "scale": plain(rest[0])}
        yield name, {"type": "coupler", **ratio, "offset": plain(first + rest[0] * other.turns - hold.turns)}
        return
    x = "" if other is None else f"({other.coordinate} - {other.joint.zero!r})"
    terms = [repr(first), *(f"{c!r}*{x}^{k}" for k, c in enumerate(rest, 1) if c and x)]
    yield name, {"type": "equation", "zero": f"{hold.coordinate} - {hold.joint.zero!r} - ({' + '.join(terms)})"}


def _connection(mechanism: Mechanism, connection: Connection) -> Iterator[tuple[str, Content]]:
    name = mechanism.names.take(connection.name)
    i = mechanism.mark(connection.link, name, connection.point, connection.orientation or IDENTITY)
    j = mechanism.mark(connection.other, f"{name}_j", connection.other_point)
    yield name, {"type": "spherical" if connection.orientation is None else "fixed", "i": i, "j": j}
