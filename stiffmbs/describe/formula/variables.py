"""Variables of a scene: formulas by name, which other formulas use (Adams: VARIABLE).

Where a name stands, its formula is put in its place, so that a variable means the same wherever it is used.
"""

from __future__ import annotations

import ast
import copy
from collections.abc import Collection, Mapping

from ..units.units import UNITS, Quantity
from . import measured
from .size import check_size
from .text import UNIT, FormulaError, as_written, parse


def with_variables(tree: ast.expr, variables: Mapping[str, ast.expr], own: Collection[str] = ()) -> ast.expr:
    """A formula with the variables that it names put in their places.

    Parameters
    ----------
    tree : ast.expr
        Is left as it is.
    variables : mapping of str to ast.expr
        From `resolved`.
    own : collection of str
        Names with a meaning of the formula's own, such as s in the law of a spring.

    Raises
    ------
    FormulaError
        When it becomes too large, or a variable uses a parameter that has one of the own names.
    """
    named = [name for name in _names(tree) if name in variables and name not in own] if variables else []
    if not named:
        return tree
    for name in dict.fromkeys(named):
        hidden = [inner for inner in _names(variables[name]) if inner in own]
        if hidden:
            raise FormulaError(
                f"found the variable '{name}', which uses a parameter '{hidden[0]}', expected another name of it, as here "
                f"'{hidden[0]}' is the formula's own: rename the parameter"
            )
    check_size(tree, lambda: ", ".join(dict.fromkeys(named)), [variables[name] for name in named])
    found = _in_place(tree, variables, own)
    check_size(found, lambda: as_written(tree))
    return found


def resolved(formulas: Mapping[str, str | float], known: Collection[str]) -> dict[str, ast.expr]:
    """The trees of variables, each with the others that it uses in it.

    Parameters
    ----------
    formulas : mapping of str to str or float
    known : collection of str
        Parameters, constants and time.

    Raises
    ------
    FormulaError
        When one cannot be read, becomes too large, or depends on itself; begins with its name.
    """
    trees: dict[str, ast.expr] = {}

    def resolve(name: str, within: tuple[str, ...]) -> ast.expr:
        if name in within:
            way = " -> ".join((*within[within.index(name) :], name))
            raise FormulaError(f"{name}: found a variable that depends on itself ({way}), expected one that does not")
        if name not in trees:
            try:
                tree = _UnitsMarked(known, formulas).visit(parse(str(formulas[name])))
                _check_names(tree, formulas, known)
            except FormulaError as error:
                raise FormulaError(f"{name}: {error}") from None
            used = [inner for inner in dict.fromkeys(_names(tree)) if inner in formulas]
            inner = {each: resolve(each, (*within, name)) for each in used}
            try:
                trees[name] = with_variables(tree, inner)
            except FormulaError as error:
                raise FormulaError(f"{name}: {error}") from None
        return trees[name]

    for name in formulas:
        resolve(name, ())
    return trees


def meant_within(
    variables: Mapping[str, ast.expr], inside: Mapping[str, Quantity], outside: Mapping[str, Quantity]
) -> dict[str, ast.expr]:
    """The variables that mean within a part what they mean outside of it.

    A parameter of the part hides a variable of its name, and all variables that use an outer parameter of its name.
    """
    hidden = {name for name, value in inside.items() if outside.get(name) != value}
    return {name: tree for name, tree in variables.items() if name not in inside and hidden.isdisjoint(_names(tree))}


def _check_names(tree: ast.expr, variables: Collection[str], known: Collection[str]) -> None:
    for name in _names(tree):
        if name not in variables and name not in known:
            raise FormulaError(
                f"found the unknown name '{name}', expected t, a body's coordinate such as cart.x, a parameter or a variable"
            )


def _names(node: ast.AST) -> list[str]:
    """The names that stand alone in a formula, as often as they do: neither owners of coordinates nor markers."""
    match node:
        case ast.Name(name):
            return [name]
        case ast.Attribute():
            return []
        case ast.Call(ast.Name(called), arguments):
            children: list[ast.AST] = [] if called in measured.MEASURES else list(arguments)
        case _:
            children = list(ast.iter_child_nodes(node))
    return [name for child in children for name in _names(child)]


def _in_place(node: ast.expr, variables: Mapping[str, ast.expr], own: Collection[str] = ()) -> ast.expr:
    """A copy of a formula with variables in the places of their names; no node stands in two places, as others change them there."""
    match node:
        case ast.Name(name) if name in variables and name not in own:
            return _in_place(variables[name], {})
        case ast.Name(name):
            return ast.Name(name)
        case ast.BinOp(left, op, right):
            return ast.BinOp(_in_place(left, variables, own), op, _in_place(right, variables, own))
        case ast.UnaryOp(op, operand):
            return ast.UnaryOp(op, _in_place(operand, variables, own))
        case ast.Constant(value):
            return ast.Constant(value)
        case ast.Attribute(owner, name):
            return ast.Attribute(_in_place(owner, {}), name)
        case ast.Call(ast.Name(name), arguments):
            meant = {} if name in measured.MEASURES else variables
            return ast.Call(ast.Name(name), [_in_place(argument, meant, own) for argument in arguments], [])
    return copy.deepcopy(node)


class _Alone(ast.NodeTransformer):
    """Visits the names that stand alone."""

    def visit_Attribute(self, node: ast.Attribute) -> ast.expr:
        return node

    def visit_Call(self, node: ast.Call) -> ast.expr:
        if node.func.id in measured.MEASURES:  # type: ignore[attr-defined]
            return node
        return ast.Call(node.func, [self.visit(argument) for argument in node.args], [])


class _UnitsMarked(_Alone):
    """Writes units that stand alone, as m in ``N/m``, as those after a number: in a law of s, s is no second."""

    def __init__(self, known: Collection[str], variables: Collection[str]) -> None:
        self._known = {*known, *variables}

    def visit_Name(self, node: ast.Name) -> ast.expr:
        if node.id in UNITS and node.id not in self._known:
            return ast.Attribute(ast.Name(UNIT, ast.Load()), node.id, ast.Load())
        return node
