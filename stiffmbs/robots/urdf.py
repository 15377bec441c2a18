"""Robots from URDF files (Unified Robot Description Format, wiki.ros.org/urdf/XML)."""

from __future__ import annotations

from collections.abc import Iterator
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import numpy as np

from ..describe.spatial.orientation import about, matrix, product
from .robot import ORIGIN, SAME_AXES, JointKind, Link, LinkJoint, Relation, Robot, RobotFault, Transmission

KINDS: dict[str, JointKind] = {"revolute": "hinge", "continuous": "hinge", "prismatic": "slide", "floating": "free"}
FIXED, PLANAR = "fixed", "planar"


def read_urdf(text: str) -> Robot:
    """Read a robot from the text of a URDF file.

    The root link is fixed to ground.  Joints with a ``<transmission>`` have an effort as input; where the file has no
    transmission at all, joints with an effort limit above zero have.

    Raises
    ------
    RobotFault
        Where the text is no URDF, or its links and joints make no tree; names the link or joint.
    """
    root = _parsed(text)
    links = dict(_named(root, "link"))
    joints = dict(_named(root, "joint"))
    if not links:
        raise RobotFault("found no link, expected <link name=...> in <robot>")
    child_of = _children(joints, links)
    ordered = _from_the_root(links, joints, child_of)
    moving = [name for name in child_of.values() if joints[name].get("type") != FIXED]
    return Robot(
        name=root.get("name") or "robot",
        links=tuple(_link(name, links[name], child_of.get(name), joints) for name in ordered),
        transmissions=tuple(_efforts(root, {name: joints[name] for name in moving})),
        relations=tuple(_mimics(joints, child_of)),
        notes=(f"the root link {ordered[0]} is fixed to ground",),
    )


def _parsed(text: str) -> Element:
    try:
        root = ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        raise RobotFault(f"found no well-formed XML ({error}), expected a URDF file") from None
    if root.tag != "robot":
        raise RobotFault(f"found <{root.tag}>, expected <robot> of a URDF file")
    for element in root.iter():
        if "xacro" in element.tag or any("${" in value for value in element.attrib.values()):
            raise RobotFault(
                f"found the macro <{element.tag.split('}')[-1]}>, expected plain URDF: run xacro on it first"
            )
    return root


def _named(root: Element, tag: str) -> Iterator[tuple[str, Element]]:
    known = set()
    for element in root.findall(tag):
        name = element.get("name")
        if not name:
            raise RobotFault(f"found a {tag} without a name, expected <{tag} name=...>")
        if name in known:
            raise RobotFault(f"found two {tag}s {name}, expected one of each name")
        known.add(name)
        yield name, element


def _children(joints: dict[str, Element], links: dict[str, Element]) -> dict[str, str]:
    """The joint that carries each link."""
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
            raise RobotFault(f"link {child}: found two joints that carry it, {found[child]} and {name}, expected one")
        found[child] = name
    return found


def _end(joint: Element, role: str) -> str | None:
    end = joint.find(role)
    return None if end is None else end.get("link")


def _from_the_root(links: dict[str, Element], joints: dict[str, Element], child_of: dict[str, str]) -> list[str]:
    """Links, each after its parent."""
    roots = [name for name in links if name not in child_of]
    if len(roots) != 1:
        found = ", ".join(roots) or "none"
        raise RobotFault(f"found the links {found} that no joint carries, expected one, the root of the tree")
    carried: dict[str, list[str]] = {}
    for child, joint in child_of.items():
        carried.setdefault(_end(joints[joint], "parent") or "", []).append(child)
    ordered = roots
    for name in ordered:  # grows while it is gone through
        ordered.extend(carried.get(name, ()))
    if len(ordered) < len(links):
        lost = ", ".join(name for name in links if name not in ordered)
        raise RobotFault(f"found links that carry each other in a circle, {lost}, expected a tree")
    return ordered


def _link(name: str, element: Element, joint: str | None, joints: dict[str, Element]) -> Link:
    mass, centre, inertia = _inertial(name, element.find("inertial"))
    if joint is None:
        return Link(name, None, mass=mass, center_of_mass=centre, inertia=inertia)
    carrier = joints[joint]
    position, orientation = _origin(f"joint {joint}", carrier)
    return Link(
        name, _end(carrier, "parent"), position, orientation, mass, centre, inertia, tuple(_moving(joint, carrier))
    )


