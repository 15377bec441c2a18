"""Memory and C functions by their addresses, in numba."""

from __future__ import annotations

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic


@intrinsic
def floats(typing_context, address):
    """The doubles at an address."""
    return _pointer_to(types.float64)


@intrinsic
def ints(typing_context, address):
    """The 64-bit integers at an address."""
    return _pointer_to(types.int64)


def _pointer_to(item):
    def code(context, builder, signature, arguments):
        return builder.inttoptr(arguments[0], context.get_value_type(types.CPointer(item)))

    return types.CPointer(item)(types.int64), code


@intrinsic
def call_int(typing_context, function, arguments):
    """Call a C function that returns an int; `arguments` is a tuple."""

    def code(context, builder, signature, given):
        values = cgutils.unpack_tuple(builder, given[1])
        kind = ir.FunctionType(ir.IntType(32), [value.type for value in values])
        return builder.call(builder.inttoptr(given[0], kind.as_pointer()), values)

    return types.int32(types.int64, arguments), code


@intrinsic
def call_address(typing_context, function, argument):
    """Call a C function of one pointer that returns a pointer; both as addresses."""

    def code(context, builder, signature, given):
        kind = ir.FunctionType(ir.IntType(64), [ir.IntType(64)])
        return builder.call(builder.inttoptr(given[0], kind.as_pointer()), [given[1]])

    return types.int64(types.int64, types.int64), code
