"""Expressions of a kernel's source with the operators of Python; zeros are dropped."""

from __future__ import annotations

import ast
from dataclasses import dataclass


@dataclass(frozen=True)
class Part:
    """Part of an expression; without a node it is zero, and false."""

    node: ast.expr | None = None

    def __bool__(self) -> bool:
        return self.node is not None

    def __neg__(self) -> Part:
        return Part(ast.UnaryOp(ast.USub(), self.node)) if self.node else self

    def __add__(self, other: Part) -> Part:
        return self._joined(ast.Add(), other) if self and other else self or other

    def __sub__(self, other: Part) -> Part:
        return self._joined(ast.Sub(), other) if self and other else self or -other

    def __mul__(self, other: Part) -> Part:
        return self._joined(ast.Mult(), other) if self and other else Part()

    def __truediv__(self, other: Part) -> Part:
        return self._joined(ast.Div(), other) if self else self

    def __pow__(self, other: Part) -> Part:
        return self._joined(ast.Pow(), other)

    def _joined(self, operator: ast.operator, other: Part) -> Part:
        return Part(ast.BinOp(self.whole, operator, other.whole))

    @property
    def whole(self) -> ast.expr:
        """Expression, or a literal zero."""
        return self.node or ast.Constant(0.0)

    @property
    def literal(self) -> int:
        """Value of an integer literal with or without a sign; `ValueError` for others."""
        return int(ast.literal_eval(self.whole))


ZERO = Part()


def number(value: float) -> Part:
    """Return a literal."""
    return Part(ast.Constant(value))


def called(name: str, *arguments: Part) -> Part:
    """Return a function call."""
    return Part(ast.Call(ast.Name(name), [argument.whole for argument in arguments], []))
