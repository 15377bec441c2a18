"""Local memory of functions in kernels."""

from __future__ import annotations

from ..translate.code import Code
from ..translate.values import Operand, Value, builtin


@builtin
def room(code: Code, count: Operand) -> Value:
    """Return memory for the given number of doubles."""
    return code.array(int(code.integer(count).text))
