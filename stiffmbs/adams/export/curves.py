"""Points on curves and curves that touch as PTCV and CVCV statements.

Two curves touch by a slight body with two joints `tangent_to_curve` and one `parallel` (`stiffmbs.adams.scene.curves`): that body is
no part of the dataset.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator
from typing import Any

import numpy as np

from ...describe.joints.point_on_curve import Curve
from ...describe.marker import GROUND, MarkerReference
from ...describe.spatial.joints.parallel import Parallel
from ...describe.spatial.joints.tangent_to_curve import TangentToCurve
from ...describe.spatial.model import SpatialData
from ...describe.spatial.orientation import matrix
from ...describe.table import Table
from .numbering import Numbering
from .refusal import Refusal
from .statements import numbers, statement


def touching(model: SpatialData) -> dict[str, tuple[str, str, str]]:
    """The joints of each body where two curves touch: on the second curve, on the first, and the one that turns the body."""
    found: dict[str, list[str]] = {}
    for name, joint in model.joints.items():
        for _, marker in joint.markers():
            found.setdefault(marker.body, []).append(name)
    forces = {marker.body for force in model.forces.values() for _, marker in force.markers()}
    kinds = TangentToCurve, TangentToCurve, Parallel
    return {
        body: (names[0], names[1], names[2])
        for body, names in found.items()
        if body != GROUND
        and body not in forces
        and len(names) == len(kinds)
        and all(isinstance(model.joints[name], kind) for name, kind in zip(names, kinds, strict=True))
    }


class Curves:
    """Writes the curves of one scene.

    Parameters
    ----------
    model : SpatialData
    numbering : Numbering
    """

    def __init__(self, model: SpatialData, numbering: Numbering) -> None:
        self._model, self._numbering = model, numbering
        self._curves = self._constraints = 0
        self._touching = {names[0]: (body, names) for body, names in touching(model).items()}
        self._parts_of_a_pair = {name for _, names in self._touching.values() for name in names[1:]}

    def point(self, joint: Curve[Any]) -> Iterator[str]:
        """A point that stays on a curve."""
        number = yield from self._curve(joint)
        i, axes = self._numbering.marker(joint.i), self._numbering.marker(joint.j)
        floating = f"JFLOAT = {self._numbering.floating(joint.j.body)}"
        yield statement("PTCV", self._next(), f"CURVE = {number}", f"I = {i}", floating, f"RM = {axes}")

    def pair(self, name: str) -> Iterator[str]:
        """Two curves that touch, at the first joint of their body; nothing at its others.

        Raises
        ------
        Refusal
            Where a joint is none of such a pair.
        """
        if name in self._parts_of_a_pair:
            return
        if name not in self._touching:
            raise Refusal("found a joint along one curve, expected the three of a body where two curves touch")
        body, names = self._touching[name]
        second, first = (self._model.joints[joint] for joint in names[:2])
        assert isinstance(first, TangentToCurve) and isinstance(second, TangentToCurve)
        sides = []
        for side, joint in (("I", first), ("J", second)):
            number = yield from self._curve(joint)
            at = self._seen(self._model.bodies[body].position, joint.j)
            sides += [
                f"{side}CURVE = {number}", f"{side}FLOAT = {self._numbering.floating(joint.j.body)}",
                f"{side}RM = {self._numbering.marker(joint.j)}", f"{side}DISPLACEMENT = {numbers(at)}",
            ]  # fmt: skip
        yield statement("CVCV", self._next(), *sides)

    def is_level(self, name: str) -> bool:
        """Whether a joint is the one that turns the body of a pair."""
        return name in self._parts_of_a_pair

    def _next(self) -> int:
        self._constraints += 1
        return self._constraints

    def _curve(self, joint: Curve[Any]) -> Generator[str, None, int]:
        """The statements of a curve; gives its number."""
        points = _points(joint)
        self._curves += 1
        values = f"VALUES = {numbers(points.ravel())}"
        yield statement("MATRIX", self._curves, "FULL = RORDER", f"M = {len(points)}", "N = 3", values)
        sort = "OPEN" if joint.radius is None else "CLOSED"
        yield statement("CURVE", self._curves, sort, "CURVE_POINTS", "ORDER = 4", f"MATRIX = {self._curves}")
        return self._curves

    def _seen(self, point: Any, marker: MarkerReference) -> np.ndarray:
        """A point of the ground in the axes of a marker, at the start."""
        place = self._model.place(marker)
        origin, axes = np.zeros(3), np.eye(3)
        if marker.body != GROUND:
            body = self._model.bodies[marker.body]
            origin, axes = np.array(body.position), np.array(matrix(body.orientation))
        turned = axes @ np.array(matrix(place.orientation))
        found: np.ndarray = turned.T @ (np.array(point) - origin - axes @ np.array(place.point))
        return found


def _points(joint: Curve[Any]) -> np.ndarray:
    """The points of a curve in the axes of its marker, m."""
    closed = joint.radius is not None
    value, off = joint.radius if closed else joint.y, getattr(joint, "height" if closed else "z", None)
    ends = "periodic" if closed else "not-a-knot"
    along, across = _columns(value, ends)
    beside, height = (along, np.zeros(len(along))) if off is None else _columns(off, ends)
    if not np.array_equal(beside, along):
        raise Refusal("found two tables of a curve with different arguments, expected the same")
    if not closed:
        return np.column_stack([along, across, height])
    points = np.column_stack([across * np.cos(along), across * np.sin(along), height])
    points[-1] = points[0]
    return points


def _columns(law: Any, ends: str) -> np.ndarray:
    """Arguments and values of a table that is a spline with such ends."""
    if not isinstance(law, Table) or law.ends != ends:
        raise Refusal(f"found a curve by another law, expected a table with the ends {ends}")
    return np.array(law.table).T
