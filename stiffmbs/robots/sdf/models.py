"""Worlds and models of SDFormat files as scopes of frames, with their included models."""

from __future__ import annotations

from ...reading.files.quoted import quoted
from ...reading.files.xml_nodes import Node
from ..robot import RobotFault
from .files import Files, Source, named, uri_of
from .poses import Pose, flag, pose_of, text_of
from .scopes import BETWEEN, Scope, framed

GROUND = "ground_plane"
SCENERY = ("sun", GROUND)
"""Models of Gazebo that have nothing that moves; worlds without them are the same."""
MERGE = "merge"
WITHOUT_LINKS = ("light", "actor")
"""Elements of included files without a model."""


class Models:
    """Reader of the models of a file. `omitted`: uris of scenery that is left out. `grounds`: poses of ground planes without a file.

    `contacts`: True if links touch ground planes.
    """

    def __init__(self, files: Files, contacts: bool) -> None:
        self._files, self._contacts = files, contacts
        self.omitted: list[str] = []
        self.grounds: list[Pose] = []

    def fill(self, scope: Scope, source: Source) -> None:
        """Add the links, joints, frames and models of an element to its scope."""
        for node in scope.node.among("link", "joint", "frame", "model", "include"):
            if node.tag in ("link", "joint", "frame"):
                self._add(scope, node)
            elif node.tag == "model":
                self._nest(scope, node, source, node)
            elif node.tag == "include":
                self._include(scope, node, source)

    def _add(self, scope: Scope, node: Node) -> None:
        name = named(f"{scope.where}: ", node)
        where, version = f"{node.tag} {quoted(scope.prefix + name)}", scope.version
        kind = {"link": scope.links, "joint": scope.joints}.get(node.tag)
        if kind is not None:
            if name in kind:
                raise RobotFault(f"{scope.where}: found two {node.tag}s {name}, expected one of each name")
            kind[name] = node
        if node.tag == "link":
            scope.frames[name] = framed(where, node, version)  # names of links come first
        elif node.tag == "joint":
            child = text_of(node.find("child"))
            frame = scope.joint_frames[name] = framed(where, node, version, attached=child, base=child)
            scope.frames.setdefault(name, frame)
        else:
            attached = node.get("attached_to") or None
            scope.frames.setdefault(name, framed(where, node, version, attached=attached, base=attached))

    def _include(self, scope: Scope, include: Node, source: Source) -> None:
        uri = uri_of(scope.where, include)
        where = f"{scope.where}: the include {quoted(uri)}"
        found = self._files.included(where, uri, source)
        if found is None:
            if self._contacts and uri.rpartition("/")[2] == GROUND:
                include.without_effect("name", "static")
                self.grounds.append(scope.in_root(pose_of(where, include.find("pose"))))
                return
            if uri.rpartition("/")[2] in SCENERY:
                self.omitted.append(uri)
                include.without_effect("pose", "name", "static")
                return
            raise RobotFault(
                f"{where}: found no such file, expected it next to the file: copy the model's folder there"
            )
        if any(found.root.unrecorded(tag) is not None for tag in WITHOUT_LINKS):
            return  # the notes name it
        models = found.root.findall("model")
        if len(models) != 1:
            raise RobotFault(f"{where}: found {len(models) or 'no'} models in {quoted(str(found.path))}, expected one")
        self._nest(scope, models[0], found, include)

    def _nest(self, scope: Scope, node: Node, source: Source, outer: Node) -> None:
        """Add a model; `outer`: the element that places it, itself or its ``<include>``."""
        included = outer is not node
        own = node.get("name")
        name = (text_of(outer.find("name")) if included else "") or own or named(f"{scope.where}: ", node)
        where = f"model {quoted(scope.prefix + name)}"
        placed = outer if included and outer.find("pose") is not None else node
        frame = framed(where, placed, scope.version if placed is outer else source.version)
        if included:
            node.find("pose")
        merged = included and (outer.get(MERGE) or "").lower() in ("1", "true")
        static = flag(where, node, "static")
        inner = Scope(
            where,
            name,
            scope.prefix if merged or scope.alone else f"{scope.prefix}{name}{BETWEEN}",
            source.version,
            node,
            frame,
            scope,
            placement=(text_of(outer.find("placement_frame")) if included else "")
            or node.get("placement_frame")
            or None,
            canonical=node.get("canonical_link") or None,
            static=scope.static or (flag(where, outer, "static", static) if included else static),
        )
        if merged:
            scope.merged.append(inner)
        elif name in scope.models:
            raise RobotFault(f"{scope.where}: found two models {name}, expected one of each name")
        else:
            scope.models[name] = inner
        self.fill(inner, source)
