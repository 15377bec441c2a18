"""Point-on-curve and curve-to-curve joints.  MSC Adams/Solver, PTCV and CVCV statements.

At a curve-to-curve contact a light auxiliary body has its point on both curves and its x axis along both tangents.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ...elements.spatial.massless import MASSLESS, massless_moment
from ...elements.spatial.number_format import plain, quaternion, vector
from ..statements.curves import CurveOnCurve, FirstContact, PointOnCurve
from ..statements.declared import Numbered
from ..statements.geometry import Frame
from ..statements.text import of_each
from .fitted_curves import FittedCurve, fitted_curve
from .mechanism import Mechanism

TOUCH, OTHER, LEVEL = "_touch", "_other", "_plane"
"""Name suffixes for a CVCV: the auxiliary body, its joint with the first curve, and its `parallel` joint."""

ELSEWHERE = 0.01
"""Tolerance on the stated first contact point relative to the drawn marker, as a fraction of the curve's size."""


def curves(mechanism: Mechanism) -> dict[str, object]:
    """Return the curve joints of the scene by name."""
    return of_each(
        mechanism.dataset.points_on_curves.values(), lambda one: {one.name: _on_curve(one, mechanism)}
    ) | of_each(mechanism.dataset.curves_on_curves.values(), lambda pair: _touching(pair, mechanism))


def touching_bodies(mechanism: Mechanism) -> dict[str, object]:
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
        yield f"{labels}: the curve is a cubic spline through the points of its MATRIX; Adams' curve may differ between them"


def _on_curve(one: PointOnCurve, mechanism: Mechanism) -> dict[str, object]:
    i, j = mechanism.place(one.i, one, "I"), mechanism.place(one.axes, one, "RM")
    curve = fitted_curve(one, one.curve, j, mechanism)
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


def _curves(pair: CurveOnCurve, mechanism: Mechanism) -> tuple[FittedCurve, FittedCurve]:
    first, second = (
        fitted_curve(pair, number, mechanism.place(axes, pair, name), mechanism)
        for number, axes, name in zip(pair.curves, pair.axes, ("IRM", "JRM"), strict=True)
    )
    for number, curve in zip(pair.curves, (first, second), strict=True):
        if curve.off is not None:
            off = np.max(np.abs(curve.off))
            raise pair.fault(f"found CURVE/{number}, which leaves its plane by {off:.6g} m, expected a flat one")
    return first, second


def _touching(pair: CurveOnCurve, mechanism: Mechanism) -> dict[str, object]:
    """Return the joints of an auxiliary body; the first applies its force to the part of the first curve."""
    first, second = _curves(pair, mechanism)
    touch = pair.name + TOUCH
    follows = {"type": "tangent_to_curve", "i": touch}
    return {
        pair.name: {**follows, "j": second.marker, **second.law},
        pair.name + OTHER: {**follows, "j": first.marker, **first.law},
        pair.name + LEVEL: {"type": "parallel", "i": touch, "j": second.marker},
    }


def _body(pair: CurveOnCurve, mechanism: Mechanism) -> dict[str, object]:
    """Return the auxiliary body at the contact point: x along the tangent, z normal to the second curve's plane."""
    first, second = _curves(pair, mechanism)
    near, also_near = (_ground_point(start, pair, mechanism) for start in pair.starts)
    start = first_touch(first, second, (near, also_near))
    if start.apart > start.size:
        raise pair.fault(
            f"found curves that do not touch (gap of {start.apart:.6g} m as drawn), expected curves in contact"
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


SAMPLES = 400
"""Number of points per curve in the coarse search."""


@dataclass(frozen=True, eq=False)
class Touching:
    """Closest contact candidate of two curves, in ground axes.

    `point`, `tangent` of shape (3,): midpoint between the curves, m, and unit tangent of the second curve. `apart`:
    distance between the curves, m. `size`: size of the smaller curve, m.
    """

    point: np.ndarray
    tangent: np.ndarray
    apart: float
    size: float


def first_touch(first: FittedCurve, second: FittedCurve, near: tuple[np.ndarray | None, np.ndarray | None]) -> Touching:
    """Return the contact point of two curves, or the point where they nearly touch.

    Contact needs coincident points and parallel tangents; as drawn, curves may be apart or cross. If a point `near` a
    curve is given, m, the search starts at the nearest point of that curve.
    """
    from scipy.optimize import least_squares

    curves = _Sampled(first), _Sampled(second)
    size = min(curve.size for curve in curves)
    s, t = (curve.parameters_near(point) for curve, point in zip(curves, near, strict=True))
    (a, a_tangent), (b, b_tangent) = curves[0](s), curves[1](t)
    apart = np.linalg.norm(a[:, None, :] - b[None, :, :], axis=2)
    crossed = 1 - (a_tangent @ b_tangent.T) ** 2
    k, m = np.unravel_index(int(np.argmin(apart**2 + size**2 * crossed)), apart.shape)

    def missed(at: np.ndarray) -> np.ndarray:
        (a, a_tangent), (b, b_tangent) = curves[0](at[:1]), curves[1](at[1:])
        return np.concatenate([(a - b)[0], size * np.cross(a_tangent, b_tangent)[0]])

    found = least_squares(missed, [s[k], t[m]], xtol=1e-14, ftol=1e-14, gtol=1e-14).x
    (a, _), (b, b_tangent) = curves[0](found[:1]), curves[1](found[1:])
    return Touching((a[0] + b[0]) / 2, b_tangent[0], float(np.linalg.norm(a[0] - b[0])), size)


class _Sampled:
    """Points and unit tangents of a curve over x, or over the angle of a closed curve, in ground axes at the start."""

    def __init__(self, curve: FittedCurve) -> None:
        from scipy.interpolate import CubicSpline

        self._curve = curve
        self._law = CubicSpline(curve.arguments, curve.values, bc_type=curve.ends)
        self.parameters = np.linspace(curve.arguments[0], curve.arguments[-1], SAMPLES)
        self.size = float(np.max(np.ptp(self(self.parameters)[0], axis=0)))

    def parameters_near(self, point: np.ndarray | None) -> np.ndarray:
        """Return all parameters, or that of the sample nearest to a point."""
        if point is None:
            return self.parameters
        return self.parameters[[int(np.argmin(np.linalg.norm(self(self.parameters)[0] - point, axis=1)))]]

    def __call__(self, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        value, slope = self._law(s), self._law(s, 1)
        flat, tangents = (s, value), (np.ones_like(s), slope)
        if self._curve.closed:
            c, d = np.cos(s), np.sin(s)
            flat, tangents = (value * c, value * d), (slope * c - value * d, slope * d + value * c)
        axes = self._curve.initial.axes[:, :2]
        along = np.column_stack(tangents) @ axes.T
        point = self._curve.initial.point + np.column_stack(flat) @ axes.T
        return point, along / np.linalg.norm(along, axis=1)[:, None]
