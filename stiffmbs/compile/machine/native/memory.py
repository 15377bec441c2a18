"""Memory that compiled routines ask for themselves, where its size is known only on the way.

It belongs to a table whose layout says so (`stiffmbs.compile.machine.own_memory`).  After it has grown, the table's view has to
be made anew.
"""

from __future__ import annotations

from ..translate.code import Code
from ..translate.values import Operand, Value, builtin
from .access import compiled

REALLOCATE = "PyMem_RawRealloc"
"""The C library's realloc by the name under which each Python has it; needs no lock of the interpreter."""
INT, INDEX, FLOAT = 8, 4, 8
"""Bytes of a number."""
MOST_INDICES = 2**31 - 1
"""The largest number of an array of 32-bit indices."""


@builtin
def _reallocated(code: Code, address: Operand, size: Operand) -> Value:
    """The address of so many bytes, which begin with what was at the old address; 0 where there is no memory."""
    code.unit.declare(f"declare ptr @{REALLOCATE}(ptr, i64)")
    before = code.put_value("ints", f"inttoptr {code.integer(address).typed} to ptr")
    after = code.put_value("ints", f"call ptr @{REALLOCATE}({before.typed}, {code.integer(size).typed})")
    return code.put_value("int", f"ptrtoint {after.typed} to i64")


@compiled
def holds(table, column, count, width):
    """Have the array at a column of a table hold `count` numbers of `width` bytes; whether there is memory for them."""
    address = _reallocated(table[column], max(count, 1) * width)
    if address == 0:
        return False
    table[column] = address
    return True
