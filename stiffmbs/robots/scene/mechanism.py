"""Bodies and joint markers of a robot's links."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ...elements.spatial.marker import ORIGIN
from ...elements.spatial.number_format import vector
from ...elements.spatial.orientation import IDENTITY, from_matrix, product, rotated
from ...reading.files.yaml_text import Content
from ...reading.formula.functions import FUNCTIONS
from ...reading.marker import GROUND
from ...reading.units.units import UNITS
from ..pose import Placed, frames
from ..robot import Closure, Link, LinkJoint, Robot

ROUNDING = 1e-12
"""Tolerance, in turns, within which an initial angle counts as half a turn; measures then give a positive angle."""


class Names:
    """Registry of unique scene names of letters, digits and _."""

    def __init__(self) -> None:
        self._taken = {GROUND, "t", "pi", *UNITS, *FUNCTIONS}

    def take(self, wanted: str, what: str = "") -> str:
        """Return the name if valid and free, else a similar one with a suffix: `what`, or a number."""
        name = re.sub(r"[^0-9A-Za-z_]", "_", wanted) or "_"
        name = f"_{name}" if name[0].isdigit() else name
        name = f"{name}_{what}" if what and name in self._taken else name
        found, k = name, 2
        while found in self._taken:
            found, k = f"{name}_{k}", k + 1
        self._taken.add(found)
        return found


@dataclass(frozen=True)
class Seat:
    """Frame fixed on a body of the scene: position (m) and orientation in the body's axes."""

    body: str
    position: tuple[float, ...] = ORIGIN
    orientation: tuple[float, ...] = IDENTITY

    def on(self, position: tuple[float, ...], orientation: tuple[float, ...]) -> Seat:
        """Return a frame given relative to this one."""
        place = np.array(self.position) + rotated(self.orientation, position)
        return Seat(self.body, tuple(map(float, place)), product(self.orientation, orientation))


@dataclass(frozen=True)
class Hold:
    """Joint of the robot in the scene.

    `name`: name of the scene's joint. `i`, `j`: markers on the child and the parent side; their z axes are the joint's,
    and they coincide at the joint's zero. `turns`: angle of the whole turns at the start, rad, which measures of angles
    lack.
    """

    joint: LinkJoint
    name: str
    i: str
    j: str
    turns: float = 0.0

    @property
    def zero(self) -> float:
        """Coordinate at which the measured angle or displacement is zero, rad or m."""
        return self.joint.zero + self.turns

    @property
    def coordinate(self) -> str:
        """Formula of the joint's coordinate, rad or m."""
        measure = f"az({self.i}, {self.j})" if self.joint.is_rotary else f"dz({self.i}, {self.j}, {self.j})"
        return f"({measure} + {self.zero!r})" if self.zero else measure

    @property
    def rate(self) -> str:
        """Formula of its rate, rad/s or m/s."""
        return f"{'wz' if self.joint.is_rotary else 'vz'}({self.i}, {self.j}, {self.j})"

    @property
    def reference(self) -> str:
        """Name of the coordinate in couplers."""
        return f"{self.name}.angle" if self.joint.kind == "screw" else self.name


