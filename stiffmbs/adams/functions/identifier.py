"""Function arguments that are identifiers of statements."""

from __future__ import annotations

import ast
from collections.abc import Sequence

from ...describe.files.quoted import quoted
from .expression import OMITTED
from .function import Function


def identifier(arguments: Sequence[ast.expr], at: int, function: Function) -> int:
    """Return an argument that is the identifier of a statement; 0 if it is omitted."""
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
