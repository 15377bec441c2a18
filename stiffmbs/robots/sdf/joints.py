"""Joints of SDFormat files: their kinds, frames, axes, springs and limits."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from ...elements.spatial.orientation import conjugate, rotated
from ...reading.files.quoted import quoted
from ...reading.files.xml_nodes import Node
from ..robot import JointKind, LinkJoint, RobotFault
from .files import Version
from .poses import Pose, number, numbers, text_of
from .scopes import MODEL, WORLD, Scope

KINDS: dict[str, tuple[JointKind, ...]] = {
    "revolute": ("hinge",), "continuous": ("hinge",), "prismatic": ("slide",), "screw": ("screw",), "ball": ("ball",),
    "universal": ("hinge", "hinge"), "revolute2": ("hinge", "hinge"), "fixed": (), "gearbox": ("hinge", "hinge"),
}  # fmt: skip
"""Joints of one link after the other, by the type of the file; a gearbox has just their axes."""
GEARBOX, SCREW, BALL = "gearbox", "screw", "ball"
AXES = ("axis", "axis2")
IN_JOINT: Final[Version] = (1, 5)
"""First version whose axes are given in the frame of the joint by default; before, in the frame of the model."""
BY_NAME: Final[Version] = (1, 7)
"""First version whose axes name their frame; before, the frame of the model by ``use_parent_model_frame``."""
UNBOUNDED: Final = 1e16
"""Magnitude from which on a limit is none, as in the files of older versions."""


@dataclass(frozen=True)
class Axis:
    """Axis of a joint: a direction in the world of length 1, and the element of the file."""

    direction: np.ndarray
    node: Node


@dataclass(frozen=True)
class Arc:
    """Joint of a file between two links (None: the world) in its initial pose; `point`: in the world, m."""

    where: str
    name: str
    kind: str
    parent: str | None
    child: str | None
    point: np.ndarray
    axes: tuple[Axis, ...]
    node: Node
    scope: Scope

    def names(self) -> list[str]:
        """Return the names of the joints of the robot that it becomes, in order of its axes."""
        return [self.name, f"{self.name}_axis2"][: len(KINDS[self.kind])]


def arcs(scope: Scope) -> Iterator[Arc]:
    """Yield the joints of a world or model, without those of the models in it."""
    for name, node in scope.joints.items():
        where, kind = f"joint {quoted(scope.prefix + name)}", node.get("type") or ""
        if kind not in KINDS:
            raise RobotFault(f"{where}: found the type {quoted(kind)}, expected one of {', '.join(KINDS)}")
        if not KINDS[kind]:
            node.without_effect(*AXES)
        ends = {role: _end(where, node, role) for role in ("parent", "child")}
        if ends["child"] == WORLD:
            raise RobotFault(f"{where}: found the child world, expected a link: exchange parent and child")
        parent, child = (scope.link(end, where) for end in ends.values())
        if parent == child:
            raise RobotFault(f"{where}: found that it connects {parent or 'the world'} with itself, expected two links")
        frame = scope.joint_frames[name]
        placed = scope.pose(frame.base or MODEL, where).on(frame.pose)
        axes = tuple(_axis(where, scope, placed, node, tag) for tag, _ in zip(AXES, _with_axes(kind), strict=False))
        point = np.array(scope.in_root(placed).position)
        yield Arc(where, f"{scope.prefix}{name}", kind, parent, child, point, axes, node, scope)


def _with_axes(kind: str) -> tuple[JointKind, ...]:
    return tuple(each for each in KINDS[kind] if each != BALL)


def _end(where: str, joint: Node, role: str) -> str:
    node = joint.find(role)
    name = text_of(node) or (node.get("link") or "" if node is not None else "")
    if not name:
        raise RobotFault(f"{where}: found no <{role}>, expected the name of a link in it")
    return name


def _axis(where: str, scope: Scope, placed: Pose, joint: Node, tag: str) -> Axis:
    node = joint.find(tag)
    if node is None:
        raise RobotFault(f"{where}: found no <{tag}>, expected one with the direction in <xyz>")
    xyz = node.find("xyz")
    axis = np.array(numbers(where, "xyz", text_of(xyz) or "0 0 1"))
    length = float(np.linalg.norm(axis))
    if length == 0 or not math.isfinite(length):
        raise RobotFault(f"{where}: found an axis of length {length:g}, expected a direction")
    frame = _axis_frame(where, scope, placed, node, xyz)
    return Axis(rotated(scope.in_root(frame).orientation, tuple(axis / length)), node)


def _axis_frame(where: str, scope: Scope, placed: Pose, axis: Node, xyz: Node | None) -> Pose:
    """Return the pose, in the scope's frame, of the frame in which an axis is given."""
    if scope.version < IN_JOINT:
        return scope.pose(MODEL, where)
    if scope.version < BY_NAME:
        of_model = text_of(axis.find("use_parent_model_frame")).lower() in ("1", "true")
        return scope.pose(MODEL, where) if of_model else placed
    name = None if xyz is None else xyz.get("expressed_in")
    return scope.pose(name, where) if name else placed


