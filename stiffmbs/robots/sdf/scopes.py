"""Frames of SDFormat files: poses relative to other frames, and names of worlds, models and nested models."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Final

from ...reading.files.quoted import listed, quoted
from ...reading.files.xml_nodes import Node
from ..robot import RobotFault
from .files import Version
from .poses import HERE, Pose, pose_of

MODEL, WORLD, BETWEEN = "__model__", "world", "::"
RELATIVE_TO_NAMED: Final[Version] = (1, 7)
"""First version whose poses name their frame by ``relative_to``; before, ``frame``."""


@dataclass(frozen=True)
class Frame:
    """Frame of a scope. `pose`: in the frame `base`; None is the scope's own. `attached`: frame that it moves with."""

    where: str
    pose: Pose
    base: str | None = None
    attached: str | None = None


@dataclass
class Scope:
    """World or model with its named frames and nested models.

    `prefix`: names of its links and joints in the robot begin with it. `frame`: the scope's frame in its parent, or that of
    `placement` if it is given. `canonical`: name of the link that the scope's frame moves with; by default the first one.
    `alone`: names of links and joints in its only model do not begin with the name of that model. `links`, `joints`:
    elements by name.
    """

    where: str
    name: str
    prefix: str
    version: Version
    node: Node
    frame: Frame
    parent: Scope | None = None
    placement: str | None = None
    canonical: str | None = None
    static: bool = False
    alone: bool = False
    links: dict[str, Node] = field(default_factory=dict)
    joints: dict[str, Node] = field(default_factory=dict)
    joint_frames: dict[str, Frame] = field(default_factory=dict)
    frames: dict[str, Frame] = field(default_factory=dict)  # of a link, joint and frame of one name, the link's counts
    models: dict[str, Scope] = field(default_factory=dict)
    merged: list[Scope] = field(default_factory=list)  # models whose names are also names of this scope
    _pending: set[str] = field(default_factory=set)
    _poses: dict[str, Pose] = field(default_factory=dict)

    def scopes(self) -> Iterator[Scope]:
        """Yield the scope and all models in it, in the order of the file."""
        yield self
        for model in (*self.merged, *self.models.values()):
            yield from model.scopes()

    def pose(self, name: str, where: str) -> Pose:
        """Return the pose of a named frame in the scope's own frame."""
        if name == MODEL or (name == WORLD and self.parent is None):
            return HERE
        if name in self._poses:
            return self._poses[name]
        if name in self._pending:
            raise RobotFault(f"{where}: found that the frame {quoted(name)} is relative to itself, expected no circle")
        self._pending.add(name)
        try:
            found = self._poses[name] = self._pose(name, where)
        finally:
            self._pending.discard(name)
        return found

    def _pose(self, name: str, where: str) -> Pose:
        if name in self.frames:
            frame = self.frames[name]
            return self.pose(frame.base or MODEL, frame.where).on(frame.pose)
        model, inner = self._inner(name, where)
        return model.in_parent(self).on(model.pose(inner, where))

    def in_parent(self, parent: Scope) -> Pose:
        """Return the pose of the scope's own frame in that of its parent."""
        placed = parent.pose(self.frame.base or MODEL, self.frame.where).on(self.frame.pose)
        return placed if self.placement is None else placed.on(self.pose(self.placement, self.where).inverse())

    def link(self, name: str, where: str) -> str | None:
        """Return the link that a named frame moves with, by its name in the robot; None for the world."""
        if name == WORLD:
            return None
        if name == MODEL:
            return self._canonical(where)
        if name in self.links:
            return self.prefix + name
        if name in self._pending:
            raise RobotFault(f"{where}: found that the frame {quoted(name)} is attached to itself, expected no circle")
        self._pending.add(name)
        try:
            if name in self.frames:
                frame = self.frames[name]
                return self.link(frame.attached or MODEL, frame.where)
            model, inner = self._inner(name, where)
            return model.link(inner, where)
        finally:
            self._pending.discard(name)

    def _canonical(self, where: str) -> str | None:
        """Return the link that the scope's own frame moves with."""
        if self.parent is None or self.static:
            return None
        if self.canonical is not None:
            return self.link(self.canonical, where)
        for first in (*self.links, *self.models):
            return self.link(first, where)
        for model in self.merged:
            return model._canonical(where)
        raise RobotFault(f"{where}: found {self.where} without a link, expected one that its frame moves with")

    def _inner(self, name: str, where: str) -> tuple[Scope, str]:
        """Return the nested model of a name, and the rest of the name in it."""
        if name in self.models:
            return self.models[name], MODEL
        for model in self.merged:
            if model.knows(name):
                return model, name
        first, _, rest = name.partition(BETWEEN)
        if rest and first in self.models:
            return self.models[first], rest
        if rest and first == self.name and self.version < RELATIVE_TO_NAMED:
            return self, rest
        known = quoted(listed([*self.frames, *self.models])) or "none"
        raise RobotFault(
            f"{where}: found the frame {quoted(name)}, expected a link, joint, frame or model of {self.where}: {known}"
        )

    def knows(self, name: str) -> bool:
        """Return True if the scope, or a model in it, has a frame of a name."""
        first, _, rest = name.partition(BETWEEN)
        return (
            name in self.frames
            or name in self.models
            or any(model.knows(name) for model in self.merged)
            or (bool(rest) and first in self.models and self.models[first].knows(rest))
        )

    def in_root(self, pose: Pose) -> Pose:
        """Return the pose in the world of a frame that is given in the scope's own."""
        if self.parent is None:
            return pose
        return self.parent.in_root(self.in_parent(self.parent).on(pose))


def framed(where: str, node: Node, version: Version, attached: str | None = None, base: str | None = None) -> Frame:
    """Return the frame of an element by its ``<pose>``; by default, the pose is given in the frame `base`."""
    pose = node.find("pose")
    relative = None
    if pose is not None:
        relative = pose.get("relative_to" if version >= RELATIVE_TO_NAMED else "frame")
    return Frame(where, pose_of(where, pose), relative or base, attached)
