"""Arguments of functions that are numbers of statements."""

from __future__ import annotations

import ast
from collections.abc import Sequence

from ...describe.files.quoted import quoted
from .expression import OMITTED
from .function import Function


def identifier(arguments: Sequence[ast.expr], at: int, function: Function) -> int:
    """An argument that is the number of a statement."""
    match arguments[at] if at < len(arguments) else None:
        case ast.Constant(int() as value):
            return value
        case ast.Name(name) if name == OMITTED:
            return 0
        case None:
            raise function.fault(
                f"found {len(arguments)} numbers of statements in '{quoted(function.text)}', expected more"
            )
        case node:
            raise function.fault(
                f"found '{ast.unparse(node)}' in '{quoted(function.text)}', expected the number of a statement"
            )
