"""Function expression with its statement and line."""

from __future__ import annotations

import ast
from collections.abc import Sequence
from dataclasses import dataclass, field

from ...reading.files.quoted import quoted
from ..statements.arguments import Arguments
from ..statements.text import DatasetFault
from .expression import OMITTED, ExpressionError, parse


@dataclass(frozen=True)
class Function:
    """Expression of a statement in the dataset's units."""

    text: str  # as written, on one line
    tree: ast.expr = field(compare=False)  # result of `expression.parse`
    line: int
    label: str  # the statement, such as ``SFORCE/3``

    def identifier(self, arguments: Sequence[ast.expr], at: int) -> int:
        """Return an argument of a call that is the identifier of a statement; 0 if it is omitted."""
        match arguments[at] if at < len(arguments) else None:
            case ast.Constant(int() as value):
                return value
            case ast.Name(name) if name == OMITTED:
                return 0
            case None:
                found, expected = f"{len(arguments)} numbers of statements", "more"
            case node:
                found, expected = f"'{ast.unparse(node)}'", "the number of a statement"
        raise self.fault(f"found {found} in '{quoted(self.text)}', expected {expected}")

    def identifiers(self, arguments: Sequence[ast.expr], count: int | None = None) -> list[int]:
        """Return some or all arguments of a call as identifiers of statements."""
        return [self.identifier(arguments, k) for k in range(len(arguments) if count is None else count)]

    def fault(self, reason: str) -> DatasetFault:
        """Return the error for a fault in this expression."""
        return DatasetFault(self.line, self.label, reason)


def read_function(found: Arguments, name: str) -> Function | None:
    """Return the expression of an argument; None if it is missing.

    Raises DatasetFault if it is not an expression, or is a user subroutine.
    """
    if name not in found:
        return None
    text = (found.text(name) or "").strip().strip('"')
    if is_subroutine(found, name):
        raise found.fault(f"found {name} = {text}, a user subroutine, expected an expression", name)
    return read_any_function(found, name)


def read_any_function(found: Arguments, name: str) -> Function:
    """Return the expression of an argument; a user subroutine is an error only where it is evaluated."""
    text = (found.text(name) or "").strip().strip('"')
    try:
        return Function(text, parse(text), found.line(name), found.label)
    except ExpressionError as error:
        raise found.fault(f"{name}: {error}", name) from None


def is_subroutine(found: Arguments, name: str) -> bool:
    """Return True if an argument is computed by a user subroutine."""
    return (found.text(name) or "").upper().replace(" ", "").lstrip('"').startswith("USER(")


def required_function(found: Arguments, name: str) -> Function:
    """Return the expression of a required argument, as `read_function`."""
    function = read_function(found, name)
    if function is None:
        raise found.fault(f"found no {name}, expected {name} = an expression")
    return function
