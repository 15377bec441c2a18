"""Calls of Python functions through their callbacks (`stiffmbs.compile.callbacks`)."""

from __future__ import annotations

import math

from ....errors import InputError
from ..translate.arithmetic import sum_of_products
from ..translate.code import Code, constant
from ..translate.values import Dual, Operand, Value, builtin, dual, slope_of, undirected


@builtin
def python_call(code: Code, address: Operand, count: Operand, output: Operand, by: Operand, *arguments: Operand):
    """Return a value or derivative of a Python function; NaN without an answer, which sets a flag.

    One number of the element is the address of two words: the C function, and the flag for a call without an answer.
    """
    if any(isinstance(argument, Dual) for argument in arguments):
        return _with_derivative(code, (undirected(address), count, output), by, arguments)
    array, answer_at = code.doubles(len(arguments) + 1), constant(len(arguments))
    for k, argument in enumerate((*arguments, constant(math.nan))):
        code.store(code.item(array, constant(k)), argument)
    whole = code.put_value("int", f"fptosi {code.converted(undirected(address), 'float').typed} to i64")
    words = code.put_value("ints", f"inttoptr {whole.typed} to ptr")
    function = code.put_value("ints", f"inttoptr {code.load(code.item(words, constant(0))).typed} to ptr")
    given = ", ".join(code.integer(part).typed for part in (count, output, by, answer_at))
    code.put(f"call void {function.text}({given}, {array.typed})")
    answer = code.load(code.item(array, answer_at))
    is_open = code.put_value("bool", f"fcmp uno {answer.typed}, 0.0")
    unanswered = code.item(words, constant(1))
    code.store(unanswered, code.put_value("int", f"or {code.load(unanswered).typed}, {code.integer(is_open).text}"))
    return answer


def _with_derivative(
    code: Code, function: tuple[Operand, ...], by: Operand, arguments: tuple[Operand, ...]
) -> Value:  # fmt: skip
    """Return a value of a Python function and its derivative in the direction of its arguments."""
    if int(undirected(by).text) >= 0:
        raise InputError("found a Python function whose second derivatives are needed, expected a formula in its place")
    given = [undirected(argument) for argument in arguments]
    slopes = (
        (slope, python_call.lower(code, *function, constant(k), *given))
        for k, slope in enumerate(map(slope_of, arguments))
        if slope
    )
    return dual(python_call.lower(code, *function, by, *given), sum_of_products(code, slopes))