def _inertial(name: str, element: Element | None) -> tuple[float, tuple[float, ...], np.ndarray]:
    """Mass, centre of mass and inertia of a link, along the link's axes; nothing without an <inertial>."""
    if element is None:
        return 0.0, ORIGIN, np.zeros((3, 3))
    where = f"link {name}"
    centre, turned = _origin(where, element)
    mass = _value(where, element.find("mass"), "value", 0.0)
    moments = element.find("inertia")
    xx, xy, xz, yy, yz, zz = (_value(where, moments, key, 0.0) for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"))
    A = matrix(turned)
    tensor = A @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ A.T
    if mass < 0:
        raise RobotFault(f"{where}: found a mass of {mass:g}, expected 0 or more")
    return mass, centre, (tensor + tensor.T) / 2


def _moving(name: str, element: Element) -> Iterator[LinkJoint]:
    """The joints that a joint of URDF is: none of a fixed one, two slides and a hinge of a planar one."""
    kind = element.get("type")
    if kind == FIXED:
        return
    where, axis = f"joint {name}", _axis(name, element)
    dynamics, limits = element.find("dynamics"), element.find("limit")
    damping, friction = (_value(where, dynamics, key, 0.0) for key in ("damping", "friction"))
    if kind == PLANAR:
        across = np.linalg.svd(np.array([axis]))[2][1:]
        for letter, direction in zip("xy", across, strict=True):
            yield LinkJoint(f"{name}_{letter}", "slide", axis=tuple(map(float, direction)), damping=damping)
        yield LinkJoint(name, "hinge", axis=axis, damping=damping)
        return
    bounds = None
    if limits is not None and kind in ("revolute", "prismatic"):
        bounds = (_value(where, limits, "lower", 0.0), _value(where, limits, "upper", 0.0))
    yield LinkJoint(name, KINDS[kind or ""], axis=axis, damping=damping, friction=friction, limits=bounds)


def _axis(name: str, element: Element) -> tuple[float, ...]:
    given = element.find("axis")
    axis = np.array(_numbers(f"joint {name}", "axis", given.get("xyz", "1 0 0") if given is not None else "1 0 0"))
    length = float(np.linalg.norm(axis))
    if length == 0:
        raise RobotFault(f"joint {name}: found an axis of length 0, expected a direction")
    return tuple(map(float, axis / length))


def _efforts(root: Element, moving: dict[str, Element]) -> Iterator[Transmission]:
    given = [joint.get("name") for joint in root.findall("transmission/joint")]
    for name, element in moving.items():
        limit = element.find("limit")
        effort = 0.0 if limit is None else _value(f"joint {name}", limit, "effort", 0.0)
        driven = name in given if given else effort > 0
        if driven and element.get("type") in ("revolute", "continuous", "prismatic") and element.find("mimic") is None:
            yield Transmission(name, {name: 1.0}, force=(-effort, effort) if effort > 0 else None)


def _mimics(joints: dict[str, Element], child_of: dict[str, str]) -> Iterator[Relation]:
    for name in child_of.values():
        mimic = joints[name].find("mimic")
        if mimic is None:
            continue
        where, other = f"joint {name}", mimic.get("joint")
        if other not in joints or joints[name].get("type") not in KINDS or joints[other].get("type") not in KINDS:
            raise RobotFault(
                f"{where}: found that it mimics {other}, expected a revolute, continuous or prismatic joint"
            )
        multiplier, offset = _value(where, mimic, "multiplier", 1.0), _value(where, mimic, "offset", 0.0)
        yield Relation(f"{name}_mimic", name, other, (offset, multiplier))


def _origin(where: str, element: Element) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Position and orientation of an <origin>: turns by roll, pitch and yaw about the fixed axes x, y and z."""
    origin = element.find("origin")
    if origin is None:
        return ORIGIN, SAME_AXES
    roll, pitch, yaw = _numbers(where, "rpy", origin.get("rpy", "0 0 0"))
    turned = product(product(about(2, yaw), about(1, pitch)), about(0, roll))
    return tuple(_numbers(where, "xyz", origin.get("xyz", "0 0 0"))), turned


def _numbers(where: str, key: str, text: str) -> list[float]:
    try:
        found = [float(word) for word in text.split()]
    except ValueError:
        found = []
    if len(found) != 3 or not np.all(np.isfinite(found)):
        raise RobotFault(f"{where}: found {key}='{text}', expected three numbers")
    return found


def _value(where: str, element: Element | None, key: str, default: float) -> float:
    text = None if element is None else element.get(key)
    if text is None:
        return default
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not np.isfinite(value):
        raise RobotFault(f"{where}: found {key}='{text}', expected a number")
    return value