class Mechanism:
    """Bodies of the links, their initial poses and their markers.

    A link that moves, or has mass or inertia, is a body. A fixed link without either is a marker on its parent body. A
    link with several joints has a massless body between each two of them. Joints that move no mass are omitted.
    """

    def __init__(self, robot: Robot, coordinates: Mapping[str, float], rates: Mapping[str, float]) -> None:
        self.names = Names()
        # Each body with its link, or with the link that the joints carry if it is between joints.
        self.bodies: dict[str, tuple[Link, Placed]] = {}
        self.between: set[str] = set()  # names of the bodies between joints
        self.seats: dict[str | None, Seat] = {None: Seat(GROUND)}  # by link
        self.markers: dict[str, Content] = {}  # placements by name, for each body
        self.holds: dict[str, Hold] = {}  # by joint
        self.fixed: dict[str, tuple[str, str]] = {}  # markers i and j of each fixed joint
        self.unmoved: tuple[str, ...] = ()  # omitted joints, which move no mass
        self._coordinates = coordinates
        placed = frames(robot, coordinates, rates)
        moves_mass = _with_mass(robot)
        valid_first = sorted(robot.links, key=lambda link: not re.fullmatch(r"[A-Za-z_]\w*", link.name, re.ASCII))
        called = {link.name: self.names.take(link.name, "link") for link in valid_first}
        for link in robot.links:
            carrier = self.seats[link.parent].on(link.position, link.orientation)
            if link.joints and link.name not in moves_mass:
                self.unmoved += tuple(joint.name for joint in link.joints)
            if link.joints and link.name in moves_mass:
                self._move(link, called[link.name], carrier, placed[link.name])
            elif link.is_heavy:
                self._fix(link, called[link.name], carrier, placed[link.name][-1])
            else:
                self.seats[link.name] = carrier
                self._mark(carrier, called[link.name])
        of_name = {link.name: link for link in robot.links}
        for closure in robot.closures:
            self._close(closure, of_name[closure.link], called[closure.link], placed[closure.link][-1])

    def _move(self, link: Link, name: str, carrier: Seat, placed: tuple[Placed, ...]) -> None:
        """Add a link, a body between each two of its joints, and the joints."""
        self.seats[link.name] = Seat(name)
        self._chain(link.joints, link, name, carrier, placed[1:-1])
        self.bodies[name] = (link, placed[-1])

    def _close(self, closure: Closure, link: Link, name: str, placed: Placed) -> None:
        """Add the joints of a closure, and a body between each two of them in the link's pose."""
        carrier = self.seats[closure.parent].on(closure.position, closure.orientation)
        self._chain(closure.joints, link, name, carrier, (placed,) * (len(closure.joints) - 1))

    def _chain(
        self, joints: tuple[LinkJoint, ...], link: Link, name: str, carrier: Seat, placed: tuple[Placed, ...]
    ) -> None:
        """Add joints between a carrier and a link, with a body between each two of them."""
        before = carrier
        for joint, frame in zip(joints[:-1], placed, strict=True):
            body = self.names.take(f"{name}_{joint.name}")
            self.bodies[body] = (link, frame)
            self.between.add(body)
            before = self._hold(joint, Seat(body), before)
        self._hold(joints[-1], self.seats[link.name], before)

    def _hold(self, joint: LinkJoint, after: Seat, before: Seat) -> Seat:
        """Add a joint between a frame and the one before it; return the first."""
        if joint.kind != "free":
            name, axes = self.names.take(joint.name, "joint"), along_z(joint.axis)
            i = self._mark(after.on(joint.point, axes), name)
            j, angle = self._mark(before.on(joint.point, axes), name), self._coordinates.get(joint.name, joint.zero)
            turns = whole_turns(angle - joint.zero) if joint.is_rotary else 0.0
            self.holds[joint.name] = Hold(joint, name, i, j, turns)
        return after

    def _fix(self, link: Link, name: str, carrier: Seat, placed: Placed) -> None:
        self.bodies[name] = (link, placed)
        self.seats[link.name] = Seat(name)
        joint = self.names.take(f"{name}_fixed")
        self.fixed[joint] = (self._mark(Seat(name), joint), self._mark(carrier, joint))

    def _mark(self, seat: Seat, name: str) -> str:
        """Add a marker; return its reference in the scene."""
        placement: dict[str, object] = {}
        if any(seat.position):
            placement["point"] = vector(seat.position)
        if seat.orientation != IDENTITY:
            placement["orientation"] = vector(seat.orientation)
        self.markers.setdefault(seat.body, {})[name] = placement
        return f"{seat.body}.{name}"

    def mark(
        self, link: str | None, name: str, point: tuple[float, ...], orientation: tuple[float, ...] = IDENTITY
    ) -> str:
        """Add a marker in the frame of a link (None: the world); return its reference in the scene."""
        return self._mark(self.seats[link].on(point, orientation), name)


def whole_turns(angle: float) -> float:
    """Return the whole turns of an angle, rad; the remainder is in (-pi, pi] up to rounding."""
    return 2 * math.pi * math.ceil(angle / (2 * math.pi) - 0.5 - ROUNDING)


def along_z(axis: tuple[float, ...]) -> tuple[float, ...]:
    """Return an orientation whose z axis is a given direction."""
    z = np.array(axis)
    if z[2] == 1:
        return IDENTITY
    x = np.eye(3)[np.argmin(np.abs(z))]
    x = x - (x @ z) * z
    x /= np.linalg.norm(x)
    return from_matrix(np.column_stack([x, np.cross(z, x), z]))


def _with_mass(robot: Robot) -> set[str]:
    """Return the links that have mass, inertia or a rotor, are in a loop, or carry such links."""
    found = {name for closure in robot.closures for name in (closure.link, closure.parent) if name is not None}
    for link in reversed(robot.links):
        if link.name in found or link.is_heavy or any(joint.armature > 0 for joint in link.joints):
            found.add(link.name)
            if link.parent is not None:
                found.add(link.parent)
    return found
