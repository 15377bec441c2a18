"""Robots from SDFormat files (sdformat.org, versions 1.3 to 1.12)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

from ...elements.spatial.marker import ORIGIN
from ...elements.spatial.orientation import matrix
from ...reading.files.quoted import listed, quoted
from ...reading.files.requested import unused_notes
from ...reading.files.xml_nodes import Node
from ..robot import Closure, Connection, Link, LinkJoint, Robot, RobotFault, Transmission
from .contacts import contacts as touching
from .files import Files, Source, Version
from .gears import relations
from .joints import GEARBOX, KINDS, Arc, arcs, effort, link_joints
from .models import Models
from .poses import HERE, Pose, flag, number, numbers, pose_of, text_of
from .scopes import Frame, Scope
from .solids import of_shapes
from .tree import Branch, spanning_tree

SHAPES, SENSORS, SOLVER, LIMITS = (
    "shapes and contacts are left out",
    "requests of the scene measure",
    "settings of the simulator",
    "limits are not held",
)
DRAWING, PLUGINS = "graphics", "plugins are programs of the simulator"
REASONS: Mapping[str, Mapping[str, str]] = {
    "*": {
        "<plugin>": PLUGINS, "<sensor>": SENSORS, "<light>": DRAWING, "<actor>": DRAWING, "<visual>": DRAWING,
        "<projector>": DRAWING, "<particle_emitter>": DRAWING, "<collision>": SHAPES, "<gripper>": SHAPES,
        "<self_collide>": SHAPES, "<allow_auto_disable>": SOLVER,
    },
    "joint": {"<physics>": SOLVER}, "link/collision": {"*": SHAPES},
    "joint/axis/limit": {"*": LIMITS}, "joint/axis2/limit": {"*": LIMITS},
    "link": {"<kinematic>": "all links follow the forces", "<must_be_base_link>": SOLVER, "<audio_source>": SENSORS, "<audio_sink>": SENSORS},
    "world": {
        "<scene>": DRAWING, "<gui>": DRAWING, "<audio>": SENSORS, "<physics>": SOLVER, "<road>": DRAWING, "<population>": SHAPES,
        "<state>": "models start where their poses place them", "<atmosphere>": "the fluid is left out", "<wind>": "the fluid is left out",
        "<magnetic_field>": SENSORS, "<spherical_coordinates>": SENSORS,
    },
}  # fmt: skip
"""Reasons why elements have no effect."""
WITH_CONTACTS: Mapping[str, Mapping[str, str]] = {
    **{key: value for key, value in REASONS.items() if key != "link/collision"},
    "link/collision/geometry/mesh": {"*": "meshes have no contact"},
}
"""Reasons if the shapes of contacts are read."""


PRODUCTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
OFF = ("self_collide", "enable_wind", "kinematic", "must_be_base_link")
"""Flags of a link without effect if they are false."""
GRAVITY: Final = (0.0, 0.0, -9.8)
"""Gravity of a world that states none, m/s^2; the format's default."""
IN_WORLD: Final[Version] = (1, 6)
"""First version with the gravity in ``<world>``; before, in ``<physics>``."""


@dataclass(frozen=True)
class Placed:
    """Link of a file with its pose in the world."""

    name: str
    pose: Pose
    body: Body
    static: bool


