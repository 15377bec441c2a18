"""Calls of Python functions in the equations of forces."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import sympy as sp

from ...errors import InputError

VALUE = -1
"""Index of the argument to differentiate by, for the value itself."""


class PythonCall(sp.Function):  # type: ignore[misc]
    """Value of a Python function, or a derivative of it: PythonCall(address, count, output, by, arguments...).

    `stiffmbs.compile.callbacks.Callback` computes it; `by` is the argument to differentiate by, `VALUE` for none.
    """

    is_real = True

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        address, count, output, by, *arguments = self.args
        if by != VALUE:
            raise InputError("found a second derivative of a Python function, expected it in efforts, and not in rates")
        return PythonCall(address, count, output, sp.Integer(argindex - 5), *arguments)


def python_law(address: sp.Symbol, read: Callable[[Any], sp.Expr]) -> Callable[..., Any]:
    """Return the function called by equations: ``e.law(x, y)`` for one value, ``e.law(x, y, count=3)`` for a list."""

    def law(*arguments: Any, count: int | None = None) -> Any:
        """Return the values of the function as symbolic calls."""
        if not arguments:
            raise InputError("found a Python function without arguments, expected one at least")
        given = [read(argument) for argument in arguments]
        values = [PythonCall(address, count or 1, k, VALUE, *given) for k in range(count or 1)]
        return values[0] if count is None else values

    return law
