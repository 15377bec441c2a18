"""Calls of Python functions by the addresses of their callbacks (`stiffmbs.compile.callbacks`)."""

from __future__ import annotations

from ..translate.code import Code, constant
from ..translate.values import Operand, builtin


@builtin
def python_call(code: Code, address: Operand, count: Operand, output: Operand, by: Operand, *arguments: Operand):
    """A value of a Python function, or a derivative; its address is kept among the numbers of an element."""
    array = code.array(len(arguments))
    for k, argument in enumerate(arguments):
        code.store(code.item(array, constant(k)), argument)
    whole = code.put_value("int", f"fptosi {code.converted(address, 'float').typed} to i64")
    function = code.put_value("ints", f"inttoptr {whole.typed} to ptr")
    given = ", ".join(code.integer(part).typed for part in (count, output, by, constant(len(arguments))))
    return code.put_value("float", f"call double {function.text}({given}, {array.typed})")
