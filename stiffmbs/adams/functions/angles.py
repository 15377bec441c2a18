"""Angles between markers as formulas.  MSC Adams/Solver, YAW, PITCH, ROLL, PSI, THETA, PHI, INCANG.

The tip of an axis is a marker 1 m along it. A component of one axis along another is then a distance between markers.
"""

from __future__ import annotations

import ast
from collections.abc import Callable

from ..scene.mechanism import ORIGIN, Mechanism, Place
from .trees import call, measured, number, product, quotient, total

ANGLES_OF_AXES = ("YAW", "PITCH", "ROLL", "PSI", "THETA", "PHI")


def angle(name: str, mechanism: Mechanism, i: Place, j: Place) -> ast.expr:
    """Return an angle of marker i relative to marker j: z-y-x (PITCH with opposite sign) or z-x-z angles."""

    def along(axis_of_i: str, axis_of_j: str) -> ast.expr:
        return measured(f"d{axis_of_j}", mechanism.tip(i, axis_of_i), i.reference, j.reference)

    makers: dict[str, Callable[[], ast.expr]] = {
        "YAW": lambda: call("atan2", along("x", "y"), along("x", "x")),
        "PITCH": lambda: call("asin", bounded(along("x", "z"))),
        "ROLL": lambda: call("atan2", along("y", "z"), along("z", "z")),
        "PSI": lambda: call("atan2", along("z", "x"), ast.UnaryOp(ast.USub(), along("z", "y"))),
        "THETA": lambda: call("acos", bounded(along("z", "z"))),
        "PHI": lambda: call("atan2", along("x", "z"), along("y", "z")),
    }
    return makers[name]()


def included_angle(first: str, vertex: str, second: str) -> ast.expr:
    """Return the angle at a marker between the directions to two others, 0 to pi."""
    ways = [[measured(f"d{axis}", end, vertex, "") for axis in "xyz"] for end in (first, second)]
    lengths = product(measured("dm", first, vertex, ""), measured("dm", second, vertex, ""))
    return call("acos", bounded(quotient(total([product(a, b) for a, b in zip(*ways, strict=True)]), lengths)))


def bounded(cosine: ast.expr) -> ast.expr:
    """Clip a cosine to [-1, 1] against rounding."""
    return call("min", call("max", cosine, number(-1.0)), number(1.0))


def on_ground() -> Place:
    """Return the origin of ground, the default second marker of an angle."""
    return Place("ground", "", ORIGIN, ORIGIN)