def link_joints(arc: Arc, frame: Pose, reverse: bool) -> tuple[LinkJoint, ...]:
    """Return the joints of a link with the pose `frame` in the world; `reverse`: the link is the arc's parent."""
    sign, back = -1.0 if reverse else 1.0, conjugate(frame.orientation)
    point = tuple(map(float, rotated(back, tuple(arc.point - np.array(frame.position)))))
    if arc.kind == BALL:
        return (LinkJoint(arc.name, "ball", point),)
    found = tuple(
        _joint(arc, name, kind, axis, point, tuple(map(float, rotated(back, tuple(sign * axis.direction)))))
        for name, kind, axis in zip(arc.names(), KINDS[arc.kind], arc.axes, strict=True)
    )
    return found[::-1] if reverse else found


def _joint(
    arc: Arc, name: str, kind: JointKind, axis: Axis, point: tuple[float, ...], direction: tuple[float, ...]
) -> LinkJoint:
    dynamics = axis.node.find("dynamics")
    damping, friction, stiffness, rest = (
        number(arc.where, dynamics, tag, 0.0) for tag in ("damping", "friction", "spring_stiffness", "spring_reference")
    )
    return LinkJoint(
        name,
        kind,
        point,
        direction,
        stiffness=stiffness,
        damping=damping,
        rest=rest,
        friction=friction,
        limits=limits(arc, axis),
        speed=_bound(arc, axis, "velocity") or None,
        pitch=_pitch(arc) if arc.kind == SCREW else 0.0,
    )


def limits(arc: Arc, axis: Axis) -> tuple[float, float] | None:
    """Return the limits of a coordinate, rad or m; None if there are none, or for a continuous joint."""
    node = axis.node.find("limit")
    if node is None or arc.kind == "continuous":
        return None
    lower, upper = (
        _limit(arc.where, node, tag, otherwise) for tag, otherwise in (("lower", -math.inf), ("upper", math.inf))
    )
    return (lower, upper) if math.isfinite(lower) or math.isfinite(upper) else None


def effort(arc: Arc, axis: Axis) -> float:
    """Return the largest force or torque on a coordinate, N or N m; 0 if the file states none."""
    return _bound(arc, axis, "effort")


def _bound(arc: Arc, axis: Axis, tag: str) -> float:
    """Return a positive and finite limit; 0 if the file states none."""
    node = axis.node.find("limit")
    found = math.inf if node is None else _limit(arc.where, node, tag, math.inf)
    return found if 0 < found < math.inf else 0.0


def _limit(where: str, node: Node, tag: str, default: float) -> float:
    text = text_of(node.find(tag))
    try:
        value = float(text) if text else default
    except ValueError:
        value = math.nan
    if math.isnan(value):
        raise RobotFault(f"{where}: found '{quoted(text)}' in <{tag}>, expected a number")
    return math.copysign(math.inf, value) if abs(value) >= UNBOUNDED else value


def _pitch(arc: Arc) -> float:
    """Return the advance in one revolution, m, of a right-handed thread.

    The older ``thread_pitch`` is the angle for a unit of displacement, rad/m, of a left-handed one.
    """
    new, old = (arc.node.find(tag) for tag in ("screw_thread_pitch", "thread_pitch"))
    tag = "screw_thread_pitch" if new is not None or old is None else "thread_pitch"
    value = number(arc.where, arc.node, tag, 1.0)
    if value == 0:
        raise RobotFault(f"{arc.where}: found a <{tag}> of 0, expected another value")
    return value if tag == "screw_thread_pitch" else -2 * math.pi / value
