"""Memory of compiled routines: copies, and arrays of variable size.

An array of variable size belongs to a table whose layout declares it (`stiffmbs.compile.machine.layout.packed_with_memory`). The table's view must be created
again after a reallocation.
"""

from __future__ import annotations

import numpy as np

from ..layout import DTYPES, FLOATS, INTS
from ..translate.code import Code
from ..translate.values import Operand, Value, builtin
from .access import compiled

REALLOCATE = "PyMem_RawRealloc"
"""Python's name of the C library's realloc; needs no interpreter lock."""
INT, FLOAT = (np.dtype(DTYPES[kind]).itemsize for kind in (INTS, FLOATS))
"""Bytes of a number."""


@builtin
def _reallocated(code: Code, address: Operand, size: Operand) -> Value:
    """Return the address of a reallocated block; 0 if there is no memory."""
    code.unit.declare(f"declare ptr @{REALLOCATE}(ptr, i64)")
    before = code.put_value("ints", f"inttoptr {code.integer(address).typed} to ptr")
    after = code.put_value("ints", f"call ptr @{REALLOCATE}({before.typed}, {code.integer(size).typed})")
    return code.put_value("int", f"ptrtoint {after.typed} to i64")


@compiled
def copied(target, source, count):
    """Copy numbers."""
    for i in range(count):
        target[i] = source[i]


@compiled
def holds(table, column, count, width):
    """Resize the array at a column of a table to `count` numbers of `width` bytes; return False without memory."""
    address = _reallocated(table[column], max(count, 1) * width)
    if address == 0:
        return False
    table[column] = address
    return True