def read_sdf(path: Path, contacts: bool = False, ground: float | None = None) -> Robot:
    """Read the models of an SDFormat file as one robot.

    `contacts`: True to read the contacts of collisions. `ground`: height of an added ground plane, m.

    Links that no joint connects with the world move freely; those of static models are fixed to ground. A joint between
    two links that other joints connect already closes a loop. Raises RobotFault if the file is not SDFormat, or has
    features without an equivalent in a scene; InputError if a file cannot be read.
    """
    files = Files(path.parent)
    source = files.source(path)
    root, models = _root(source), Models(files, contacts)
    models.fill(root, source)
    links = {link.name: link for link in _links(root)}
    if not links:
        raise RobotFault("found no link, expected <link name=...> in a <model>")
    if all(link.static for link in links.values()):
        raise RobotFault("found static models alone, expected a link that moves")
    joints = [arc for scope in root.scopes() for arc in arcs(scope)]
    _check_names(joints)
    kinematic = [arc for arc in joints if arc.kind != GEARBOX]
    fixed = [name for name, link in links.items() if link.static]
    branches = list(spanning_tree(list(links), fixed, kinematic))
    carried = {id(branch.arc) for branch in branches}
    others = [arc for arc in kinematic if id(arc) not in carried and not _is_still(arc, links)]
    read: dict[str, Any] = {
        "name": root.name,
        "links": tuple(_in_tree(links, fixed, branches)),
        "gravity": _gravity(root),
        "transmissions": tuple(_efforts(kinematic)),
        "relations": tuple(relations(joints)),
        "connections": tuple(_weld(arc, links) for arc in others if not KINDS[arc.kind]),
        "closures": tuple(_closure(arc, links) for arc in others if KINDS[arc.kind]),
    }
    of_contacts: list[str] = []
    if contacts:
        grounds = [*models.grounds, *([] if ground is None else [Pose((0.0, 0.0, ground))])]
        read["contacts"], of_contacts = touching(root, [(arc.parent, arc.child) for arc in joints], grounds)
    unused = (fields for each in files.read for fields in each.root.fields())
    reasons = WITH_CONTACTS if contacts else REASONS
    notes = (*_notes(links, branches, others, models), *of_contacts, *unused_notes(unused, reasons))
    return Robot(**read, notes=notes)


def _root(source: Source) -> Scope:
    """Return the scope of the world; of a file of models, that of a world around them."""
    worlds = source.root.findall("world")
    if len(worlds) > 1:
        raise RobotFault(f"found {len(worlds)} worlds, expected one")
    node = worlds[0] if worlds else source.root
    named_by = node if worlds else node.find("model")
    name = (None if named_by is None else named_by.get("name")) or "robot"
    where = f"world {quoted(name)}" if worlds else "the file"
    alone = len(node.among("model", "include")) == 1 and not node.among("joint")
    return Scope(where, name, "", source.version, node, Frame(where, HERE), alone=alone)


def _gravity(root: Scope) -> tuple[float, ...]:
    found = root.node if root.version >= IN_WORLD else root.node.find("physics")
    text = text_of(None if found is None else found.find("gravity"))
    return tuple(numbers(root.where, "gravity", text)) if text else GRAVITY


def _links(root: Scope) -> Iterator[Placed]:
    for scope in root.scopes():
        for name, node in scope.links.items():
            where = f"link {quoted(scope.prefix + name)}"
            pose = scope.in_root(scope.pose(name, where))
            yield Placed(f"{scope.prefix}{name}", pose, _body_of(where, name, node, scope), scope.static)


def _check_names(joints: Sequence[Arc]) -> None:
    known: set[str] = set()
    for arc in joints:
        for name in arc.names() or [arc.name]:
            if name in known:
                raise RobotFault(f"{arc.where}: found two joints {name}, expected one of each name")
            known.add(name)


def _is_still(arc: Arc, links: dict[str, Placed]) -> bool:
    """Return True for a joint between static links or the world."""
    return all(end is None or links[end].static for end in (arc.parent, arc.child))


def _in_tree(links: dict[str, Placed], fixed: Sequence[str], branches: Sequence[Branch]) -> Iterator[Link]:
    """Yield the links of the robot; those of static models have no mass, as they do not move."""
    for name in fixed:
        yield Link(name, None, links[name].pose.position, links[name].pose.orientation)
    for branch in branches:
        link, carrier = links[branch.link], branch.carrier
        pose = link.pose if carrier is None else links[carrier].pose.inverse().on(link.pose)
        body = link.body
        yield Link(
            link.name,
            carrier,
            pose.position,
            pose.orientation,
            body.mass,
            body.center_of_mass,
            np.eye(3) if body.inertia is None else body.inertia,
            _joints(branch, link.pose),
            body.lifted,
        )


def _joints(branch: Branch, pose: Pose) -> tuple[LinkJoint, ...]:
    if branch.arc is None:
        return (LinkJoint(f"{branch.link}_free", "free"),)
    return link_joints(branch.arc, pose, branch.reverse)


