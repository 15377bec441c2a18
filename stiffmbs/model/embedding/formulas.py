"""Planar formulas with spatial names, and the angles in them.

Sine and cosine define an initial angle in space up to full turns, and near half a turn rounding determines its sign.
Initial angles beyond a quarter turn are therefore measured from an added marker without the initial angle, which is
then added.
"""

from __future__ import annotations

import ast
import copy
import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from ...elements.requests.names import OF_PLANE
from ...elements.requests.output import Output
from ...reading.files.yaml_text import Content
from ...reading.formula.formula import Formula
from ...reading.formula.full_names import with_full_names
from ...reading.formula.nodes import measured_markers
from ...reading.formula.text import UNIT, as_written
from ...reading.joint_name import JOINT_CHANNELS
from ...reading.marker import GROUND, MarkerReference, Placement
from ...reading.names import Names
from ..model import PlanarData
from ..scene import Scene

Written = Content
"""Part of a scene as in its file."""


def turned(angle: float) -> Written:
    """Return the orientation of a rotation about the normal, rad; empty for zero."""
    return {"orientation": {"euler": "zxz", "angles": [angle, 0, 0]}} if angle else {}


def along(angle: float) -> Written:
    """Return the orientation with z, the axis of spatial joints, along a planar marker; its y is the normal."""
    return {"orientation": {"z": [math.cos(angle), math.sin(angle), 0], "y": [0, 0, 1]}}


def across(angle: float) -> Written:
    """Return the orientation with z along a planar marker's normal, and x along its direction."""
    return {"orientation": {"z": [-math.sin(angle), math.cos(angle), 0], "x": [math.cos(angle), math.sin(angle), 0]}}


def placement(placed: Placement) -> Written:
    """Return a named marker of a body or of ground."""
    return {**point(placed.point), **turned(placed.angle)}


def point(place: tuple[float, float]) -> Written:
    """Return a point in a body's axes; empty for the origin."""
    return {"point": [*place, 0]} if any(place) else {}


QUARTER = math.pi / 2


@dataclass(frozen=True)
class Angles:
    """Angles of a planar model, and the markers added to measure them."""

    data: PlanarData
    added: dict[str, dict[str, Written]] = field(default_factory=dict)  # added markers by name, by body
    later: bool = False  # True for an element that starts to act after the described pose

    @property
    def starts_later(self) -> frozenset[str]:
        """Names of the elements of a stage that start to act after the described pose."""
        source = self.data.written if isinstance(self.data, Scene) else None
        return source.starts_later if source else frozenset()

    def initial(self, i: MarkerReference, j: MarkerReference) -> float:
        """Return the angle of one marker relative to another in the described poses, rad."""
        return self.data.initial_marker(i).angle - self.data.initial_marker(j).angle

    def measured(self, i: MarkerReference, j: MarkerReference) -> str:
        """Return a formula for the angle of a named marker relative to another one."""
        initial = self.initial(i, j)
        if abs(initial) <= QUARTER:
            return f"az({i.label}, {j.label})"
        return f"(az({i.body}.{self._untwisted(i, initial)}, {j.label}) + {initial!r})"

    def _untwisted(self, i: MarkerReference, initial: float) -> str:
        """Return the name of a marker at marker i without its initial angle."""
        placed = self.data.place(i)
        marker = {**point(placed.point), **turned(placed.angle - initial)}
        own = self.data.markers if i.body == GROUND else self.data.bodies[i.body].markers
        added = self.added.setdefault(i.body, {})
        for name in map("drawn{}".format, itertools.count(1)):
            if name not in own and added.setdefault(name, marker) == marker:
                return name
        raise AssertionError


def formula(found: Formula, angles: Angles) -> str | float:
    """Return a formula of a spatial scene: its number, its text, or the text with other names."""
    return _written(found.text, found.tree, angles)


def request(found: Output | Mapping[str, Output], angles: Angles) -> str | float | Written:
    """Return a request of a spatial scene, with formulas by component."""
    if isinstance(found, Output):
        names = Names(frozenset(angles.data.bodies))
        tree = with_full_names(found.written_tree(), names, (*OF_PLANE.measures, *OF_PLANE.actions))
        return _written(found.text, tree, angles)
    return {name: request(output, angles) for name, output in found.items()}


def _written(text: str, tree: ast.expr, angles: Angles) -> str | float:
    try:
        return float(text)
    except ValueError:
        renamed = _Renamed(angles)
        tree = renamed.visit(copy.deepcopy(tree))
        return as_written(tree) if renamed.any else text


class _Renamed(ast.NodeTransformer):
    """Replace ``bar.angle``, ``bar.omega``, ``bar.alpha`` and ``az(a, b)`` by measures, and ``torque`` by ``tz``."""

    def __init__(self, angles: Angles) -> None:
        self._angles = angles
        self.any = False

    def visit_Attribute(self, node: ast.Attribute) -> ast.AST:
        """Replace the rotation of a body or a joint's coordinate."""
        owner, data = node.value.id, self._angles.data  # type: ignore[attr-defined]
        if owner in data.requests or owner == UNIT:
            return node
        if owner in data.joints and node.attr in JOINT_CHANNELS:
            return node
        match node.attr:
            case "angle":
                return self._angle(MarkerReference(body=owner), MarkerReference(body=GROUND))
            case "omega":
                return self._read(f"wz({owner})")
            case "alpha":
                return self._read(f"wdtz({owner})")
            case "torque":
                return self._read(f"{owner}.tz")
        return node

    def visit_Call(self, node: ast.Call) -> ast.AST:
        """Replace ``az``, and arguments of functions."""
        called = node.func.id  # type: ignore[attr-defined]
        if called not in (*OF_PLANE.measures, *OF_PLANE.actions):
            return ast.Call(node.func, [self.visit(argument) for argument in node.args], [])
        if called == "az":
            i, j, *_ = measured_markers(node)
            return self._angle(i, j)
        return node

    def _angle(self, i: MarkerReference, j: MarkerReference) -> ast.AST:
        return self._read(self._angles.measured(i, j))

    def _read(self, text: str) -> ast.AST:
        self.any = True
        return ast.parse(text, mode="eval").body
