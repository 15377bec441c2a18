"""The parts of a formula: which of them are constant, and which say the same."""

from __future__ import annotations

import ast
from dataclasses import dataclass

from ..describe.formula.formula import Formula
from ..describe.formula.nodes import TIME, is_named
from ..describe.formula.text import UNIT


@dataclass(frozen=True)
class Part:
    """A part of a formula.

    Attributes
    ----------
    number : int
        The same for parts that say the same word for word.
    constant : bool
        Whether it holds neither time, coordinates, measures, states nor the field's own variables.
    """

    number: int
    constant: bool


class FormulaParts:
    """What is known of the parts of a formula; each is looked at once.

    Parameters
    ----------
    formula : Formula
    """

    def __init__(self, formula: Formula) -> None:
        self._values = formula.values
        self._varying = {TIME, *formula.variables, *formula.tables, *formula.states}
        self._known: dict[int, Part] = {}
        self._numbers: dict[tuple[object, ...], int] = {}

    def of(self, node: ast.expr) -> Part:
        """A part by its node in the formula's tree."""
        if id(node) not in self._known:
            self._known[id(node)] = self._read(node)
        return self._known[id(node)]

    def _read(self, node: ast.expr) -> Part:
        match node:
            case ast.BinOp(left, operator, right):
                return self._of_parts((type(operator),), left, right)
            case ast.UnaryOp(operator, operand):
                return self._of_parts((type(operator),), operand)
            case ast.Call(ast.Name(name), arguments):
                return self._of_parts((ast.Call, name), *arguments, constant=not is_named(node) and name not in self._varying)  # fmt: skip
            case ast.Attribute(ast.Name(owner), name):
                return self._part((owner, name), f"{UNIT}.{name}" in self._values and owner not in self._varying)
            case ast.Name(name):
                return self._part((name,), name not in self._varying)
        return self._part((ast.dump(node),), isinstance(node, ast.Constant))

    def _of_parts(self, says: tuple[object, ...], *nodes: ast.expr, constant: bool = True) -> Part:
        parts = [self.of(node) for node in nodes]
        return self._part((*says, *(part.number for part in parts)), constant and all(part.constant for part in parts))

    def _part(self, says: tuple[object, ...], constant: bool) -> Part:
        return Part(self._numbers.setdefault(says, len(self._numbers)), constant)
