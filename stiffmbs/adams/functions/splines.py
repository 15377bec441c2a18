"""Splines of a dataset as tables of the scene: AKISPL and CUBSPL(x, z, id, order), INTERP(x, method, id, order)."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator

import numpy as np

from ...elements.spatial.number_format import plain
from ...reading.files.quoted import quoted
from ...reading.table import Table
from ..scene.mechanism import Mechanism
from ..statements.geometry import ROUNDING
from ..statements.outputs import Spline
from .adams_functions import ZERO
from .expression import constant
from .function import Function
from .trees import call, difference, number, power, product, times, total

CURVES: dict[str, dict[str, object]] = {
    "AKISPL": {"akima": True},
    "CUBSPL": {"ends": "not-a-knot"},
    "LINE": {"lines": True},
}
"""Table options of each spline function."""


def spline_value(
    name: str,
    arguments: list[ast.expr],
    function: Function,
    translate: Callable[[ast.expr], ast.expr],
    mechanism: Mechanism,
) -> ast.expr:
    """Return the value of a spline, of a family linear in z between its curves, and add its tables to the mechanism.

    Raises DatasetFault if the spline does not exist, or a derivative is requested.
    """
    x, second, *rest = [*arguments, *[ast.Constant(0)] * 4][: max(4, len(arguments))]
    if name == "INTERP":
        name = {1: "LINE", 3: "CUBSPL"}.get(function.identifier([second], 0), "")
    ident, order = function.identifiers(rest, 2)
    spline = mechanism.dataset.splines.get(ident)
    if spline is None:
        raise function.fault(f"found the spline {ident} in '{quoted(function.text)}', expected the number of a SPLINE")
    if order or not name:
        raise function.fault(f"found '{quoted(function.text)}', expected the value of a cubic or linear spline")
    if spline.z and name == "LINE":
        raise function.fault(f"found {spline.label} of several curves in INTERP, expected AKISPL or CUBSPL")
    argument, values = translate(x), []
    for k, y in enumerate(spline.curves, start=1):
        table = f"{name}_{ident}" + (f"_{k}" if spline.z else "")
        points = [[plain(a), plain(b)] for a, b in zip(spline.x, y, strict=True)]
        mechanism.tables[table] = {"table": points, **CURVES[name], "beyond": "extend"}
        value = ast.Call(ast.Name(table), [argument], [])
        outside = (
            [] if is_clamped(argument, spline.x[0], spline.x[-1]) else _beyond(spline, y, table, argument, mechanism)
        )
        values.append(total([value, *outside]))
    if not spline.z:
        return values[0]
    weights = (_weight(spline, k, mechanism) for k in range(len(values)))
    return total(
        [product(call(weight, translate(second)), value) for weight, value in zip(weights, values, strict=True)]
    )


def _weight(spline: Spline, k: int, mechanism: Mechanism) -> str:
    """Add the table of a curve's weight in a family, which is linear in z, and return its name."""
    name = f"{spline.name}_weight_{k + 1}"
    points = [[plain(z), int(k == m)] for m, z in enumerate(spline.z)]
    mechanism.tables[name] = {"table": points, "lines": True, "beyond": "extend"}
    return name


def end_slopes(table: Table) -> tuple[float, float]:
    """Return the slopes at the ends of a table of straight lines, Akima's cubics, or a spline with not-a-knot ends."""
    from scipy.interpolate import Akima1DInterpolator, CubicSpline

    x, y = np.array(table.table, dtype=float).T
    if table.lines:
        chords = np.diff(y) / np.diff(x)
        return float(chords[0]), float(chords[-1])
    law = Akima1DInterpolator(x, y) if table.akima else CubicSpline(x, y, bc_type="not-a-knot")
    return float(law(x[0], 1)), float(law(x[-1], 1))


def is_clamped(x: ast.expr, first: float, last: float) -> bool:
    """Return True for ``max(first, min(last, ..))``, as splines are exported."""
    match x:
        case ast.Call(ast.Name("max"), [low, ast.Call(ast.Name("min"), [high, _])]):
            return constant(low) == first and constant(high) == last
    return False


def _beyond(spline: Spline, y: tuple[float, ...], table: str, x: ast.expr, mechanism: Mechanism) -> Iterator[ast.expr]:
    """Yield what Adams' extrapolation of a spline adds to that of a table, which continues with the slope of its end.

    Adams follows the parabola through the three points at the end, with LINEAR_EXTRAPOLATE the line through two.  MSC
    Adams/Solver, SPLINE.  Notes on the table do not state values there, as these are of the sum.
    """
    points = np.array([spline.x, y])
    low, high = end_slopes(Table(**mechanism.tables[table]))
    for side, slope, (u, v) in (("min", low, points[:, :3]), ("max", high, points[:, :-4:-1])):
        if side == "min" and u[0] <= 0 and isinstance(x, ast.Name) and x.id == "t":
            continue  # time is not negative
        first, second = np.diff(v) / np.diff(u)
        bend = 0.0 if spline.lines_outside else (second - first) / (u[2] - u[0])
        corrections = first - bend * (u[1] - u[0]) - slope, bend
        outside = call(side, difference(x, number(u[0])), ZERO)
        for order, factor in enumerate(corrections, start=1):
            if abs(factor) * np.ptp(u) ** order > ROUNDING * np.ptp(points[1]):
                yield times(power(outside, order) if order > 1 else outside, factor)
