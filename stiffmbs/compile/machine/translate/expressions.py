"""Translation of expressions."""

from __future__ import annotations

import ast
import builtins
import math
from collections.abc import Callable, Iterator, Mapping
from collections.abc import Set as AbstractSet
from contextlib import contextmanager
from dataclasses import fields, is_dataclass
from typing import Any

from ....reading.formula.functions import FUNCTIONS as FORMULA_FUNCTIONS
from ....tuning import parameters_of
from .arithmetic import compared, computed, negated, number, selected
from .code import Code, common, constant
from .values import (
    POINTERS_TO,
    Builtin,
    Cell,
    Operand,
    Passed,
    Record,
    Untranslatable,
    Value,
    Wider,
    builtin,
    refuse,
    undirected,
)


class Expressions:
    """Translator of the expressions of one function.

    `code`: receives the instructions. `outside`: names of the function's module. `wider`: kinds of variables that need
    memory: wider than their first value, or read outside its block. `given_once`: names assigned in one place.

    - `variables`: addresses of the function's variables.
    - `values`: values of names without memory, in the assigning block and blocks within it.
    - `left`: such names of ended blocks.
    - `records`: views by their names.
    - `passed`: functions by the names of the parameters that they are given to.
    """

    def __init__(
        self, code: Code, outside: Mapping[str, object], wider: Mapping[str, str], given_once: AbstractSet[str]
    ) -> None:
        self.code = code
        self.variables: dict[str, Value] = {}
        self.values: dict[str, Value] = {}
        self.left: dict[str, Value] = {}
        self.records: dict[str, Record] = {}
        self.passed: dict[str, Callable[..., object]] = {}
        self._outside, self._wider, self._given_once = outside, wider, given_once

    def set(self, name: str, value: Value) -> None:
        """Assign a variable. Its kind is that of the first assignment, widened by later ones."""
        if name in self._given_once and name not in self._wider:
            self.values[name] = self.code.converted(value, "int" if value.kind == "int32" else value.kind)
            return
        variable = self.variables.get(name) or self._declared(name, value.kind)
        kind = common([variable, value])
        if kind != variable.kind:
            raise Wider(name, kind)
        self.code.store(variable, value)

    @contextmanager
    def block(self) -> Iterator[None]:
        """Start a conditional block: values assigned in it are not visible after it."""
        outer, self.values = self.values, dict(self.values)
        yield
        self.left |= {name: value for name, value in self.values.items() if name not in outer}
        self.values = outer

    def _declared(self, name: str, kind: str) -> Value:
        self.variables[name] = self.code.variable(self._wider.get(name, "int" if kind == "int32" else kind))
        return self.variables[name]

    def value(self, node: ast.expr) -> Operand:
        """Write the instructions of an expression; return its value."""
        try:
            return self._value(node)
        except Untranslatable as error:
            raise error if str(error).startswith("line") else refuse(node, str(error)) from None

    def _value(self, node: ast.expr) -> Any:
        code = self.code
        match node:
            case ast.Constant(bool() | int() | float() as literal):
                return constant(literal)
            case ast.Name(name):
                return self._named(name)
            case ast.Attribute(owner, name):
                found = self._field(owner, name)
                return code.load(found) if isinstance(found, Cell) else found
            case ast.Subscript():
                return code.load(self.place(node))
            case ast.BinOp(left, operation, right):
                return computed(code, operation, self.value(left), self.value(right))
            case ast.UnaryOp(ast.USub(), operand):
                return negated(code, self.value(operand))
            case ast.UnaryOp(ast.Not(), operand):
                return code.put_value("bool", f"xor {self.truth(operand).typed}, true")
            case ast.Compare() | ast.BoolOp():
                return self._joined(node)
            case ast.IfExp(test, then, otherwise):
                return self._chosen(test, then, otherwise)
            case ast.Tuple(parts):
                return tuple(self.value(part) for part in parts)
            case ast.Call(ast.Name("float"), [ast.Constant(str() as literal)], []):
                return constant(float(literal))
            case ast.Call(ast.Name("address_of"), [ast.Attribute() as cell], []):
                place = self.place(cell)
                return Value(POINTERS_TO[place.kind], place.text)
            case ast.Call(ast.Name(name), arguments, []):
                return self._called(name, [self.value(argument) for argument in arguments])
        raise Untranslatable("not of the language")

    def place(self, node: ast.Subscript | ast.Attribute) -> Value:
        """Return the address of an array item or a record cell."""
        if isinstance(node, ast.Subscript):
            return self.code.item(self.value(node.value), self.value(node.slice))
        found = self._field(node.value, node.attr)
        if not isinstance(found, Cell):
            raise Untranslatable(f"'{node.attr}' is no cell")
        return found

    def _field(self, owner: ast.expr, name: str) -> Value:
        record = self.value(owner)
        if not isinstance(record, Record) or name not in record.fields:
            raise Untranslatable(f"no record with a field '{name}'")
        return record.fields[name]

    def truth(self, node: ast.expr) -> Value:
        """Return the truth value of an expression."""
        return self.code.truth(self.value(node))

    def _named(self, name: str) -> Operand:
        if name in self.values:
            return self.values[name]
        if name in self.variables:
            return self.code.load(self.variables[name])
        if name in self.left:
            raise Wider(name, self.left[name].kind)
        if name in self.records:
            return self.records[name]
        found = parameters_of(self._outside.get(name))
        if isinstance(found, bool | int | float):
            return constant(found)
        if is_dataclass(found) and not isinstance(found, type):
            return Record(name, {field.name: constant(getattr(found, field.name)) for field in fields(found)})
        if (function := self.passed.get(name, found)) and hasattr(function, "__code__"):
            return Passed(function)
        raise Untranslatable(f"'{name}' is no variable, no number and no function")

    def _joined(self, node: ast.Compare | ast.BoolOp) -> Value:
        """Translate ``a < b < c``, ``a and b``, ``a or b`` with short-circuit evaluation."""
        code = self.code
        steps: list[ast.expr] = node.values if isinstance(node, ast.BoolOp) else node.comparators
        stops_when = isinstance(node, ast.BoolOp) and isinstance(node.op, ast.Or)
        left = None if isinstance(node, ast.BoolOp) else self.value(node.left)
        operations = node.ops if isinstance(node, ast.Compare) else [None] * len(steps)
        if len(steps) == 1 and isinstance(node, ast.Compare):
            return compared(code, node.ops[0], left, self.value(steps[0]))  # type: ignore[arg-type]
        result, end = code.variable("bool"), code.name("joined")
        for operation, step in zip(operations, steps, strict=True):
            right = self.value(step)
            holds = code.truth(right) if operation is None else compared(code, operation, left, right)  # type: ignore[arg-type]
            code.store(result, holds)
            left, following = right, code.name("next")
            code.choose(holds, *((end, following) if stops_when else (following, end)))
            code.label(following)
        code.label(end)
        return code.load(result)

    def _chosen(self, test: ast.expr, then: ast.expr, otherwise: ast.expr) -> Value:
        """Translate ``a if test else b``; only one branch is evaluated."""
        code = self.code
        labels = code.name("then"), code.name("else")
        end = code.name("chosen")
        code.choose(self.truth(test), *labels)
        values, gaps = [], []
        for label, branch in zip(labels, (then, otherwise), strict=True):
            code.label(label)
            value = self.value(branch)
            if not isinstance(value, Value):
                raise Untranslatable("a choice between what are no values")
            values.append(value)
            gaps.append(code.gap())
            code.branch(end)
        code.label(end)
        result = code.variable(common(values))
        for value, gap in zip(values, gaps, strict=True):
            with code.within(gap):
                code.store(result, value)
        return code.load(result)

    def _called(self, name: str, arguments: list[Operand]) -> Any:
        called = self.passed.get(name) or self._outside.get(name, getattr(builtins, name, None))
        called = FUNCTIONS.get(called, called) if callable(called) else called
        if isinstance(called, Builtin):
            return called.lower(self.code, *arguments)
        if not (callable(called) and hasattr(called, "__code__")):
            raise Untranslatable(f"'{name}' cannot be called")
        return self.code.unit.called(self.code, called, arguments)


