"""Proof that the numbers of a scene are affine functions of one of its parameters."""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterator, Mapping

from ..reading.files.unchanged import names_in
from ..reading.files.yaml_text import Content
from ..reading.formula.nodes import TIME, is_named
from ..reading.formula.text import UNIT, FormulaError, parse

PARAMETERS = "parameters"
AS_THEY_STAND = ("inputs", "forces", "states")
"""Sections whose values by path are numbers of elements."""
ELSEWHERE = ("use", "parts", "path", "stages", "options", "choose")
"""Sections whose formulas are not all in the scene, or that change others."""


def is_affine(content: Content, path: str) -> bool:
    """Return True if the formulas of a scene show that its numbers are affine functions of the value at a path.

    A part of a formula without time, coordinates, states and inputs becomes one number, which a function, a power or a
    division by the parameter makes nonlinear. Values at some points cannot show that: ``max(F, 2000)`` may be constant
    at all of them. All other names count as constants, such as ``pi``, variables, and the own names of a law.
    """
    parameters = content.get(PARAMETERS) or {}
    name = path.removeprefix(f"{PARAMETERS}.")
    if name not in parameters:
        return path.partition(".")[0] in AS_THEY_STAND
    if any(content.get(section) for section in ELSEWHERE):
        return False
    named = {**(content.get("variables") or {}), **parameters}
    followers = {name}
    for _ in named:
        followers |= {key for key, text in named.items() if names_in(text) & followers}
    varying = {TIME, *(content.get("states") or ()), *(content.get("inputs") or ())} - named.keys()
    return all(_is_affine_in(text, followers, varying) for text in _texts(content) if names_in(text) & followers)


def _texts(entry: object) -> Iterator[str]:
    match entry:
        case str():
            yield entry
        case Mapping():
            for part in entry.values():
                yield from _texts(part)
        case list() | tuple():
            for part in entry:
                yield from _texts(part)


def _is_affine_in(text: str, names: Collection[str], varying: Collection[str]) -> bool:
    try:
        tree = parse(text)
    except FormulaError:
        return False
    return all(_degree(number, names) <= 1 for number in _numbers(tree, varying))


def _numbers(node: ast.expr, varying: Collection[str]) -> list[ast.expr]:
    """Return the largest parts of a formula that may be constant during a run."""
    if _may_be_constant(node, varying):
        return [node]
    return [number for child in _operands(node) for number in _numbers(child, varying)]


def _operands(node: ast.expr) -> list[ast.expr]:
    return [child for child in ast.iter_child_nodes(node) if isinstance(child, ast.expr)]


def _may_be_constant(node: ast.expr, varying: Collection[str]) -> bool:
    match node:
        case ast.Name(name):
            return name not in varying
        case ast.Attribute(ast.Name(owner)):
            return owner == UNIT
        case ast.Call(_, arguments):
            return not is_named(node) and all(_may_be_constant(argument, varying) for argument in arguments)
    return all(_may_be_constant(child, varying) for child in _operands(node))


def _degree(node: ast.expr, names: Collection[str]) -> float:
    """Return the degree of a constant part in the names; infinite if it is no polynomial of them."""
    match node:
        case ast.Name(name):
            return 1 if name in names else 0
        case ast.BinOp(left, ast.Add() | ast.Sub(), right):
            return max(_degree(left, names), _degree(right, names))
        case ast.BinOp(left, ast.Mult(), right):
            return _degree(left, names) + _degree(right, names)
        case ast.BinOp(left, ast.Div(), right) if _degree(right, names) == 0:
            return _degree(left, names)
    below = [_degree(child, names) for child in _operands(node)]
    return max(below, default=0) if isinstance(node, ast.UnaryOp) or not any(below) else float("inf")
