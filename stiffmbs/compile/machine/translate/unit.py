"""LLVM module of functions with all functions they call."""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from ....errors import InputError
from .arithmetic import sum_of_products
from .code import Code, tags
from .derivatives import PARTIAL_DERIVATIVES
from .expressions import Expressions
from .statements import Statements, parameters
from .values import LLVM_TYPES, Dual, Operand, Passed, Record, Untranslatable, Value, Wider, dual, slope_of, undirected

KINDS = {
    "int64": "int",
    "int32": "int32",
    "float64": "float",
    "int64*": "ints",
    "float64*": "floats",
    "int32*": "indices",
}
"""Kinds of the C argument types."""


@dataclass(frozen=True)
class Entry:
    """Function callable from outside.

    - `function`: written in the language (`stiffmbs.compile.machine.translate`).
    - `symbol`: name of the C function.
    - `arguments`: C types of its arguments, of `KINDS`.
    - `result`: C type of its result, or ``void``.
    """

    function: Callable[..., Any]
    symbol: str
    arguments: Sequence[str]
    result: str


def assembly(entries: Sequence[Entry], text: str = "", inlined: int = 0) -> str:
    """Translate functions and those they call into a module of LLVM assembly.

    `text`: source of the functions; the files of their code by default. `inlined`: number of instructions up to which
    called functions are marked for LLVM's pass ``always-inline``. Raises Untranslatable if a construct is not in the
    language; names function and line.
    """
    unit = Unit(inlined, text)
    for entry in entries:
        tree = unit.tree(entry.function)
        values = [Value(KINDS[kind], "") for kind in entry.arguments]
        wanted = None if entry.result == "void" else KINDS[entry.result]
        unit.write(tree, entry.function.__globals__, entry.symbol, values, wanted)
    return unit.text()


class Unit:
    """Translated functions, one for each combination of argument kinds.

    A function with a dual argument is differentiated in forward mode: each of its numbers that follows from this argument has
    its derivative, and its arrays have dual numbers.
    """

    def __init__(self, inlined: int = 0, text: str = "") -> None:
        self._inlined, self._own = inlined, _parsed(text)
        self._texts: list[str] = []
        self._declared: set[str] = set()
        self._known: dict[tuple[object, ...], tuple[str, str | None]] = {}
        self._begun: set[tuple[object, ...]] = set()

    def text(self) -> str:
        """Return the module."""
        return "\n".join([*sorted(self._declared), *self._texts, *tags()])

    def declare(self, declaration: str) -> None:
        """Declare an external function."""
        self._declared.add(declaration)

    def called(self, code: Code, function: Callable[..., object], values: Sequence[Operand]) -> Value | None:
        """Write the call of a function in the language; translate it if new."""
        key = (function, *map(_kind, values))
        if key not in self._known:
            if key in self._begun:
                raise Untranslatable(f"'{function.__name__}' calls itself")
            self._begun.add(key)
            symbol = f"{function.__name__}.{len(self._begun)}"
            kind = self.write(self.tree(function), function.__globals__, symbol, values, linkage="internal ")
            self._known[key] = symbol, kind
        symbol, kind = self._known[key]
        given = ", ".join(part.typed for value in values for part in _parts(value))
        call = f'call {LLVM_TYPES[kind] if kind else "void"} @"{symbol}"({given})'
        if kind:
            return code.unpacked(code.put_value(kind, call))
        code.put(call)
        return None

    def called_library(self, code: Code, symbol: str, *values: Value) -> Value:
        """Write the call of a floating-point function of LLVM or the C library; with its derivative if an argument is dual."""
        if any(isinstance(value, Dual) for value in values):
            return self._called_dual(code, symbol, values)
        declared = ", ".join(["double"] * len(values))
        self.declare(f'declare double @"{symbol}"({declared}) nounwind willreturn memory(none)')
        given = ", ".join(code.converted(value, "float").typed for value in values)
        return code.put_value("float", f'call double @"{symbol}"({given})')

    def _called_dual(self, code: Code, symbol: str, values: Sequence[Value]) -> Value:
        """Write the call of a function of the library and of its partial derivatives (`derivatives`)."""
        if symbol not in PARTIAL_DERIVATIVES:
            raise InputError(f"found '{symbol}' in an equation, expected a function with known partial derivatives")
        given = [code.converted(undirected(value), "float") for value in values]
        partials = (
            (by, slope)
            for partial, slope in zip(PARTIAL_DERIVATIVES[symbol], map(slope_of, values), strict=True)
            if partial and slope and (by := self.called(code, partial, given))
        )
        return dual(self.called_library(code, symbol, *given), sum_of_products(code, partials))

    def tree(self, function: Callable[..., object]) -> ast.FunctionDef:
        """Return the syntax tree of a function, from this unit's text or from the file of its code."""
        if function.__name__ in self._own and function.__code__.co_filename.startswith("<"):
            return self._own[function.__name__]
        return _functions(Path(function.__code__.co_filename).read_text(encoding="utf-8"))[function.__name__]

    def write(
        self, tree: ast.FunctionDef, outside: Mapping[str, object], symbol: str, values: Sequence[Operand],
        wanted: str | None = None, linkage: str = "",
    ) -> str | None:  # fmt: skip
        """Translate one function for the kinds of `values`; return the kind of its result."""
        wider: dict[str, str] = {}
        given_once = _given_once(tree)
        while True:
            code = Code(self, forward=any(isinstance(value, Dual) for value in values))
            expressions = Expressions(code, outside, wider, given_once)
            statements = Statements(code, expressions)
            try:
                declared = parameters([argument.arg for argument in tree.args.args], values, expressions)
                statements.write(tree.body)
                kind = statements.finish(wanted)
                break
            except Wider as found:
                wider[found.name] = found.kind
            except Untranslatable as error:
                raise Untranslatable(f"{tree.name}: {error}") from None
        lines = list(code.lines())
        inline = " alwaysinline" if linkage and len(lines) <= self._inlined else ""
        head = f'define {linkage}{LLVM_TYPES[kind] if kind else "void"} @"{symbol}"({", ".join(declared)})'
        self._texts.append("\n".join([f"{head} nounwind{inline} {{", *lines, "}"]))
        return kind


def _kind(value: Operand) -> object:
    match value:
        case Value():
            return value.kind
        case Record():
            return value.name
        case Passed():
            return value.function
    raise Untranslatable(f"found {value} as an argument, expected a value, a view or a function")


def _parts(value: Operand) -> Sequence[Value]:
    if isinstance(value, Record):
        return list(value.fields.values())
    return [value] if isinstance(value, Value) else []


def _given_once(tree: ast.FunctionDef) -> set[str]:
    """Return the parameters never assigned, and the names assigned by one statement, which need no memory."""
    counts = Counter([*(argument.arg for argument in tree.args.args), *_stored(tree.body)])
    return {name for name, count in counts.items() if count == 1}


def _stored(body: Sequence[ast.stmt]) -> Iterator[str]:
    """Yield the names that statements assign; their expressions assign none."""
    for statement in body:
        for target in getattr(statement, "targets", None) or filter(None, [getattr(statement, "target", None)]):
            yield from (node.id for node in ast.walk(target) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store))  # fmt: skip
        for part in ("body", "orelse"):
            yield from _stored(getattr(statement, part, ()))


def _parsed(text: str) -> dict[str, ast.FunctionDef]:
    return {node.name: node for node in ast.parse(text).body if isinstance(node, ast.FunctionDef)}


_functions = cache(_parsed)
"""Functions of modules, which many units call; a generated text belongs to one unit and is not kept."""
