"""Points on curves as joints of a scene, which knows flat curves: y over x, or the radius over the angle of a closed one.

The curve goes through the points of its MATRIX as a cubic spline.  Adams' goes through the same points by its own parameter, so that
the two differ between them.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from ...describe.spatial.number_format import plain, quaternion, vector
from ..statements.curves import PointOnCurve
from ..statements.fault import of_each
from ..statements.geometry import Frame
from .mechanism import Mechanism

FLAT = 1e-6
"""Part of a curve's size by which its points may leave a plane."""
FEWEST = 4


def curves(mechanism: Mechanism) -> dict[str, Any]:
    """The joints of the scene by name."""
    return of_each(_all(mechanism), lambda one: {one.name: _joint(one, mechanism)})


def notes(mechanism: Mechanism) -> Iterator[str]:
    """How the curve may differ from that of Adams, in one sentence."""
    labels = ", ".join(one.label for one in _all(mechanism))
    if labels:
        yield f"{labels}: the curve is a cubic spline through the points of its MATRIX, which Adams may lay otherwise between them"


def _all(mechanism: Mechanism) -> list[PointOnCurve]:
    return list(mechanism.dataset.statements.get("PTCV", {}).values())


def _joint(one: PointOnCurve, mechanism: Mechanism) -> dict[str, Any]:
    points, closed = _points(one, mechanism)
    i, j = mechanism.place(one.i, one, "I"), mechanism.place(one.axes, one, "RM")
    frame = _plane(one, points, closed)
    seen = (points - frame.point) @ frame.axes
    law = _radius(one, seen) if closed else _height(one, seen)
    on_body = frame.within(j.on_body)
    marker = {"body": j.body, "point": vector(on_body.point), "orientation": quaternion(on_body.axes)}
    return {"type": "point_on_curve", "i": i.reference, "j": marker, **law}


def _points(one: PointOnCurve, mechanism: Mechanism) -> tuple[np.ndarray, bool]:
    """The points of a curve in the axes of marker RM, m; the last of a closed one is the first again."""
    statements = mechanism.dataset.statements
    curve = statements.get("CURVE", {}).get(one.curve)
    if curve is None:
        raise one.fault(f"found CURVE = {one.curve}, expected the number of a CURVE")
    if curve.unread:
        raise one.fault(f"{curve.label}: {curve.unread}; expected CURVE_POINTS of order 4 in a MATRIX")
    matrix = statements.get("MATRIX", {}).get(curve.matrix)
    points = np.array(matrix.rows if matrix else []) * mechanism.dataset.units.length
    if points.ndim != 2 or points.shape[1] != 3 or len(points) < FEWEST:
        raise one.fault(f"found MATRIX = {curve.matrix} of {curve.label}, expected {FEWEST} rows or more of x, y and z")
    size = float(np.max(np.ptp(points, axis=0)))
    ends = float(np.max(np.abs(points[0] - points[-1])))
    if curve.closed and ends > FLAT * size:
        raise one.fault(
            f"found a first and a last point {ends:.6g} m apart in the closed {curve.label}, expected one point"
        )
    return points, curve.closed


def _plane(one: PointOnCurve, points: np.ndarray, closed: bool) -> Frame:
    """Axes whose x and y are in the curve's plane: about its middle for a closed one, else from its first point to its last."""
    own = points[:-1] if closed else points
    middle = own.mean(axis=0)
    _, sizes, ways = np.linalg.svd(own - middle)
    x = ways[0] if closed else (points[-1] - points[0]) / (np.linalg.norm(points[-1] - points[0]) or 1.0)
    normal = ways[2] if sizes[1] > FLAT * sizes[0] else _across(x)
    off = float(np.max(np.abs((own - middle) @ normal)))
    if off > FLAT * float(np.max(np.ptp(points, axis=0))):
        raise one.fault(f"found a curve that leaves its plane by {off:.6g} m, expected a flat one")
    x = x - (x @ normal) * normal
    x /= np.linalg.norm(x)
    return Frame(middle if closed else points[0], np.column_stack([x, np.cross(normal, x), normal]))


def _across(x: np.ndarray) -> np.ndarray:
    """A direction across another one."""
    across = np.cross(x, np.eye(3)[int(np.argmin(np.abs(x)))])
    found: np.ndarray = across / np.linalg.norm(across)
    return found


def _height(one: PointOnCurve, seen: np.ndarray) -> dict[str, Any]:
    """y over x."""
    if np.any(np.diff(seen[:, 0]) <= 0):
        raise one.fault(
            "found an open curve that turns back on the way from its first point to its last, expected none"
        )
    return {"y": {"table": [[plain(x), plain(y)] for x, y, _ in seen], "ends": "not-a-knot"}}


def _radius(one: PointOnCurve, seen: np.ndarray) -> dict[str, Any]:
    """The distance from the middle over the angle, anticlockwise, over one turn."""
    angles = np.unwrap(np.arctan2(seen[:, 1], seen[:, 0]))
    radii = np.hypot(seen[:, 0], seen[:, 1])
    if angles[-1] < angles[0]:
        angles, radii = angles[::-1], radii[::-1]
    turned = angles[-1] - angles[0]
    if np.any(np.diff(angles) <= 0) or abs(turned - 2 * np.pi) > 1e-6:
        raise one.fault(
            "found a closed curve that a line from its middle meets more than once, expected a convex or nearly convex one"
        )
    angles[-1], radii[-1] = angles[0] + 2 * np.pi, radii[0]
    return {"radius": {"table": [[plain(a), plain(r)] for a, r in zip(angles, radii, strict=True)], "ends": "periodic"}}
