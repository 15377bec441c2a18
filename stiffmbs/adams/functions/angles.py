"""Angles between markers as formulas of where the ends of their axes are.  MSC Adams/Solver, YAW, PITCH, ROLL, PSI, THETA, PHI, INCANG.

The tip of an axis is a marker at its end, 1 m from its own: the component of one axis along another is a distance between them.
"""

from __future__ import annotations

import ast
from collections.abc import Callable

from ..scene.mechanism import ORIGIN, Mechanism, Place
from .trees import call, measured, number, product, quotient, total

ANGLES_OF_AXES = ("YAW", "PITCH", "ROLL", "PSI", "THETA", "PHI")


def angle(name: str, mechanism: Mechanism, i: Place, j: Place) -> ast.expr:
    """An angle of marker i against marker j: of turns about z, y and x (PITCH with the other sign), or z, x and z."""

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
    """The angle at a marker between the ways to two others, 0 to pi."""
    ways = [[measured(f"d{axis}", end, vertex, "") for axis in "xyz"] for end in (first, second)]
    lengths = product(measured("dm", first, vertex, ""), measured("dm", second, vertex, ""))
    return call("acos", bounded(quotient(total([product(a, b) for a, b in zip(*ways, strict=True)]), lengths)))


def bounded(cosine: ast.expr) -> ast.expr:
    """A cosine between -1 and 1, which rounding may leave."""
    return call("min", call("max", cosine, number(-1.0)), number(1.0))


def on_ground() -> Place:
    """Where an angle is measured from that names no second marker."""
    return Place("ground", "", ORIGIN, ORIGIN)
