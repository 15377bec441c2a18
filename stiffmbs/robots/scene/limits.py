"""Stops that hold joints within their limits, and brakes that hold their speeds: one-sided springs and dampers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import inf, isfinite

import numpy as np

from ...elements.spatial.number_format import plain
from ...elements.spatial.orientation import matrix, rotated
from ...reading.files.yaml_text import Content
from ..pose import Placed, frames
from ..robot import Link, LinkJoint, Robot, RobotFault
from .joints import along_axis
from .mechanism import Hold, Mechanism

TIME, DAMPING = "stop_time", "stop_damping"
STOPS: Mapping[str, float] = {TIME: 0.02, DAMPING: 1.0}
"""Parameters of a scene with stops: the time constant T, s, and the damping ratio, as by default in MuJoCo."""


def stops(robot: Robot, mechanism: Mechanism, coordinates: Mapping[str, float]) -> tuple[Content, Content]:
    """Return the parameters and the forces of the stops of all joints with limits.

    A stop at a distance x beyond a limit acts with max(0, k x + c x'), k = I/T^2 and c = 2 zeta I/T, for the inertia I of the links
    that the joint carries, about its axis at the start. Alone, with zeta = 1, it turns a speed v round within 2 T, at a distance of at
    most v T/e, to v/e^2. Beyond the largest speed of a joint, a brake acts with c = I/T on the excess, which decays with the time
    constant T. Raises RobotFault if a lower limit is above the upper one.
    """
    placed = frames(robot, coordinates, {})
    held = {hold.joint.name: hold for hold in mechanism.holds.values() if hold.joint.is_limited}
    if not held:
        return {}, {}
    names = {name: mechanism.names.take(name) for name in STOPS}
    forces: Content = {}
    for joint, inertia in _inertias(robot, placed):
        if joint.name in held and inertia > 0.0:
            hold = held[joint.name]
            if laws := [*_stop(hold, inertia, names), *_brake(hold, inertia, names)]:
                forces[mechanism.names.take(f"{hold.name}_stop")] = along_axis(hold, " + ".join(laws))
    return {names[name]: value for name, value in STOPS.items()}, forces


def _stop(hold: Hold, inertia: float, names: Mapping[str, str]) -> Iterator[str]:
    """Yield the formulas of the torque or force of the stops of a joint, one for each limit."""
    lower, upper = hold.joint.limits or (-inf, inf)
    if lower > upper:
        raise RobotFault(
            f"joint {hold.joint.name}: found the limits {lower:g} and {upper:g}, expected the lower one first"
        )
    k = f"{inertia!r}/{names[TIME]}^2"
    c = f"{2.0 * inertia!r}*{names[DAMPING]}/{names[TIME]}"
    below, above = f"{plain(lower)!r} - {hold.coordinate}", f"{hold.coordinate} - {plain(upper)!r}"
    if isfinite(lower):
        yield f"branch({below}, 0, 0, max(0, {k}*({below}) - {c}*{hold.rate}))"
    if isfinite(upper):
        yield f"branch({above}, 0, 0, -max(0, {k}*({above}) + {c}*{hold.rate}))"


def _brake(hold: Hold, inertia: float, names: Mapping[str, str]) -> Iterator[str]:
    """Yield the formula of the torque or force of the brake of a joint for each direction."""
    if (speed := hold.joint.speed) is not None:
        c = f"{inertia!r}/{names[TIME]}"
        for excess, sign in ((f"{hold.rate} - {plain(speed)!r}", "-"), (f"-{plain(speed)!r} - {hold.rate}", "")):
            yield f"branch({excess}, 0, 0, {sign}{c}*({excess}))"


def _inertias(robot: Robot, placed: Mapping[str, tuple[Placed, ...]]) -> Iterator[tuple[LinkJoint, float]]:
    """Yield the joints of one coordinate with the inertia that each carries about or along its axis, kg m^2 or kg."""
    carried = _carried(robot)
    in_tree = (
        (link.name, joint, frame)
        for link in robot.links
        for joint, frame in zip(link.joints, placed[link.name], strict=False)
    )
    in_loops = ((each.link, joint, placed[each.link][-1]) for each in robot.closures for joint in each.joints)
    for link, joint, frame in (*in_tree, *in_loops):
        axis, point = np.array(rotated(frame.orientation, joint.axis)), frame.point(joint.point)
        lead = 1.0 if joint.kind == "slide" else joint.pitch / (2.0 * np.pi)
        inertia = joint.armature + lead**2 * sum(each.mass for each in carried[link])
        if joint.is_rotary:
            inertia += sum(_about(each, placed[each.name][-1], point, axis) for each in carried[link])
        if joint.is_single:
            yield joint, inertia


def _about(link: Link, frame: Placed, point: np.ndarray, axis: np.ndarray) -> float:
    """Return the moment of inertia of a link about an axis through a point, kg m^2."""
    arm = np.cross(axis, frame.point(link.center_of_mass) - point)
    own = np.array(matrix(frame.orientation)).T @ axis
    return float(own @ link.inertia @ own + link.mass * (arm @ arm))


def _carried(robot: Robot) -> dict[str, list[Link]]:
    """Return each link with all links that it carries, by name."""
    found: dict[str, list[Link]] = {}
    for link in reversed(robot.links):
        found.setdefault(link.name, []).append(link)
        if link.parent is not None:
            found.setdefault(link.parent, []).extend(found[link.name])
    return found
