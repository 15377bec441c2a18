"""Variables of a scene: named formulas for use in other formulas (Adams: VARIABLE).

A name is replaced by its formula, so a variable has the same meaning wherever it is used.
"""

from __future__ import annotations

import ast
import copy
from collections.abc import Collection, Mapping

from ...errors import prefixed
from ..did_you_mean import did_you_mean
from ..units.units import UNITS, Quantity
from . import measured
from .size import check_size
from .text import UNIT, FormulaError, as_written, parse


def with_variables(tree: ast.expr, variables: Mapping[str, ast.expr], own: Collection[str] = ()) -> ast.expr:
    """Return a formula with its variables substituted, except for the formula's `own` names, such as s in the law of a spring.

    Raises FormulaError if the result is too large, or a variable uses a parameter with one of the own names.
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
    """Return the trees of variables, with the variables in them substituted; parameters, constants and time are `known`.

    Raises FormulaError if one cannot be read, becomes too large, or depends on itself; the message begins with its
    name.
    """
    trees: dict[str, ast.expr] = {}
    # a unit without a number, as m in N/m, is marked as one; otherwise s in a law of s would be ambiguous
    units = {name: ast.Attribute(ast.Name(UNIT), name) for name in UNITS if name not in known and name not in formulas}

    def resolve(name: str, within: tuple[str, ...]) -> ast.expr:
        """Return the tree of a variable; `within`: the variables that lead to it."""
        if name in within:
            loop = " -> ".join((*within[within.index(name) :], name))
            raise FormulaError(f"{name}: found a variable that depends on itself ({loop}), expected one that does not")
        if name not in trees:
            with prefixed(f"{name}: ", FormulaError, FormulaError):
                tree = _in_place(parse(str(formulas[name])), units)
                _check_names(tree, formulas, known)
            used = [inner for inner in dict.fromkeys(_names(tree)) if inner in formulas]
            inner = {each: resolve(each, (*within, name)) for each in used}
            with prefixed(f"{name}: ", FormulaError, FormulaError):
                trees[name] = with_variables(tree, inner)
        return trees[name]

    for name in formulas:
        resolve(name, ())
    return trees


def meant_within(
    variables: Mapping[str, ast.expr], inside: Mapping[str, Quantity], outside: Mapping[str, Quantity]
) -> dict[str, ast.expr]:
    """Return the variables that have the same meaning within a part as outside.

    A parameter of the part hides a variable of the same name, and all variables that use an outer parameter of that
    name with another value.
    """
    hidden = {name for name, value in inside.items() if outside.get(name) != value}
    return {name: tree for name, tree in variables.items() if name not in inside and hidden.isdisjoint(_names(tree))}


def _check_names(tree: ast.expr, variables: Collection[str], known: Collection[str]) -> None:
    for name in _names(tree):
        if name not in variables and name not in known:
            raise FormulaError(
                f"found the unknown name '{name}'{did_you_mean(name, (*variables, *known))}, expected t, a body's coordinate such as cart.x, a parameter or a variable"
            )


def _names(node: ast.AST) -> list[str]:
    """Return all undotted names in a formula, with repetitions, without markers."""
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
    """Return a copy of a formula with variables substituted; every node is new, because trees are modified in place."""
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
