"""Point-on-curve and curve-to-curve joints.  MSC Adams/Solver, PTCV and CVCV statements.

At a curve-to-curve contact a light auxiliary body has its point on both curves and its x axis along both tangents.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from ...elements.spatial.massless import MASSLESS, massless_moment
from ...elements.spatial.number_format import plain, quaternion, vector
from ..statements.arguments import Numbered
from ..statements.curves import CurveOnCurve, FirstContact, PointOnCurve
from ..statements.fault import of_each
from ..statements.geometry import Frame
from .first_touch import first_touch
from .laid_curves import LaidCurve, laid_curve
from .mechanism import Mechanism

TOUCH, OTHER, LEVEL = "_touch", "_other", "_plane"
"""Name suffixes for a CVCV: the auxiliary body, its joint with the first curve, and its `parallel` joint."""

ELSEWHERE = 0.01
"""Tolerance on the stated first contact point relative to the drawn marker, as a fraction of the curve's size."""


def curves(mechanism: Mechanism) -> dict[str, Any]:
    """Return the curve joints of the scene by name."""
    return of_each(
        mechanism.dataset.points_on_curves.values(), lambda one: {one.name: _on_curve(one, mechanism)}
    ) | of_each(mechanism.dataset.curves_on_curves.values(), lambda pair: _touching(pair, mechanism))


def touching_bodies(mechanism: Mechanism) -> dict[str, Any]:
    """Return the auxiliary bodies of curve-to-curve contacts by name."""
    return of_each(
        mechanism.dataset.curves_on_curves.values(), lambda pair: {pair.name + TOUCH: _body(pair, mechanism)}
    )


def notes(mechanism: Mechanism) -> Iterator[str]:
    """Yield a sentence that lists the curves interpolated by cubic splines."""
    labels = ", ".join(
        one.label
        for one in (*mechanism.dataset.points_on_curves.values(), *mechanism.dataset.curves_on_curves.values())
    )
    if labels:
        yield f"{labels}: the curve is a cubic spline through the points of its MATRIX, which Adams may lay otherwise between them"


def _on_curve(one: PointOnCurve, mechanism: Mechanism) -> dict[str, Any]:
    i, j = mechanism.place(one.i, one, "I"), mechanism.place(one.axes, one, "RM")
    curve = laid_curve(one, one.curve, j, mechanism)
    start = _ground_point(one.start, one, mechanism)
    apart = 0.0 if start is None else float(np.linalg.norm(start - i.initial.point))
    if apart > ELSEWHERE * curve.size:
        raise one.fault(f"found DISPLACEMENT {apart:.6g} m from where marker I is drawn, expected the same place")
    return {"type": "point_on_curve", "i": i.reference, "j": curve.marker, **curve.law}


def _ground_point(start: FirstContact | None, user: Numbered, mechanism: Mechanism) -> np.ndarray | None:
    """Return the initial contact point in ground axes, m."""
    if start is None:
        return None
    axes = mechanism.place(start.axes, user, "ICM").initial
    found: np.ndarray = axes.point + axes.axes @ np.array(start.point)
    return found


def _curves(pair: CurveOnCurve, mechanism: Mechanism) -> tuple[LaidCurve, LaidCurve]:
    first, second = (
        laid_curve(pair, number, mechanism.place(axes, pair, name), mechanism)
        for number, axes, name in zip(pair.curves, pair.axes, ("IRM", "JRM"), strict=True)
    )
    for number, curve in zip(pair.curves, (first, second), strict=True):
        if curve.off is not None:
            off = np.max(np.abs(curve.off))
            raise pair.fault(f"found CURVE/{number}, which leaves its plane by {off:.6g} m, expected a flat one")
    return first, second


def _touching(pair: CurveOnCurve, mechanism: Mechanism) -> dict[str, Any]:
    """Return the joints of an auxiliary body; the first applies its force to the part of the first curve."""
    first, second = _curves(pair, mechanism)
    touch = pair.name + TOUCH
    follows = {"type": "tangent_to_curve", "i": touch}
    return {
        pair.name: {**follows, "j": second.marker, **second.law},
        pair.name + OTHER: {**follows, "j": first.marker, **first.law},
        pair.name + LEVEL: {"type": "parallel", "i": touch, "j": second.marker},
    }


def _body(pair: CurveOnCurve, mechanism: Mechanism) -> dict[str, Any]:
    """Return the auxiliary body at the contact point: x along the tangent, z normal to the second curve's plane."""
    first, second = _curves(pair, mechanism)
    near, also_near = (_ground_point(start, pair, mechanism) for start in pair.starts)
    start = first_touch(first, second, (near, also_near))
    if start.apart > start.size:
        raise pair.fault(
            f"found curves that do not touch: as drawn they come no nearer than {start.apart:.6g} m, expected them to touch"
        )
    z = second.initial.axes[:, 2]
    frame = Frame(start.point, np.column_stack([start.tangent, np.cross(z, start.tangent), z]))
    places = (mechanism.placed(marker).initial.point for marker in mechanism.dataset.markers.values())
    moment = plain(massless_moment(mechanism.least, places))
    moving = {"open": ["velocity", "omega"]} if mechanism.moves_at_start else {}
    return {
        "mass": plain(MASSLESS * mechanism.least), "inertia": [moment] * 3, "position": vector(frame.point),
        "orientation": quaternion(frame.axes), **moving,
    }  # fmt: skip
