"""Curves of a dataset as fitted splines: y and z over x, or radius and height over the angle of a closed curve.

The spline is cubic in this argument and passes through the points of the MATRIX. Adams uses another parameter, so the
two curves differ between the points.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...elements.spatial.number_format import plain, quaternion, vector
from ...reading.files.yaml_text import Content
from ..statements.declared import Numbered
from ..statements.geometry import IDENTITY, PRECISION, Frame
from ..statements.outputs import FEWEST_POINTS
from .mechanism import Mechanism, Place


@dataclass(frozen=True, eq=False)
class FittedCurve:
    """Curve on a body."""

    owner: Place  # the marker RM in whose axes the points are given
    frame: Frame  # axes of the curve in those of RM, x and y in the curve's plane
    closed: bool
    # arguments, values: x and y, or angle and radius, of the points
    arguments: np.ndarray
    values: np.ndarray
    off: np.ndarray | None = None  # signed distances of the points from the plane; None for a flat curve

    @property
    def marker(self) -> dict[str, object]:
        """Scene marker whose axes define the curve."""
        on_body = self.frame.within(self.owner.on_body)
        return {"body": self.owner.body, "point": vector(on_body.point), "orientation": quaternion(on_body.axes)}

    @property
    def initial(self) -> Frame:
        """Axes of the curve in ground axes at the start."""
        return self.frame.within(self.owner.initial)

    @property
    def size(self) -> float:
        """Distance from the first point to the last, or the largest diameter of a closed curve, m."""
        return float(2 * np.max(self.values) if self.closed else np.ptp(self.arguments))

    @property
    def ends(self) -> str:
        """End condition of the spline."""
        return "periodic" if self.closed else "not-a-knot"

    @property
    def law(self) -> Content:
        """Joint fields that define the curve."""
        value, off = ("radius", "height") if self.closed else ("y", "z")
        found = {value: self._table(self.values)}
        return found if self.off is None else found | {off: self._table(self.off)}

    def _table(self, values: np.ndarray) -> dict[str, object]:
        table = [[plain(a), plain(b)] for a, b in zip(self.arguments, values, strict=True)]
        return {"table": table, "ends": self.ends}


def fitted_curve(user: Numbered, number: int, owner: Place, mechanism: Mechanism) -> FittedCurve:
    """Return the curve of a constraint in the axes of a marker.

    Raises DatasetFault if the curve does not exist, or cannot be represented as a spline over x or the angle.
    """
    points, closed = _points(user, number, mechanism)
    frame = _plane(points, closed)
    seen = (points - frame.point) @ frame.axes
    flat = np.max(np.abs(seen[:, 2])) <= PRECISION * np.max(np.ptp(points, axis=0))
    if not closed and np.any(np.diff(seen[:, 0]) <= 0):
        raise user.fault(
            "found an open curve that turns back between its first and last point, expected one that advances along its chord"
        )
    arguments, values, off = _round(user, seen) if closed else seen.T
    return FittedCurve(owner, frame, closed, arguments, values, None if flat else off)


def _points(user: Numbered, number: int, mechanism: Mechanism) -> tuple[np.ndarray, bool]:
    """Return the points of a curve in the axes of marker RM, m; a closed curve repeats its first point at the end."""
    curve = mechanism.dataset.curves.get(number)
    if curve is None:
        raise user.fault(f"found CURVE = {number}, expected the number of a CURVE")
    if curve.unread:
        raise user.fault(f"{curve.label}: {curve.unread}; expected CURVE_POINTS of order 4 in a MATRIX")
    matrix = mechanism.dataset.matrices.get(curve.matrix)
    points = np.array(matrix.rows if matrix else []) * mechanism.dataset.units.length
    if points.ndim != 2 or points.shape[1] != 3 or len(points) < FEWEST_POINTS:
        raise user.fault(
            f"found MATRIX = {curve.matrix} of {curve.label}, expected {FEWEST_POINTS} rows or more of x, y and z"
        )
    size = float(np.max(np.ptp(points, axis=0)))
    ends = float(np.max(np.abs(points[0] - points[-1])))
    if curve.closed and ends > PRECISION * size:
        raise user.fault(
            f"found a first and a last point {ends:.6g} m apart in the closed {curve.label}, expected one point"
        )
    return points, curve.closed


def _plane(points: np.ndarray, closed: bool) -> Frame:
    """Return axes with x and y in the curve's plane, at the centre of a closed curve or at the first point.

    x is towards the first point of a closed curve, or along the chord. The largest component of z, the first of equal
    ones, is positive: the sign of a singular vector depends on rounding.
    """
    own = points[:-1] if closed else points
    middle, size = own.mean(axis=0), np.max(np.ptp(points, axis=0))
    _, sizes, directions = np.linalg.svd(own - middle)
    x = points[0] - middle if closed else points[-1] - points[0]
    if np.linalg.norm(x) <= PRECISION * size:
        x = directions[0]
    if np.max(np.abs(own[:, 2] - middle[2])) <= PRECISION * size:
        normal = IDENTITY[2]
    else:
        normal = directions[2] if sizes[1] > PRECISION * sizes[0] else _across(x)
        large = np.abs(normal) > (1 - np.sqrt(PRECISION)) * np.max(np.abs(normal))
        normal = normal * np.sign(normal[np.argmax(large)])
    y = np.cross(normal, x)
    y /= np.linalg.norm(y)
    x = np.cross(y, normal) if closed else x / np.linalg.norm(x)
    return Frame(middle if closed else points[0], np.column_stack([x, y, np.cross(x, y)]))


def _across(x: np.ndarray) -> np.ndarray:
    """Return a unit vector normal to a direction and to the axis of its smallest component, the first of equal ones."""
    sizes = np.abs(x)
    across = np.cross(x, IDENTITY[int(np.argmax(sizes <= np.min(sizes) + PRECISION * np.max(sizes)))])
    found: np.ndarray = across / np.linalg.norm(across)
    return found


def _round(user: Numbered, seen: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the angle over one anticlockwise turn, the radius and z."""
    angles = np.unwrap(np.arctan2(seen[:, 1], seen[:, 0]))
    radii, off = np.hypot(seen[:, 0], seen[:, 1]), seen[:, 2].copy()
    if angles[-1] < angles[0]:
        angles, radii, off = angles[::-1], radii[::-1], off[::-1]
    turned = angles[-1] - angles[0]
    if np.any(np.diff(angles) <= 0) or abs(turned - 2 * np.pi) > PRECISION:
        raise user.fault(
            "found a closed curve that a ray from its centre meets more than once, expected a convex or nearly convex one"
        )
    angles[-1], radii[-1], off[-1] = angles[0] + 2 * np.pi, radii[0], off[0]
    return angles, radii, off
