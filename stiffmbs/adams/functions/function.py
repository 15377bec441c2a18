"""A function expression with the place where it stands."""

from __future__ import annotations

import ast
from dataclasses import dataclass, field

from ..statements.arguments import Arguments
from ..statements.fault import DatasetFault
from .expression import ExpressionError, parse


@dataclass(frozen=True)
class Function:
    """An expression of a statement, in the dataset's own units.

    Attributes
    ----------
    text : str
        As written, on one line.
    tree : ast.expr
        What `expression.parse` makes of it.
    line : int
    label : str
        The statement, such as ``SFORCE/3``.
    """

    text: str
    tree: ast.expr = field(compare=False)
    line: int
    label: str

    def fault(self, reason: str) -> DatasetFault:
        """What to raise where this expression is wrong."""
        return DatasetFault(self.line, self.label, reason)


def read_function(found: Arguments, name: str) -> Function | None:
    """The expression of an argument; None where it is missing.

    Raises
    ------
    DatasetFault
        When it is no expression, or a user's own subroutine.
    """
    if name not in found:
        return None
    text = (found.text(name) or "").strip().strip('"')
    if is_subroutine(found, name):
        raise found.fault(
            f"found {name} = {text}, which is computed by a subroutine of its own, expected an expression",
            found.line(name),
        )
    return read_any_function(found, name)


def read_any_function(found: Arguments, name: str) -> Function:
    """As `read_function`, also of a user's own subroutine, which is a fault only where its value is needed."""
    text = (found.text(name) or "").strip().strip('"')
    try:
        return Function(text, parse(text), found.line(name), found.label)
    except ExpressionError as error:
        raise found.fault(f"{name}: {error}", found.line(name)) from None


def is_subroutine(found: Arguments, name: str) -> bool:
    """Whether an argument is computed by a user's own subroutine."""
    return (found.text(name) or "").upper().replace(" ", "").lstrip('"').startswith("USER(")


def required_function(found: Arguments, name: str) -> Function:
    """As `read_function`, of an argument that must not be missing."""
    function = read_function(found, name)
    if function is None:
        raise found.fault(f"found no {name}, expected {name} = an expression")
    return function
