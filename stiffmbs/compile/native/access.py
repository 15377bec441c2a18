"""Pointers from addresses, calls of kernels by address, and named views of tables of addresses."""

from __future__ import annotations

from collections import namedtuple
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import njit, types
from numba.extending import intrinsic

from ..layout import ELIMINATED, EQUATIONS, EXPLICIT, FACTORS, IDA, MECHANICS, SCHEME, STATE, Layout

compiled = njit(error_model="numpy")
"""Marks a function for use in compiled routines: a division by zero gives infinity, nothing raises."""


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
def shifted(typing_context, pointer, count):
    """The pointer to the item `count` places on."""

    def code(context, builder, signature, arguments):
        return builder.gep(arguments[0], [arguments[1]])

    return pointer(pointer, types.int64), code


@intrinsic
def call_kernel(typing_context, kernel, count, index, number, t, q, u, a, lam, mu, place, value):
    """Call a kernel (`stiffmbs.compile.terms.KERNEL_SIGNATURE`) by its address."""
    arguments_type = (kernel, count, index, number, t, q, u, a, lam, mu, place, value)

    def code(context, builder, signature, arguments):
        values = [context.get_value_type(kind) for kind in signature.args[1:]]
        function = ir.FunctionType(ir.VoidType(), values)
        builder.call(builder.inttoptr(arguments[0], function.as_pointer()), arguments[1:])
        return context.get_dummy_value()

    return types.void(*arguments_type), code


def view_of(name: str, layout: Layout) -> Callable[..., Any]:
    """A compiled function that turns a table laid out by `layout` into a named tuple of pointers and numbers."""
    fields = namedtuple(name, list(layout))  # type: ignore[misc]
    reads = {"int": "table[{}]", "ints": "ints(table[{}])", "floats": "floats(table[{}])"}
    arguments = ", ".join(reads[kind].format(column) for column, kind in enumerate(layout.values()))
    namespace: dict[str, Any] = {"fields": fields, "ints": ints, "floats": floats}
    exec(f"def view(table):\n    return fields({arguments})\n", namespace)  # made from the layout above
    return compiled(namespace["view"])


state_view = view_of("State", STATE)
equations_view = view_of("Equations", EQUATIONS)
factors_view = view_of("Factors", FACTORS)
ida_view = view_of("Ida", IDA)
mechanics_view = view_of("Mechanics", MECHANICS)
scheme_view = view_of("Scheme", SCHEME)
explicit_view = view_of("Explicit", EXPLICIT)
eliminated_view = view_of("Eliminated", ELIMINATED)
