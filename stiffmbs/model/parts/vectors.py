"""Vector parameters of a part, such as hard points: ``lower_ball: [0.1 m, 0.7 m, -0.1 m]``.

A vector defines its components, the parameters ``lower_ball_x``, ``lower_ball_y`` and ``lower_ball_z``. A formula of
vectors, ``(lower_front + lower_rear)/2``, is replaced by the list of its components.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Mapping
from typing import Any

from ...errors import InputError
from ...reading.fields import located
from ...reading.files.quoted import quoted, written
from ...reading.formula.text import FormulaError, parse

COMPONENTS = "xyz"
Vectors = Mapping[str, int]
"""Number of components of vectors by name."""


def vectors_of(parameters: object, where: str) -> dict[str, int]:
    """Return the vectors among parameters: lists of two or three numbers, and formulas of preceding vectors.

    Raises InputError if a formula multiplies vectors, or adds a number to one.
    """
    vectors: dict[str, int] = {}
    for name, value in parameters.items() if isinstance(parameters, dict) else ():
        with located(f"{where}.{name}"):
            found = in_components(value, vectors) if isinstance(value, str) else value
        if isinstance(name, str) and isinstance(found, list) and len(found) in (2, 3):
            vectors[name] = len(found)
    return vectors


def parameters_in_components(parameters: object, vectors: Vectors, where: str) -> Any:
    """Return parameters with vectors replaced by their components.

    Raises InputError if a vector has another value, or a component is also defined directly.
    """
    if not isinstance(parameters, dict):
        return parameters
    found: dict[object, object] = {}
    for name, value in parameters.items():
        if name not in vectors:
            entries = {name: value}
        else:
            parts = in_components(value, vectors) if isinstance(value, str) else value
            if not isinstance(parts, list) or len(parts) != vectors[name]:
                raise InputError(f"{where}.{name}: found {written(value)}, expected a list of {vectors[name]} numbers")
            entries = {f"{name}_{axis}": part for axis, part in zip(COMPONENTS, parts, strict=False)}
        for key in entries:
            if key in found:
                raise InputError(f"{where}.{key}: found a component of a vector a second time, expected it once")
        found |= entries
    return found


def in_components(found: object, vectors: Vectors) -> Any:
    """Return content of a part with each formula of vectors replaced by the list of its components.

    Raises FormulaError if a formula multiplies vectors, or adds a number to one.
    """
    if not vectors:
        return found
    match found:
        case dict():
            return {key: in_components(value, vectors) for key, value in found.items()}
        case list():
            return [in_components(value, vectors) for value in found]
        case str():
            return _components(found, vectors)
    return found


def _components(text: str, vectors: Vectors) -> Any:
    name = _any_of(vectors)
    used = {match.group() for match in name.finditer(text)}
    if not used:
        return text
    counts = {vectors[each] for each in used}
    if not _is_vector(parse(text), used) or len(counts) > 1:
        raise FormulaError(f"found '{quoted(text)}', expected a formula whose value is a vector")
    return [name.sub(rf"\g<0>_{axis}", text) for axis in COMPONENTS[: counts.pop()]]


def _any_of(names: Vectors) -> re.Pattern[str]:
    """Return a pattern of the names as whole words that are not functions."""
    return re.compile(rf"(?<![\w.])(?:{'|'.join(map(re.escape, names))})(?![\w.]|\s*\()")


def _is_vector(node: ast.expr, vectors: set[str]) -> bool:
    """Return True for a formula of vectors whose value is a vector, False for one whose value is a number."""

    def of(part: ast.expr) -> bool:
        return _is_vector(part, vectors)

    match node:
        case ast.Name(id=name):
            return name in vectors
        case ast.UnaryOp(operand=operand):
            return of(operand)
        case ast.BinOp(left=left, op=ast.Add() | ast.Sub(), right=right):
            if of(left) != of(right):
                raise FormulaError(f"found '{ast.unparse(node)}', expected both to be vectors or numbers")
            return of(left)
        case ast.BinOp(left=left, op=ast.Mult(), right=right):
            if of(left) and of(right):
                raise FormulaError(f"found '{ast.unparse(node)}', expected at most one vector in a product")
            return of(left) or of(right)
        case ast.BinOp(left=left, op=ast.Div(), right=right) if not of(right):
            return of(left)
    if any(isinstance(part, ast.Name) and part.id in vectors for part in ast.walk(node)):
        raise FormulaError(f"found '{ast.unparse(node)}', expected sums of vectors and their multiples")
    return False