def _pose(links: dict[str, Placed], end: str | None) -> Pose:
    return HERE if end is None else links[end].pose


def _weld(arc: Arc, links: dict[str, Placed]) -> Connection:
    """Return the connection of a fixed joint that closes a loop."""
    between = _pose(links, arc.parent).inverse().on(_pose(links, arc.child))
    return Connection(arc.name, arc.parent, arc.child, between.position, ORIGIN, between.orientation)


def _closure(arc: Arc, links: dict[str, Placed]) -> Closure:
    """Return the joints that close a loop; they are those of the child, or of the parent of a static child."""
    reverse = arc.child is None
    link, other = (arc.parent, arc.child) if reverse else (arc.child, arc.parent)
    pose = _pose(links, link)
    between = _pose(links, other).inverse().on(pose)
    return Closure(link or "", other, between.position, between.orientation, link_joints(arc, pose, reverse))


def _efforts(joints: Sequence[Arc]) -> Iterator[Transmission]:
    """Yield an input for each axis with a positive effort limit."""
    for arc in joints:
        for name, axis in zip(arc.names(), arc.axes, strict=False):
            bound = effort(arc, axis)
            if bound and axis.node.find("mimic") is None:
                yield Transmission(name, {name: 1.0}, gain=(1.0, 0.0, 0.0), bias=ORIGIN, force=(-bound, bound))


def _notes(
    links: dict[str, Placed], branches: Sequence[Branch], others: Sequence[Arc], models: Models
) -> Iterator[str]:
    static = [name for name, link in links.items() if link.static]
    if static:
        yield f"links of static models are fixed to ground: {listed(static)}"
    free = [branch.link for branch in branches if branch.arc is None]
    if free:
        yield f"links that no joint connects with the world move freely: {listed(free)}"
    if others:
        yield f"joints that close loops: {listed([arc.name for arc in others])}"
    assumed = [name for name, link in links.items() if link.body.assumed and not link.static]
    if assumed:
        yield f"links without mass or inertia have the defaults of SDF, 1 kg and 1 kg m^2: {listed(assumed)}"
    if models.omitted:
        yield f"included scenery that is not next to the file is left out: {listed(models.omitted)}"


@dataclass(frozen=True)
class Body:
    """Mass, kg, centre of mass, m, and inertia about it, kg m^2, in the frame of a link.

    `lifted`: fraction of its weight that does not act. `assumed`: True if the file gives no mass or inertia.
    """

    mass: float = 1.0
    center_of_mass: tuple[float, ...] = ORIGIN
    inertia: np.ndarray | None = None
    lifted: float = 0.0
    assumed: bool = False


def _body_of(where: str, name: str, link: Node, scope: Scope) -> Body:
    """Return the mass and inertia of a ``<link>``; 1 kg and 1 kg m^2 are the format's defaults."""
    link.without_effect(*(tag for tag in OFF if link.unrecorded(tag) in ("0", "false")))
    lifted = 0.0 if flag(where, link, "gravity", True) else 1.0
    inertial = link.find("inertial")
    if inertial is None:
        return Body(inertia=np.eye(3), lifted=lifted, assumed=True)
    if (inertial.get("auto") or "").lower() in ("1", "true"):
        mass, centre, tensor = of_shapes(where, name, link, inertial, scope)
        return Body(mass, tuple(map(float, centre)), tensor, lifted)
    pose = pose_of(where, inertial.find("pose"))
    mass = number(where, inertial, "mass", 1.0)
    if mass < 0:
        raise RobotFault(f"{where}: found a mass of {mass:g}, expected 0 or more")
    moments = inertial.find("inertia")
    xx, xy, xz, yy, yz, zz = (number(where, moments, key, float(key[1] == key[2])) for key in PRODUCTS)
    A = matrix(pose.orientation)
    with np.errstate(over="ignore", invalid="ignore"):  # moments that are not finite are refused with the body
        tensor = A @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ A.T
        tensor = (tensor + tensor.T) / 2
    return Body(mass, pose.position, tensor, lifted, assumed=moments is None or inertial.find("mass") is None)
