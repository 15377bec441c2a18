"""Arithmetic operators."""

from __future__ import annotations

import ast

from .code import Code, common, constant
from .values import LLVM_TYPES, Operand, Untranslatable, Value

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
    if common([a, b]) == "float":
        return float_operation(code, FLOAT_OPERATIONS[operation], a, b)
    return code.put_value("int", f"{INT_OPERATIONS[operation]} {code.integer(a).typed}, {code.integer(b).text}")


def float_operation(code: Code, instruction: str, a: Value, b: Value) -> Value:
    """Return an operation on two floats."""
    return code.put_value(
        "float", f"{instruction} {code.converted(a, 'float').typed}, {code.converted(b, 'float').text}"
    )


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
    square = a if a.kind == "float" or exponent >= 0 else code.converted(a, "float")
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
    a, b = number(left), number(right)
    kind = common([a, b])
    instruction = f"fcmp {of_floats}" if kind == "float" else f"icmp {of_ints}"
    kind = "int" if kind == "bool" else kind
    return code.put_value("bool", f"{instruction} {code.converted(a, kind).typed}, {code.converted(b, kind).text}")


def selected(code: Code, condition: Value, then: Value, otherwise: Value) -> Value:
    """Select one of two computed values."""
    kind = common([then, otherwise])
    a, b = code.converted(then, kind), code.converted(otherwise, kind)
    return code.put_value(kind, f"select {condition.typed}, {LLVM_TYPES[kind]} {a.text}, {b.typed}")


def number(operand: Operand) -> Value:
    """Return the operand if it is a number."""
    if not isinstance(operand, Value) or operand.kind not in ("int", "float", "bool", "int32"):
        raise Untranslatable(f"found {operand}, expected a number")
    return operand