INTRINSICS = ("sqrt", "sin", "cos", "exp", "log", "copysign", "floor")
"""LLVM intrinsics; other functions are called in the C library of the process."""
OF_THE_LIBRARY = tuple(name for name, function in FORMULA_FUNCTIONS.items() if function.in_c and name not in INTRINSICS)


def _library(symbol: str) -> Builtin:
    def lower(code: Code, *arguments: Operand) -> Value:
        return code.unit.called_library(code, symbol, *map(number, arguments))

    return Builtin(lower)


@builtin
def absolute(code: Code, operand: Operand) -> Value:
    """Translate abs(x)."""
    x = number(operand)
    if x.kind in ("float", "dual"):
        return code.unit.called_library(code, "llvm.fabs.f64", x)
    return selected(code, compared(code, ast.Lt(), x, Value("int", "0")), negated(code, x), code.integer(x))


def _extreme(comparison: ast.cmpop) -> Builtin:
    def lower(code: Code, *operands: Operand) -> Value:
        best = number(operands[0])
        for operand in map(number, operands[1:]):
            best = selected(code, compared(code, comparison, operand, best), operand, best)
        return best

    return Builtin(lower)


@builtin
def to_float(code: Code, operand: Operand) -> Value:
    """Translate float(x)."""
    return code.converted(operand, common([number(operand), constant(0.0)]))


@builtin
def to_int(code: Code, operand: Operand) -> Value:
    """Translate int(x): truncation towards zero."""
    x = undirected(number(operand))
    return code.put_value("int", f"fptosi {x.typed} to i64") if x.kind == "float" else code.integer(x)


@builtin
def is_finite(code: Code, operand: Operand) -> Value:
    """Translate isfinite(x)."""
    size = code.unit.called_library(code, "llvm.fabs.f64", undirected(number(operand)))
    return compared(code, ast.Lt(), size, Value("float", "0x7FF0000000000000"))


FUNCTIONS: dict[Callable[..., object], Builtin] = {
    abs: absolute, max: _extreme(ast.Gt()), min: _extreme(ast.Lt()), float: to_float, int: to_int,
    math.isfinite: is_finite, math.fabs: absolute,
    **{getattr(math, name): _library(f"llvm.{name}.f64") for name in INTRINSICS},
    **{getattr(math, name): _library(name) for name in OF_THE_LIBRARY},
}  # fmt: skip
