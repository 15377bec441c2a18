"""Plane curves over their arc length."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Stations:
    """Stations of curves.

    Source: courses with closed forms (`tests/studies/handling`).
    """

    spacing: float = 2.5
    """Distance between the stations of a curve, on short ones, and between the points of a path through lanes, m."""
    most_stations: int = 2000
    """Largest number of stations of a curve."""
    samples: int = 8
    """Points between two stations with which the arc length is measured."""
    outlet: float = 20.0
    """Length beyond each end of an open curve over which its curvature falls to zero, m: a second at 20 m/s, as long as a driver
    looks ahead."""


CURVES = Stations()


@dataclass(frozen=True)
class Curve:
    """Curve over its arc length; arrays of shape (n,)."""

    s: np.ndarray  # stations, m
    # x, y: position, m
    x: np.ndarray
    y: np.ndarray
    # cos, sin: direction
    cos: np.ndarray
    sin: np.ndarray
    curvature: np.ndarray  # positive to the left, 1/m
    closed: bool = False  # True if the last station is the first one

    def nearest(self, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the arc length of the nearest points, and the offsets from them, positive to the left, m."""
        from scipy.interpolate import CubicSpline
        from scipy.spatial import cKDTree

        fine = np.linspace(self.s[0], self.s[-1], CURVES.samples * len(self.s))
        curve = CubicSpline(self.s, np.stack([self.x, self.y], axis=1))
        points = np.stack([x, y], axis=1)
        s = fine[cKDTree(curve(fine)).query(points)[1]]
        for _ in range(3):  # Newton's iteration for the foot of the perpendicular
            offset, tangent = points - curve(s), curve(s, 1)
            slope = np.sum(tangent**2 - offset * curve(s, 2), axis=1)
            s = np.clip(s + np.sum(offset * tangent, axis=1) / np.maximum(slope, 0.1), self.s[0], self.s[-1])
        offset, tangent = points - curve(s), curve(s, 1)
        return s, tangent[:, 0] * offset[:, 1] - tangent[:, 1] * offset[:, 0]


def curve_through(points: np.ndarray, closed: bool = False) -> Curve:
    """Return the parametric cubic spline through points, over its arc length.

    `points` of shape (n, 2): distinct consecutive points, m. `closed`: true for a lap, whose last point joins the first
    one. Raises ValueError if there are fewer than two points (three of a lap), or two consecutive points coincide.
    """
    from scipy.interpolate import CubicSpline

    least = 3 if closed else 2
    if len(points) < least:
        raise ValueError(f"found {len(points)} points, expected {least} or more")
    if closed and np.any(points[0] != points[-1]):
        points = np.vstack([points, points[:1]])
    chords = np.linalg.norm(np.diff(points, axis=0), axis=1)
    if np.any(chords <= 0.0):
        k = int(np.argmax(chords <= 0.0))
        raise ValueError(f"found the point {tuple(map(float, points[k]))} twice in a row, expected distinct points")
    parameter = np.concatenate([[0.0], np.cumsum(chords)])
    ends = "periodic" if closed else "natural" if len(points) < 4 else "not-a-knot"
    curve = CubicSpline(parameter, points, bc_type=ends)
    count = int(np.clip(np.ceil(parameter[-1] / CURVES.spacing), 40, CURVES.most_stations))
    fine = np.linspace(0.0, parameter[-1], CURVES.samples * count + 1)
    speed = np.linalg.norm(curve(fine, 1), axis=1)
    middle = np.linalg.norm(curve((fine[1:] + fine[:-1]) / 2, 1), axis=1)
    lengths = (speed[1:] + speed[:-1] + 4 * middle) / 6 * np.diff(fine)  # Simpson's rule
    arc = np.concatenate([[0.0], np.cumsum(lengths)])
    s = np.linspace(0.0, arc[-1], count + 1)
    at = CubicSpline(arc, fine)(s)
    at[[0, -1]] = fine[[0, -1]]
    (x, y), (dx, dy), (ddx, ddy) = (curve(at, order).T for order in range(3))
    rate = np.hypot(dx, dy)
    curvature = (dx * ddy - dy * ddx) / rate**3
    found = Curve(s, x, y, dx / rate, dy / rate, curvature, closed)
    return _closing(found) if closed else found


def straightened(curve: Curve) -> Curve:
    """Return an open curve whose curvature falls linearly to zero beyond both ends, over `CURVES.outlet`.

    A spline through its stations continues it by straight lines, along which its directions and curvatures are constant.
    """
    after = _outlet(curve.x[-1], curve.y[-1], curve.cos[-1], curve.sin[-1], curve.curvature[-1])
    before = _outlet(curve.x[0], curve.y[0], -curve.cos[0], -curve.sin[0], -curve.curvature[0])
    after[0] += curve.s[-1]
    signs = (-1.0, 1.0, 1.0, -1.0, -1.0, -1.0)
    columns = zip(signs, before, _values(curve), after, strict=True)
    s, x, y, cos, sin, curvature = (np.concatenate([k * back[:0:-1], on, out[1:]]) for k, back, on, out in columns)
    return Curve(s, x, y, cos, sin, curvature)


def _outlet(x: float, y: float, cos: float, sin: float, curvature: float) -> list[np.ndarray]:
    """Return the values of a clothoid from a place to a straight line."""
    s = np.linspace(0.0, CURVES.outlet, CURVES.samples + 1)

    def heading(at: np.ndarray) -> np.ndarray:
        turned: np.ndarray = np.arctan2(sin, cos) + curvature * (at - at**2 / (2 * CURVES.outlet))
        return turned

    dx, dy = _places(s, heading)
    return [s, x + dx, y + dy, np.cos(heading(s)), np.sin(heading(s)), curvature * (1 - s / CURVES.outlet)]


def _values(curve: Curve) -> tuple[np.ndarray, ...]:
    return curve.s, curve.x, curve.y, curve.cos, curve.sin, curve.curvature


def _places(s: np.ndarray, heading: Callable[[np.ndarray], np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Return x and y from the first station on, by Gauss quadrature of the direction."""
    nodes, weights = np.polynomial.legendre.leggauss(6)
    half = np.diff(s)[:, None] / 2
    within = heading((s[1:] + s[:-1])[:, None] / 2 + half * nodes)
    x, y = (np.concatenate([[0.0], np.cumsum((half * weights * of(within)).sum(axis=1))]) for of in (np.cos, np.sin))
    return x, y


def _closing(curve: Curve) -> Curve:
    for values in (curve.x, curve.y, curve.cos, curve.sin, curve.curvature):
        values[-1] = values[0]
    return curve


def circle(radius: float, entry: float, transition: float, turns: float) -> Curve:
    """Return a straight line along x, a transition of linear curvature (clothoid), and a circle.

    The radius, m, is positive to the left. `entry` and `transition` are the lengths of the straight line and of the
    transition, m; `turns` counts turns on the circle.
    """
    length = entry + transition + 2 * np.pi * turns * abs(radius)
    s = np.linspace(0.0, length, int(np.clip(np.ceil(length / CURVES.spacing), 40, CURVES.most_stations)) + 1)

    def heading(at: np.ndarray) -> np.ndarray:
        along = np.clip(at - entry, 0.0, transition)
        on_circle = np.maximum(at - entry - transition, 0.0)
        return (along**2 / (2 * transition) if transition else 0.0) / radius + on_circle / radius

    x, y = _places(s, heading)
    part = np.clip((s - entry) / transition, 0.0, 1.0) if transition else (s >= entry).astype(float)
    angle = heading(s)
    return Curve(s, x, y, np.cos(angle), np.sin(angle), part / radius)
