"""Initial contact point of two curves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .laid_curves import LaidCurve

SAMPLES = 400
"""Number of points per curve in the coarse search."""


@dataclass(frozen=True, eq=False)
class Touching:
    """Closest contact candidate of two curves, in ground axes.

    Attributes
    ----------
    point, tangent : ndarray, shape (3,)
        Midpoint between the curves, m, and unit tangent of the second curve.
    apart : float
        Distance between the curves, m.
    size : float
        Size of the smaller curve, m.
    """

    point: np.ndarray
    tangent: np.ndarray
    apart: float
    size: float


def first_touch(first: LaidCurve, second: LaidCurve, near: tuple[np.ndarray | None, np.ndarray | None]) -> Touching:
    """Return the contact point of two curves, or the point where they nearly touch.

    Contact needs coincident points and parallel tangents; as drawn, curves may be apart or cross. If a point `near` a
    curve is given, m, the search starts at the nearest point of that curve.
    """
    from scipy.optimize import least_squares

    curves = _Sampled(first), _Sampled(second)
    size = min(curve.size for curve in curves)
    s, t = (curve.parameters_near(point) for curve, point in zip(curves, near, strict=True))
    (a, a_way), (b, b_way) = curves[0](s), curves[1](t)
    apart = np.linalg.norm(a[:, None, :] - b[None, :, :], axis=2)
    crossed = 1 - (a_way @ b_way.T) ** 2
    k, m = np.unravel_index(int(np.argmin(apart**2 + size**2 * crossed)), apart.shape)

    def missed(at: np.ndarray) -> np.ndarray:
        (a, a_way), (b, b_way) = curves[0](at[:1]), curves[1](at[1:])
        return np.concatenate([(a - b)[0], size * np.cross(a_way, b_way)[0]])

    found = least_squares(missed, [s[k], t[m]], xtol=1e-14, ftol=1e-14, gtol=1e-14).x
    (a, _), (b, b_way) = curves[0](found[:1]), curves[1](found[1:])
    return Touching((a[0] + b[0]) / 2, b_way[0], float(np.linalg.norm(a[0] - b[0])), size)


class _Sampled:
    """Points and unit tangents of a curve over x, or over the angle of a closed curve, in ground axes at the start."""

    def __init__(self, curve: LaidCurve) -> None:
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
        flat, ways = (s, value), (np.ones_like(s), slope)
        if self._curve.closed:
            c, d = np.cos(s), np.sin(s)
            flat, ways = (value * c, value * d), (slope * c - value * d, slope * d + value * c)
        axes = self._curve.initial.axes[:, :2]
        along = np.column_stack(ways) @ axes.T
        point = self._curve.initial.point + np.column_stack(flat) @ axes.T
        return point, along / np.linalg.norm(along, axis=1)[:, None]
