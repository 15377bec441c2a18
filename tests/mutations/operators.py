"""Small semantic changes of Python source: other signs, factors, indices, comparisons and truth values."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass

BINARY = {ast.Add: ("+", "-"), ast.Sub: ("-", "+"), ast.Mult: ("*", "/"), ast.Div: ("/", "*"), ast.Pow: ("**", "*")}
"""Operators of two operands, and their replacements."""
COMPARISONS = {
    ast.Lt: ("<", ">="),
    ast.LtE: ("<=", ">"),
    ast.Gt: (">", "<="),
    ast.GtE: (">=", "<"),
    ast.Eq: ("==", "!="),
    ast.NotEq: ("!=", "=="),
    ast.Is: ("is", "is not"),
    ast.In: ("in", "not in"),
}
FUNCTIONS = {
    "sin": "cos", "cos": "sin", "min": "max", "max": "min", "Min": "Max", "Max": "Min", "minimum": "maximum",
    "maximum": "minimum", "any": "all", "all": "any", "floor": "ceil", "ceil": "floor", "argmin": "argmax", "argmax": "argmin",
}  # fmt: skip
"""Functions that take the same arguments and return other values."""
NOT_EXECUTED = (ast.Raise, ast.Assert, ast.JoinedStr, ast.Import, ast.ImportFrom)
"""Statements and expressions that are left alone: errors, their texts, imports."""
SAMPLES = "forms", "SAMPLE"
"""Names of examples of elements that are compiled ahead."""


@dataclass(frozen=True)
class Mutation:
    """One replacement in one file.

    Attributes
    ----------
    path : str
        The file, relative to the root of the repository.
    line : int
        The line, from 1.
    start, end : int
        Offsets of the replaced bytes.
    new : str
        The text that replaces them.
    kind : str
        'sign', 'operator', 'comparison', 'logic', 'function', 'number' or 'index'.
    """

    path: str
    line: int
    start: int
    end: int
    new: str
    kind: str

    def applied(self, source: bytes) -> bytes:
        """Return the mutated source."""
        return source[: self.start] + self.new.encode() + source[self.end :]


def mutations(path: str, source: bytes) -> list[Mutation]:
    """Return all mutations of one file, in the order of the source.

    Named numbers of the module, error messages and `strict` of `zip`, which is an assertion, are left alone.
    """
    lines = [0]
    for line in source.splitlines(keepends=True):
        lines.append(lines[-1] + len(line))

    def start(node: ast.AST) -> int:
        return lines[node.lineno - 1] + node.col_offset  # type: ignore[attr-defined]

    def end(node: ast.AST) -> int:
        return lines[node.end_lineno - 1] + node.end_col_offset  # type: ignore[attr-defined]

    def between(left: ast.AST, right: ast.AST, old: str, new: str, kind: str) -> Iterator[Mutation]:
        at = source.find(old.encode(), end(left), start(right))
        if at >= 0 and source[end(left) : at].strip(b" )\n") == b"":
            yield Mutation(path, right.lineno, at, at + len(old), new, kind)  # type: ignore[attr-defined]

    def replaced(node: ast.AST, new: str, kind: str) -> Mutation:
        return Mutation(path, node.lineno, start(node), end(node), new, kind)  # type: ignore[attr-defined]

    def of(node: ast.AST) -> Iterator[Mutation]:
        match node:
            case ast.BinOp(left=left, op=op, right=right) if type(op) in BINARY and not _is_text(left, right):
                yield from between(left, right, *BINARY[type(op)], "operator")
            case ast.Compare(left=left, ops=[op], comparators=[right]) if type(op) in COMPARISONS:
                yield from between(left, right, *COMPARISONS[type(op)], "comparison")
            case ast.BoolOp(op=op, values=[left, right]):
                old, new = ("and", "or") if isinstance(op, ast.And) else ("or", "and")
                yield from between(left, right, old, new, "logic")
            case ast.UnaryOp(op=ast.USub(), operand=operand) if not isinstance(operand, ast.Constant):
                yield Mutation(path, node.lineno, start(node), start(operand), "", "sign")
            case ast.UnaryOp(op=ast.Not(), operand=operand):
                yield Mutation(path, node.lineno, start(node), start(operand), "", "logic")
            case ast.Call(func=ast.Name(id=name) as function) if name in FUNCTIONS:
                yield replaced(function, FUNCTIONS[name], "function")
            case ast.Subscript(slice=ast.Constant(value=int(value)) as index) if not isinstance(value, bool):
                yield replaced(index, "1" if value == 0 else "0", "index")
            case ast.Constant(value=bool(value)) if id(node) not in strict:
                yield replaced(node, str(not value), "logic")
            case ast.Constant(value=int(value) | float(value)) if id(node) not in indices:
                yield replaced(node, "1" if value == 0 else f"(2*{value!r})", "number")

    tree = ast.parse(source)
    tree.body = [statement for statement in tree.body if not _is_constant(statement)]
    indices = {id(node.slice) for node in ast.walk(tree) if isinstance(node, ast.Subscript)}
    strict = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.keyword) and node.arg == "strict"}
    found = (mutation for node in _executed(tree) for mutation in of(node))
    return sorted((m for m in found if _parses(m.applied(source))), key=lambda mutation: mutation.start)


def _is_constant(statement: ast.stmt) -> bool:
    """Return True for named numbers of a module: tuning parameters, whose halving and doubling has tests of its own."""
    if not isinstance(statement, ast.Assign | ast.AnnAssign):
        return False
    values = statement.value.elts if isinstance(statement.value, ast.Tuple) else [statement.value]
    return all(isinstance(value, ast.Constant) for value in values)


def _is_sample(statement: ast.AST) -> bool:
    """Return True for examples of elements that are compiled ahead, whose numbers have no meaning."""
    targets = statement.targets if isinstance(statement, ast.Assign) else [getattr(statement, "target", None)]
    return any(isinstance(target, ast.Name) and target.id in SAMPLES for target in targets)


def _parses(source: bytes) -> bool:
    try:
        ast.parse(source)
    except SyntaxError:
        return False
    return True


def _is_text(*nodes: ast.AST) -> bool:
    return any(
        isinstance(node, ast.JoinedStr) or (isinstance(node, ast.Constant) and isinstance(node.value, str))
        for node in nodes
    )


def _executed(node: ast.AST) -> Iterator[ast.AST]:
    """Walk through a tree without annotations, error messages and decorators."""
    yield node
    for name, value in ast.iter_fields(node):
        if name in {"annotation", "returns", "decorator_list", "type_params"}:
            continue
        for child in value if isinstance(value, list) else [value]:
            if isinstance(child, ast.AST) and not isinstance(child, NOT_EXECUTED) and not _is_sample(child):
                yield from _executed(child)
