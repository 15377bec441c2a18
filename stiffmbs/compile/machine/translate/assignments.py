"""Names assigned in one place only, which need no memory."""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Iterator, Sequence


def given_once(tree: ast.FunctionDef) -> set[str]:
    """Return the names assigned by one statement of a function, and parameters that are never assigned."""
    counts = Counter([argument.arg for argument in tree.args.args])
    counts.update(_assigned(tree.body))
    return {name for name, count in counts.items() if count == 1}


def _assigned(body: Sequence[ast.stmt]) -> Iterator[str]:
    """Yield the name of each assignment in statements and nested statements."""
    for statement in body:
        match statement:
            case ast.Assign(targets):
                for target in targets:
                    yield from _names(target)
            case ast.AugAssign(target):
                yield from _names(target)
            case ast.For(target, _, inner):
                yield from _names(target)
                yield from _assigned(inner)
            case ast.While(_, inner):
                yield from _assigned(inner)
            case ast.If(_, then, otherwise):
                yield from _assigned(then)
                yield from _assigned(otherwise)


def _names(target: ast.expr) -> Iterator[str]:
    if isinstance(target, ast.Name):
        yield target.id
    elif isinstance(target, ast.Tuple):
        for part in target.elts:
            yield from _names(part)
