"""Arithmetic operators."""

from __future__ import annotations

import ast
from collections.abc import Iterable

from .code import Code, common, constant
from .values import LLVM_TYPES, Dual, Operand, Untranslatable, Value, dual, slope_of, undirected

FLOAT_OPERATIONS = {ast.Add: "fadd", ast.Sub: "fsub", ast.Mult: "fmul"}
INT_OPERATIONS = {ast.Add: "add nsw", ast.Sub: "sub nsw", ast.Mult: "mul nsw"}
COMPARISONS = {
    ast.Eq: ("oeq", "eq"), ast.NotEq: ("une", "ne"), ast.Lt: ("olt", "slt"),
    ast.LtE: ("ole", "sle"), ast.Gt: ("ogt", "sgt"), ast.GtE: ("oge", "sge"),
}  # fmt: skip
"""LLVM predicates for floats and integers; a comparison with NaN is false, except !=."""


def computed(code: Code, operation: ast.operator, left: Operand, right: Operand) -> Value:
    """Return the value of a binary operation; powers and remainders as Python defines them."""
    a, b = number(left), number(right)
    match operation:
        case ast.Add() | ast.Sub() | ast.Mult():
            return plain(code, type(operation), a, b)
        case ast.Div():
            return float_operation(code, "fdiv", a, b)
        case ast.FloorDiv() if common([a, b]) != "float":
            quotient, _, correction = _divided(code, a, b)
            return code.put_value("int", f"sub {quotient.typed}, {correction.text}")
        case ast.Mod() if common([a, b]) != "float":
            _, rest, correction = _divided(code, a, b)
            added = code.put_value("int", f"mul {correction.typed}, {code.integer(b).text}")
            return code.put_value("int", f"add {rest.typed}, {added.text}")
        case ast.Pow():
            return power(code, a, b)
    raise Untranslatable(f"the operation {type(operation).__name__} between {a.kind} and {b.kind}")


def plain(code: Code, operation: type[ast.operator], a: Value, b: Value) -> Value:
    """Return a sum, difference or product."""
    if common([a, b]) in ("float", "dual"):
        return float_operation(code, FLOAT_OPERATIONS[operation], a, b)
    return code.put_value("int", f"{INT_OPERATIONS[operation]} {code.integer(a).typed}, {code.integer(b).text}")


def float_operation(code: Code, instruction: str, a: Value, b: Value) -> Value:
    """Return an operation on two floats; on dual numbers if one is."""
    if isinstance(a, Dual) or isinstance(b, Dual):
        return dual_operation(code, instruction, a, b)
    return code.put_value(
        "float", f"{instruction} {code.converted(a, 'float').typed}, {code.converted(b, 'float').text}"
    )


def dual_operation(code: Code, instruction: str, a: Value, b: Value) -> Value:
    """Return an operation on dual numbers: (a, a') + (b, b') = (a + b, a' + b'), and likewise for the others."""
    x, y = (code.converted(undirected(part), "float") for part in (a, b))
    x_d, y_d = slope_of(a), slope_of(b)
    value = float_operation(code, instruction, x, y)
    if instruction == "fmul":
        first, second = (
            factor and float_operation(code, "fmul", factor, other) for factor, other in ((x_d, y), (y_d, x))
        )
        return dual(value, _sum(code, first, second))
    if instruction == "fdiv":
        change = y_d and negated(code, float_operation(code, "fmul", value, y_d))
        return dual(value, float_operation(code, "fdiv", _sum(code, x_d, change), y))
    if instruction == "fsub" and x_d and y_d:
        return dual(value, float_operation(code, "fsub", x_d, y_d))
    return dual(value, _sum(code, x_d, y_d and negated(code, y_d) if instruction == "fsub" else y_d))


def _sum(code: Code, a: Value | None, b: Value | None) -> Value:
    """Return the sum of parts, of which one may be zero."""
    found = float_operation(code, "fadd", a, b) if a and b else a or b
    assert found is not None
    return found


