"""Elements in force functions and between two markers, and the markers of general constraints (GCON)."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import Any

from ..scene.mechanism import Mechanism
from ..statements.constraints import GeneralConstraint, Motion
from ..statements.curves import CurveOnCurve, PointOnCurve
from ..statements.declared import Numbered
from ..statements.forces import SingleForce, VectorForce
from .function import Function


def element_of(name: str, keyword: str, ident: int, function: Function, mechanism: Mechanism) -> Any:
    """Return the statement of JOINT(id, ...) or a similar function; None if it is inactive.

    Raises DatasetFault if there is no such statement.
    """
    if (keyword, ident) in mechanism.dataset.inactive:
        return None
    found = mechanism.dataset.statements.get(keyword, {}).get(ident)
    if found is None:
        raise function.fault(f"found {name}({ident}, ...), expected the number of a {keyword}")
    return found


def acting_between(i: int, j: int, function: Function, mechanism: Mechanism) -> list[tuple[Numbered, bool]]:
    """Return the elements between two markers, and whether the first marker is the element's marker j.

    Raises DatasetFault if nothing acts there, unless an element is inactive or acts on the other marker only.
    """
    acting = list(_acting(i, j, mechanism))
    if not (acting or mechanism.dataset.inactive or _has_action_only(i, j, mechanism)):
        raise function.fault(f"found no joint and no force between the markers {i} and {j}, expected one at least")
    return acting


def _acting(i: int, j: int, mechanism: Mechanism) -> Iterator[tuple[Numbered, bool]]:
    for statements in mechanism.dataset.statements.values():
        for found in statements.values():
            first, others = _ends(found, mechanism)
            if first == i and (not j or j in others):
                yield found, False
            elif i in others and j in (0, first) and not (isinstance(found, SingleForce) and found.action_only):
                yield found, True


def _has_action_only(i: int, j: int, mechanism: Mechanism) -> bool:
    """Return True if an action-only force acts on the second of two markers, and nothing on the first."""
    forces = mechanism.dataset.statements.get("SFORCE", {}).values()
    return any(found.action_only and found.j == i and j in (0, found.i) for found in forces)


def _ends(found: object, mechanism: Mechanism) -> tuple[int | None, tuple[int | None, ...]]:
    if isinstance(found, GeneralConstraint):
        first, *others = (*markers_of(found, mechanism), None)
        return first, tuple(others)
    if isinstance(found, VectorForce | PointOnCurve | CurveOnCurve):
        return found.i, (found.floating,)
    if isinstance(found, Motion) and found.joint is not None:  # acts between the markers of its joint
        return _ends(mechanism.dataset.joints.get(found.joint), mechanism)
    if isinstance(found, Numbered) and found.keyword != "REQUEST":
        return getattr(found, "i", None), (getattr(found, "j", None),)
    return None, ()


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
