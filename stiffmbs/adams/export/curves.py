"""PTCV and CVCV statements for points on curves and curve-to-curve joints.

Curve-to-curve contact is modelled with an auxiliary light body, two joints `tangent_to_curve` and one `parallel`
(`stiffmbs.adams.scene.curves`). The auxiliary body is not exported.
"""

from __future__ import annotations

import itertools
from collections.abc import Generator, Iterator
from typing import Any

import numpy as np

from ...elements.joints.point_on_curve import Curve
from ...elements.spatial.joints.parallel import Parallel
from ...elements.spatial.joints.tangent_to_curve import TangentToCurve
from ...elements.spatial.orientation import matrix
from ...model.spatial_model import SpatialData
from ...reading.files.written_fields import written
from ...reading.marker import GROUND, MarkerReference
from ...reading.table import Table
from .numbering import Numbering, Refusal, numbers, statement


def touching(model: SpatialData) -> dict[str, tuple[str, str, str]]:
    """Return the joints of each auxiliary body of a curve pair: on the second curve, on the first, and `parallel`."""
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
    """Exporter of the curves of one scene."""

    def __init__(self, model: SpatialData, numbering: Numbering) -> None:
        self._model, self._numbering = model, numbering
        self._curves, self._constraints = itertools.count(1), itertools.count(1)
        self._touching = {names[0]: (body, names) for body, names in touching(model).items()}
        self.parts_of_a_pair = {name for _, names in self._touching.values() for name in names[1:]}

    def point(self, joint: Curve[Any]) -> Iterator[str]:
        """Yield the statements of a point that stays on a curve."""
        number = yield from self._curve(joint)
        i, axes = self._numbering.marker(joint.i), self._numbering.marker(joint.j)
        floating = f"JFLOAT = {self._numbering.floating(joint.j.body)}"
        yield statement("PTCV", next(self._constraints), f"CURVE = {number}", f"I = {i}", floating, f"RM = {axes}")

    def pair(self, name: str) -> Iterator[str]:
        """Yield the statements of two curves in contact at the first joint of their body; nothing at its other joints.

        Raises Refusal if the joint does not belong to such a pair.
        """
        if name in self.parts_of_a_pair:
            return
        if name not in self._touching:
            raise Refusal("found a joint along one curve, expected the three of a body where two curves touch")
        body, names = self._touching[name]
        second, first = (self._model.joints[joint] for joint in names[:2])
        assert isinstance(first, TangentToCurve) and isinstance(second, TangentToCurve)
        for auxiliary in (self._model.bodies[body], *(self._model.joints[joint] for joint in names)):
            written(auxiliary)  # CVCV stands for all of them
        sides = []
        for side, joint in (("I", first), ("J", second)):
            number = yield from self._curve(joint)
            at = self._seen(self._model.bodies[body].position, joint.j)
            sides += [
                f"{side}CURVE = {number}", f"{side}FLOAT = {self._numbering.floating(joint.j.body)}",
                f"{side}RM = {self._numbering.marker(joint.j)}", f"{side}DISPLACEMENT = {numbers(at)}",
            ]  # fmt: skip
        yield statement("CVCV", next(self._constraints), *sides)

    def _curve(self, joint: Curve[Any]) -> Generator[str, None, int]:
        """Yield the statements of a curve; return its number."""
        points = _points(joint)
        number = next(self._curves)
        values = f"VALUES = {numbers(points.ravel())}"
        yield statement("MATRIX", number, "FULL = RORDER", f"M = {len(points)}", "N = 3", values)
        sort = "OPEN" if joint.radius is None else "CLOSED"
        yield statement("CURVE", number, sort, "CURVE_POINTS", "ORDER = 4", f"MATRIX = {number}")
        return number

    def _seen(self, point: object, marker: MarkerReference) -> np.ndarray:
        """Return a point of the ground in the axes of a marker at the start."""
        place = self._model.place(marker)
        origin, axes = np.zeros(3), np.eye(3)
        if marker.body != GROUND:
            body = self._model.bodies[marker.body]
            origin, axes = np.array(body.position), np.array(matrix(body.orientation))
        turned = axes @ np.array(matrix(place.orientation))
        found: np.ndarray = turned.T @ (np.array(point) - origin - axes @ np.array(place.point))
        return found


def _points(joint: Curve[Any]) -> np.ndarray:
    """Return the points of a curve in the axes of its marker, m."""
    closed = joint.radius is not None
    value, off = joint.radius if closed else joint.y, getattr(joint, "height" if closed else "z", None)
    ends = "periodic" if closed else "not-a-knot"
    along, across = _columns(value, ends)
    abscissae, height = (along, np.zeros(len(along))) if off is None else _columns(off, ends)
    if not np.array_equal(abscissae, along):
        raise Refusal("found two tables of a curve with different arguments, expected the same")
    if not closed:
        return np.column_stack([along, across, height])
    points = np.column_stack([across * np.cos(along), across * np.sin(along), height])
    points[-1] = points[0]
    return points


def _columns(law: object, ends: str) -> np.ndarray:
    """Return arguments and values of a spline table with the given end conditions."""
    if not isinstance(law, Table) or law.ends != ends:
        raise Refusal(f"found a curve by another law, expected a table with 'ends: {ends}'")
    return np.array(law.table).T
