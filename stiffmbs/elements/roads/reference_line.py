"""Reference line of a curved road as cubic splines, and its nearest point.

The point u of the line R(u) that is nearest to a point P satisfies (P - R).R' = 0. Newton's method solves this, from an
initial guess in a table of u over the position along the line's mean direction. Its convergence on the whole road is
tested before the run.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ...errors import InputError
from ...reading.table import Table
from ..element import Expr, Symbolic, sp
from .rolling_filter import table_of

FROZEN, FOLLOWED = 4, 2
"""Newton iterations without derivatives, and further iterations, which make derivatives exact up to the third order."""
CLOSE = 1e-6
"""Largest distance of the line's points from the spline through some of them, m."""
CONVERGED = 1e-9
"""Largest error along the line before the last Newton iteration, m."""
WIDEST = 1.4
"""Largest angle between the line and its mean direction, rad, so that u is a function of the position along it."""
SAMPLES_ACROSS = 11
"""Number of positions across the road at which convergence is tested."""


@dataclass(frozen=True, eq=False)
class ReferenceLine:
    """Curved reference line.

    `x`, `y`: over u, m. `direction`: unit vector of the mean direction. `guess`: u over the position along the mean
    direction.
    """

    x: Table
    y: Table
    direction: tuple[float, float]
    guess: Table

    def in_equations(self) -> dict[str, object]:
        """Return the line as fields of a road."""
        return {"line_x": self.x, "line_y": self.y, "direction": self.direction, "guess": self.guess}


def reference_line(u: np.ndarray, x: np.ndarray, y: np.ndarray, v: np.ndarray, source: str) -> ReferenceLine:
    """Return the line through points.

    `u`, `x`, `y`: m. `v`: positions across the road, m, at which the nearest point must be found. `source`: for
    messages. Raises InputError if the line turns too far from its mean direction, or the road is wider than a radius of
    curvature.
    """
    along = np.array([x[-1] - x[0], y[-1] - y[0]])
    direction = along / max(float(np.hypot(*along)), 1e-300)
    turned = np.abs(np.arctan2(
        direction[0] * np.diff(y) - direction[1] * np.diff(x), direction[0] * np.diff(x) + direction[1] * np.diff(y)
    ))  # fmt: skip
    if turned.max() > WIDEST:
        k = int(turned.argmax())
        raise InputError(
            f"{source}: found a reference line that is {np.degrees(turned[k]):.0f} deg off its mean direction at u = {u[k]:g} m, "
            f"expected at most {np.degrees(WIDEST):.0f} deg: cut the road into files"
        )
    chosen = _chosen(u, x, y)
    position = direction[0] * x[chosen] + direction[1] * y[chosen]
    found = ReferenceLine(
        table_of(u[chosen], x[chosen], "natural"), table_of(u[chosen], y[chosen], "natural"),
        (float(direction[0]), float(direction[1])), table_of(position, u[chosen], "natural"),
    )  # fmt: skip
    _try_it(found, u, v, source)
    return found


def _chosen(u: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return the fewest equidistant points whose spline is close to all points."""
    stride = 2 ** int(np.log2(max(len(u) // 4, 1)))
    while stride > 1:
        chosen = np.unique(np.append(np.arange(0, len(u) - stride // 2, stride), len(u) - 1))
        away = [np.abs(_spline(u[chosen], each[chosen])(u) - each).max() for each in (x, y)]
        if max(away) <= CLOSE:
            return chosen
        stride //= 2
    return np.arange(len(u))


def _spline(arguments: np.ndarray, values: np.ndarray) -> Any:
    from scipy.interpolate import CubicSpline

    return CubicSpline(arguments, values, bc_type="natural")


def _try_it(line: ReferenceLine, u: np.ndarray, v: np.ndarray, source: str) -> None:
    """Refuse a road on which Newton's method does not converge everywhere."""
    x, y = (_spline(*np.array(table.table).T) for table in (line.x, line.y))
    dx, dy, ddx, ddy = x.derivative(), y.derivative(), x.derivative(2), y.derivative(2)
    across = np.linspace(v[0], v[-1], SAMPLES_ACROSS)
    scale = np.hypot(dx(u), dy(u))
    px, py = x(u)[:, None] - across * (dy(u) / scale)[:, None], y(u)[:, None] + across * (dx(u) / scale)[:, None]
    at = np.array(line.guess.table).T
    inside = np.clip(line.direction[0] * px + line.direction[1] * py, at[0, 0], at[0, -1])
    guess = _spline(*at)
    found = guess(inside) + guess(inside, 1) * (line.direction[0] * px + line.direction[1] * py - inside)
    for _ in range(FROZEN + FOLLOWED - 1):
        found = np.clip(found, u[0] - v[-1] + v[0], u[-1] + v[-1] - v[0])
        inside = np.clip(found, u[0], u[-1])
        rx, ry = (f(inside) + g(inside) * (found - inside) for f, g in ((x, dx), (y, dy)))
        cx, cy = (np.where(found == inside, g(inside), 0.0) for g in (ddx, ddy))
        slope = dx(inside) ** 2 + dy(inside) ** 2 - (px - rx) * cx - (py - ry) * cy
        found = found + ((px - rx) * dx(inside) + (py - ry) * dy(inside)) / slope
    away = np.abs(found - u[:, None])
    if not np.all(away <= CONVERGED):
        k, side = np.unravel_index(int(np.argmax(np.where(np.isfinite(away), away, np.inf))), away.shape)
        raise InputError(
            f"{source}: found no single nearest point of the reference line at u = {u[k]:g} m, v = {across[side]:g} m: "
            "expected a road that is narrower than its bends"
        )


def nearest(r: Symbolic, e: Symbolic, x: Expr, y: Expr) -> tuple[Expr, Expr]:
    """Return u and v of a point, m; r has the fields of `ReferenceLine.in_equations`."""
    u = e.named(r.guess(x * r.direction[0] + y * r.direction[1]))
    for _ in range(FROZEN):
        u = e.named(_newton(r, e, u, x, y))
    held = sp.Symbol(f"held{len(e.meanings)}", real=True)
    e.derivatives.define(held, {}, u)
    u = held
    for _ in range(FOLLOWED):
        u = e.named(_newton(r, e, u, x, y))
    (at_x, at_y), (dx, dy), _ = _at(r, e, u)
    return u, e.named(((y - at_y) * dx - (x - at_x) * dy) / sp.sqrt(dx**2 + dy**2))


def _at(r: Symbolic, e: Symbolic, u: Expr) -> list[tuple[Expr, Expr]]:
    s = sp.Dummy("s", real=True)
    x, y = r.line_x(s), r.line_y(s)
    return [tuple(e.named(each.diff(s, k).subs(s, u)) for each in (x, y)) for k in range(3)]  # type: ignore[misc]


def _newton(r: Symbolic, e: Symbolic, u: Expr, x: Expr, y: Expr) -> Expr:
    (at_x, at_y), (dx, dy), (ddx, ddy) = _at(r, e, u)
    slope = dx**2 + dy**2 - (x - at_x) * ddx - (y - at_y) * ddy
    return u + ((x - at_x) * dx + (y - at_y) * dy) / slope
