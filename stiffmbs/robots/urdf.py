"""Robots from URDF files (Unified Robot Description Format, wiki.ros.org/urdf/XML)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ..elements.spatial.marker import ORIGIN
from ..elements.spatial.orientation import matrix
from ..reading.files.requested import unused_notes
from ..reading.files.xml_nodes import Node, parsed
from .robot import JointKind, Link, LinkJoint, Relation, Robot, RobotFault, Transmission
from .urdf_contacts import contacts as touching
from .urdf_values import numbers, origin, value_of

KINDS: dict[str, JointKind] = {"revolute": "hinge", "continuous": "hinge", "prismatic": "slide", "floating": "free"}
OF_ONE_COORDINATE = ("revolute", "continuous", "prismatic")
FIXED, PLANAR = "fixed", "planar"
OF_MOTION = ("axis", "limit", "dynamics", "mimic", "safety_controller", "calibration")
"""Children of a joint that have no effect on a fixed joint."""
DEFAULTS: Mapping[str, Mapping[str, object]] = {
    "robot": {"version": "1.0"},
    "joint/limit": {"velocity": 0.0, "lower": 0.0, "upper": 0.0},
}
"""Values of unused attributes without effect."""
SHAPES, HARDWARE = "shapes and contacts are left out", "actuators of transmissions are left out"
REASONS: Mapping[str, Mapping[str, str]] = {
    "link": {"<visual>": SHAPES, "<collision>": SHAPES}, "robot": {"<material>": SHAPES},
    "joint/limit": {"*": "limits are not held"}, "joint": {"<safety_controller>": "limits are not held"},
    **{f"transmission{below}": {"*": HARDWARE} for below in ("", "/joint")},
}  # fmt: skip
"""Reasons why attributes and children have no effect."""
WITH_CONTACTS: Mapping[str, Mapping[str, str]] = {
    **REASONS, "link": {"<visual>": "graphics"}, "robot": {"<material>": "graphics"},
    "link/collision/geometry/mesh": {"*": "meshes have no contact"},
}  # fmt: skip
"""Reasons if the shapes of contacts are read."""


def read_urdf(text: str, contacts: bool = False, ground: float | None = None, free_root: bool = False) -> Robot:
    """Read a robot from the text of a URDF file.

    `contacts`: True to read the shapes of ``<collision>``. `ground`: height of the plane that they touch, m.
    `free_root`: True if the root link moves freely; by default it is fixed to ground. Joints with a
    ``<transmission>`` have an effort as input. If the file has no transmission, joints with a positive effort limit
    have one. Raises RobotFault if the text is not URDF, or its links and joints are not a tree; names the link or
    joint.
    """
    root = _parsed(text)
    links = dict(_named(root, "link"))
    joints = dict(_named(root, "joint"))
    if not links:
        raise RobotFault("found no link, expected <link name=...> in <robot>")
    child_of = _children(joints, links)
    ordered = _from_the_root(links, joints, child_of)
    moving = [name for name in child_of.values() if joints[name].get("type") != FIXED]
    read: dict[str, Any] = {
        "name": root.get("name") or "robot",
        "links": tuple(_link(name, links[name], child_of.get(name), joints, free_root) for name in ordered),
        "transmissions": tuple(_efforts(root, {name: joints[name] for name in moving})),
        "relations": tuple(_mimics(joints, child_of)),
    }
    own = [f"the root link {ordered[0]} {'moves freely' if free_root else 'is fixed to ground'}", *_still(joints)]
    if contacts:
        read["contacts"], of_contacts = touching(root, links, ground)
        own += of_contacts
    return Robot(**read, notes=(*own, *unused_notes(root.fields(), WITH_CONTACTS if contacts else REASONS)))


def _parsed(text: str) -> Node:
    root = parsed(text, "a URDF file", DEFAULTS)
    if root.tag != "robot":
        raise RobotFault(f"found <{root.tag}>, expected <robot> of a URDF file")
    for node in root.walk():
        if node.tag.startswith("xacro") or any("${" in value for value in node.attributes.values()):
            raise RobotFault(f"found the macro <{node.tag}>, expected plain URDF: run xacro first")
    return root


def _named(root: Node, tag: str) -> Iterator[tuple[str, Node]]:
    known = set()
    for element in root.findall(tag):
        name = element.get("name")
        if not name:
            raise RobotFault(f"found a {tag} without a name, expected <{tag} name=...>")
        if name in known:
            raise RobotFault(f"found two {tag}s {name}, expected one of each name")
        known.add(name)
        yield name, element


def _children(joints: dict[str, Node], links: dict[str, Node]) -> dict[str, str]:
    """Return the parent joint of each link."""
    found: dict[str, str] = {}
    for name, element in joints.items():
        if element.get("type") not in (*KINDS, FIXED, PLANAR):
            raise RobotFault(
                f"joint {name}: found the type {element.get('type')}, expected one of {', '.join((*KINDS, FIXED, PLANAR))}"
            )
        for role in ("parent", "child"):
            link = _end(element, role)
            if link not in links:
                raise RobotFault(f"joint {name}: found the {role} {link}, expected a link of the file")
        child = _end(element, "child") or ""
        if child in found:
            raise RobotFault(f"link {child}: found two parent joints, {found[child]} and {name}, expected one")
        found[child] = name
    return found


def _end(joint: Node, role: str) -> str | None:
    end = joint.find(role)
    return None if end is None else end.get("link")


def _from_the_root(links: dict[str, Node], joints: dict[str, Node], child_of: dict[str, str]) -> list[str]:
    """Return the links, each after its parent."""
    roots = [name for name in links if name not in child_of]
    if len(roots) != 1:
        found = ", ".join(roots) or "none"
        raise RobotFault(f"found the links {found} without a parent joint, expected one, the root of the tree")
    carried: dict[str, list[str]] = {}
    for child, joint in child_of.items():
        carried.setdefault(_end(joints[joint], "parent") or "", []).append(child)
    ordered = roots
    for name in ordered:  # grows during the loop
        ordered.extend(carried.get(name, ()))
    if len(ordered) < len(links):
        lost = ", ".join(name for name in links if name not in ordered)
        raise RobotFault(f"found a closed chain of links, {lost}, expected a tree")
    return ordered


def _link(name: str, element: Node, joint: str | None, joints: dict[str, Node], free_root: bool) -> Link:
    mass, centre, inertia = _inertial(name, element.find("inertial"))
    if joint is None:
        free = (LinkJoint(f"{name}_free", "free"),) if free_root else ()
        return Link(name, None, mass=mass, center_of_mass=centre, inertia=inertia, joints=free)
    carrier = joints[joint]
    position, orientation = origin(f"joint {joint}", carrier)
    return Link(
        name, _end(carrier, "parent"), position, orientation, mass, centre, inertia, tuple(_moving(joint, carrier))
    )


def _inertial(name: str, element: Node | None) -> tuple[float, tuple[float, ...], np.ndarray]:
    """Return mass, centre of mass and inertia of a link in the link's axes; zeros without an <inertial>."""
    if element is None:
        return 0.0, ORIGIN, np.zeros((3, 3))
    where = f"link {name}"
    centre, turned = origin(where, element)
    mass = value_of(where, element.find("mass"), "value", 0.0)
    moments = element.find("inertia")
    xx, xy, xz, yy, yz, zz = (value_of(where, moments, key, 0.0) for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"))
    A = matrix(turned)
    tensor = A @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ A.T
    if mass < 0:
        raise RobotFault(f"{where}: found a mass of {mass:g}, expected 0 or more")
    with np.errstate(over="ignore"):  # moments that are not finite are refused with the body
        return mass, centre, (tensor + tensor.T) / 2


def _moving(name: str, element: Node) -> Iterator[LinkJoint]:
    """Yield the equivalent joints of a URDF joint: none if fixed, two slides and a hinge if planar."""
    kind = element.get("type")
    if kind == FIXED:
        return
    where, axis = f"joint {name}", _axis(name, element)
    if kind == "floating":
        yield LinkJoint(name, KINDS[kind], axis=axis)
        return
    dynamics, limits = element.find("dynamics"), element.find("limit")
    damping = value_of(where, dynamics, "damping", 0.0)
    if kind == PLANAR:
        across = np.linalg.svd(np.array([axis]))[2][1:]
        for letter, direction in zip("xy", across, strict=True):
            yield LinkJoint(f"{name}_{letter}", "slide", axis=tuple(map(float, direction)), damping=damping)
        yield LinkJoint(name, "hinge", axis=axis, damping=damping)
        return
    bounds = None
    if limits is not None and kind in ("revolute", "prismatic"):
        bounds = (value_of(where, limits, "lower", 0.0), value_of(where, limits, "upper", 0.0))
    friction = value_of(where, dynamics, "friction", 0.0)
    speed = value_of(where, limits, "velocity", 0.0)
    moving = LinkJoint(name, KINDS[kind or ""], axis=axis, damping=damping, friction=friction, limits=bounds)
    yield replace(moving, speed=speed) if speed > 0 else moving


def _axis(name: str, element: Node) -> tuple[float, ...]:
    given = element.find("axis")
    axis = np.array(numbers(f"joint {name}", "axis", given.get("xyz") or "1 0 0" if given is not None else "1 0 0"))
    length = float(np.linalg.norm(axis))
    if length == 0:
        raise RobotFault(f"joint {name}: found an axis of length 0, expected a direction")
    return tuple(map(float, axis / length))


def _efforts(root: Node, moving: dict[str, Node]) -> Iterator[Transmission]:
    given = [joint.get("name") for joint in root.findall("transmission/joint")]
    for name, element in moving.items():
        limit = element.find("limit")
        effort = 0.0 if limit is None else value_of(f"joint {name}", limit, "effort", 0.0)
        driven = name in given if given else effort > 0
        if driven and element.get("type") in OF_ONE_COORDINATE and element.find("mimic") is None:
            yield Transmission(
                name, {name: 1.0}, gain=(1.0, 0.0, 0.0), bias=ORIGIN, force=(-effort, effort) if effort > 0 else None
            )


def _mimics(joints: dict[str, Node], child_of: dict[str, str]) -> Iterator[Relation]:
    """Yield the relations of joints that mimic others; one that mimics a fixed joint is fixed at its offset."""
    for name in child_of.values():
        mimic = joints[name].find("mimic")
        if mimic is None or joints[name].get("type") == FIXED:
            continue
        where, other = f"joint {name}", mimic.get("joint")
        known = (*OF_ONE_COORDINATE, FIXED)
        if (
            other not in joints
            or other == name
            or joints[name].get("type") not in known
            or joints[other].get("type") not in known
        ):
            raise RobotFault(
                f"{where}: found that it mimics {other}, expected a revolute, continuous, prismatic or fixed joint"
            )
        multiplier, offset = value_of(where, mimic, "multiplier", 1.0), value_of(where, mimic, "offset", 0.0)
        if joints[other].get("type") == FIXED:
            yield Relation(f"{name}_mimic", name, None, (offset,))
        else:
            yield Relation(f"{name}_mimic", name, other, (offset, multiplier))


def _still(joints: dict[str, Node]) -> Iterator[str]:
    """Yield a note on fixed joints that mimic others; their axes, limits and dynamics have no effect."""
    found = []
    for name, element in joints.items():
        if element.get("type") == FIXED:
            found += [name] if element.find("mimic") is not None else []
            element.without_effect(*OF_MOTION)
    if found:
        yield f"'mimic' has no effect on fixed joints: {', '.join(found)}"
