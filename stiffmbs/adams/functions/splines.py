"""Spline functions as tables of a scene: AKISPL and CUBSPL(x, z, id, order), INTERP(x, z, method, id, order)."""

from __future__ import annotations

import ast
from collections.abc import Callable
from typing import Any

from ...elements.spatial.number_format import plain
from ...reading.files.quoted import quoted
from ..scene.mechanism import Mechanism
from .function import Function

CURVES: dict[str, dict[str, Any]] = {
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
    """Return the value of a spline and add its table to the mechanism.

    Raises DatasetFault if the spline does not exist, or a derivative is requested.
    """
    x, _, *rest = [*arguments, *[ast.Constant(0)] * 5][: max(4, len(arguments))]
    if name == "INTERP":
        name = {1: "LINE", 3: "CUBSPL"}.get(function.identifier(rest, 0), "")
        rest = rest[1:]
    ident, order = function.identifier(rest, 0), function.identifier(rest, 1) if len(rest) > 1 else 0
    spline = mechanism.dataset.splines.get(ident)
    if spline is None:
        raise function.fault(f"found the spline {ident} in '{quoted(function.text)}', expected the number of a SPLINE")
    if order or not name:
        raise function.fault(f"found '{quoted(function.text)}', expected a spline's value, cubic or by straight lines")
    table = f"{name}_{ident}"
    points = [[plain(a), plain(b)] for a, b in zip(spline.x, spline.y, strict=True)]
    mechanism.tables[table] = {"table": points, **CURVES[name]}
    return ast.Call(ast.Name(table), [translate(x)], [])
