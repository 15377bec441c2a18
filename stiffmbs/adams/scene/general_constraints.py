"""Markers of general constraints (GCON)."""

from __future__ import annotations

import ast

from ..statements.constraints import GeneralConstraint
from .mechanism import Mechanism


def rod(constraint: GeneralConstraint) -> tuple[int, int, float] | None:
    """Return the two markers and the length of a constant-distance constraint; None for other constraints."""
    match constraint.function.tree:
        case ast.BinOp(
            ast.Call(ast.Name("DM"), [ast.Constant(int() as a), ast.Constant(int() as b)]),
            ast.Sub(),
            ast.Constant(int() | float() as length),
        ) if a and b and length:
            return (b, a, length) if constraint.i == b else (a, b, length)
    return None


def markers_of(constraint: GeneralConstraint, mechanism: Mechanism) -> tuple[int, ...]:
    """Return the markers in a general constraint's function; the marker of its reaction comes first."""
    named = [
        argument.value
        for node in ast.walk(constraint.function.tree)
        if isinstance(node, ast.Call)
        for argument in node.args
        if isinstance(argument, ast.Constant)
        and isinstance(argument.value, int)
        and argument.value in mechanism.dataset.markers
    ]
    first = [] if constraint.i is None else [constraint.i]
    return tuple(dict.fromkeys([*first, *named]))
