"""Calls of C functions by address in compiled routines."""

from __future__ import annotations

from stiffmbs.compile.machine.translate.code import Code
from stiffmbs.compile.machine.translate.values import LLVM_TYPES, Operand, Value, builtin

from .access import ints


@builtin
def int32(code: Code, number: Operand) -> Value:
    """Convert a number to C's int."""
    return code.converted(number, "int32")


@builtin
def call_int(code: Code, function: Operand, arguments: tuple[Value, ...]) -> Value:
    """Call a C function at an address that returns an int."""
    return _called(code, "int32", function, arguments)


@builtin
def call_float(code: Code, function: Operand, arguments: tuple[Value, ...]) -> Value:
    """Call a C function at an address that returns a double."""
    return _called(code, "float", function, arguments)


@builtin
def call_address(code: Code, function: Operand, argument: Value) -> Value:
    """Call a C function of one pointer that returns a pointer; both as addresses."""
    return _called(code, "int", function, (argument,))


def _called(code: Code, kind: str, function: Operand, arguments: tuple[Value, ...]) -> Value:
    given = ", ".join(argument.typed for argument in arguments)
    return code.put_value(kind, f"call {LLVM_TYPES[kind]} {ints.lower(code, function).text}({given})")
