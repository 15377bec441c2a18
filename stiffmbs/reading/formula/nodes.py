"""Nodes of a formula's tree: reading order, measures and reactions."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import lru_cache

from ..marker import GROUND, MarkerReference
from .names import MEASURES, REACTIONS
from .size import FormulaError, children

TIME = "t"
TAKERS = (*MEASURES, *REACTIONS)
"""Functions whose arguments are names of markers or joints."""


def reading_order(tree: ast.expr) -> Iterator[ast.expr]:
    """Yield all nodes in reading order, except functions' names, coordinates' owners, and markers and joints."""
    ahead = [tree]
    while ahead:
        node = ahead.pop()
        yield node
        ahead.extend(reversed(parts_of(node)))


def parts_of(node: ast.expr) -> list[ast.expr]:
    """Return the child nodes that `reading_order` visits."""
    return [] if is_named(node) else children(node)


def is_measure(node: ast.AST) -> bool:
    """Return True for a measure between markers, such as ``dm(bar.end, ground)``."""
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in MEASURES


def is_reaction(node: ast.AST) -> bool:
    """Return True for a component of a joint's reaction, such as ``fy(guide)``."""
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in REACTIONS


def is_named(node: ast.AST) -> bool:
    """Return True for a measure or a reaction, whose arguments are names."""
    return is_measure(node) or is_reaction(node)


def joint_of(node: ast.AST) -> str:
    """Return the full name of the joint of a reaction."""
    assert isinstance(node, ast.Call)
    match node.args:
        case [ast.Name(joint)]:
            return joint
        case [ast.Attribute(ast.Name(owner), name)]:
            return f"{owner}.{name}"
    raise FormulaError(f"found '{ast.unparse(node)}', expected the name of one joint")


def measured_markers(node: ast.AST) -> tuple[MarkerReference, ...]:
    """Return the markers of a measure: i, j (ground by default), and optionally the marker of the axes."""
    assert isinstance(node, ast.Call)
    markers = []
    for argument in node.args:
        match argument:
            case ast.Name(body):
                markers.append(_reference(body))
            case ast.Attribute(ast.Name(body), marker):
                markers.append(_reference(body, marker))
            case _:
                raise FormulaError(f"found '{ast.unparse(argument)}' in a measure, expected a body or body.marker")
    if len(markers) not in (1, 2, 3):
        raise FormulaError(f"found {len(markers)} markers in '{ast.unparse(node)}', expected one to three")
    return tuple(markers) if len(markers) > 1 else (markers[0], _reference(GROUND))


@lru_cache(10_000)
def _reference(body: str, marker: str | None = None) -> MarkerReference:
    """Return a marker by name, cached because long formulas repeat names."""
    return MarkerReference.model_construct(body=body, marker=marker)