def sum_of_products(code: Code, pairs: Iterable[tuple[Value, Value]]) -> Value:
    """Return the sum of products of floats, such as partial derivatives and changes of arguments."""
    total: Value | None = None
    for a, b in pairs:
        total = _sum(code, total, float_operation(code, "fmul", a, b))
    return total or constant(0.0)


def _divided(code: Code, a: Value, b: Value) -> tuple[Value, Value, Value]:
    """Return truncated quotient and remainder, and 1 where Python's floored quotient is one less."""
    top, bottom = code.integer(a), code.integer(b)
    quotient = code.put_value("int", f"sdiv {top.typed}, {bottom.text}")
    rest = code.put_value("int", f"srem {top.typed}, {bottom.text}")
    exact = code.put_value("bool", f"icmp eq {rest.typed}, 0")
    signs = code.put_value("int", f"xor {rest.typed}, {bottom.text}")
    opposed = code.put_value("bool", f"icmp slt {signs.typed}, 0")
    lower = code.put_value("bool", f"select {exact.typed}, i1 false, {opposed.typed}")
    return quotient, rest, code.converted(lower, "int")


def power(code: Code, a: Value, b: Value) -> Value:
    """Return a power: integer powers by squaring, others by `pow`."""
    if b.kind != "int" or not b.text.lstrip("-").isdigit():
        return code.unit.called_library(code, "llvm.pow.f64", a, b)
    exponent = int(b.text)
    result: Value | None = None
    square = a if a.kind in ("float", "dual") or exponent >= 0 else code.converted(a, "float")
    rest = abs(exponent)
    while rest:
        if rest & 1:
            result = square if result is None else plain(code, ast.Mult, result, square)
        rest >>= 1
        if rest:
            square = plain(code, ast.Mult, square, square)
    result = result or code.converted(constant(1), common([a]))
    return float_operation(code, "fdiv", constant(1.0), result) if exponent < 0 else result


def negated(code: Code, operand: Operand) -> Value:
    """Return the negative."""
    a = number(operand)
    if isinstance(a, Dual):
        return dual(negated(code, a.value), negated(code, a.slope))
    if a.kind == "float":
        return code.put_value("float", f"fneg {a.typed}")
    if a.text.isdigit():
        return constant(-int(a.text))
    return code.put_value("int", f"sub nsw i64 0, {code.integer(a).text}")


def compared(code: Code, operation: ast.cmpop, left: Operand, right: Operand) -> Value:
    """Return the truth value of a comparison."""
    if type(operation) not in COMPARISONS:
        raise Untranslatable(f"the comparison {type(operation).__name__}")
    of_floats, of_ints = COMPARISONS[type(operation)]
    a, b = (undirected(number(side)) for side in (left, right))
    kind = common([a, b])
    instruction = f"fcmp {of_floats}" if kind == "float" else f"icmp {of_ints}"
    kind = "int" if kind == "bool" else kind
    return code.put_value("bool", f"{instruction} {code.converted(a, kind).typed}, {code.converted(b, kind).text}")


def selected(code: Code, condition: Value, then: Value, otherwise: Value) -> Value:
    """Select one of two computed values."""
    kind = common([then, otherwise])
    a, b = code.converted(then, kind), code.converted(otherwise, kind)
    if isinstance(a, Dual) and isinstance(b, Dual):
        return dual(selected(code, condition, a.value, b.value), selected(code, condition, a.slope, b.slope))
    return code.put_value(kind, f"select {condition.typed}, {LLVM_TYPES[kind]} {a.text}, {b.typed}")


def number(operand: Operand) -> Value:
    """Return the operand if it is a number."""
    if not isinstance(operand, Value) or operand.kind not in ("int", "float", "bool", "int32", "dual"):
        raise Untranslatable(f"found {operand}, expected a number")
    return operand
