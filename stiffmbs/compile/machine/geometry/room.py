"""Memory of one function in kernels."""

from __future__ import annotations

from ..translate.code import Code
from ..translate.values import Operand, Value, builtin


@builtin
def room(code: Code, count: Operand) -> Value:
    """Memory for so many doubles."""
    return code.array(int(code.integer(count).text))
