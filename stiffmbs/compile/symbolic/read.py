"""Conversion of SymPy functions in elements' equations to kernel functions.

`Abs`, `sign`, `Max`, `Min` and `Heaviside` become functions of `stiffmbs.compile.symbolic.nonsmooth`; functions without
a kernel form are refused.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from functools import lru_cache
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef
from sympy.core.relational import Relational

from ...errors import InputError
from ...reading.formula.functions import FUNCTIONS
from .nonsmooth import Chosen, Magnitude, NonsmoothBase, Sign, greater, less

KNOWN: tuple[type[sp.Basic], ...] = (
    *(
        getattr(sp, name) for name, function in FUNCTIONS.items() if function.in_c and name != "sqrt"
    ),  # which is a power
    sp.Piecewise,
)
"""Functions supported by kernels: those of formulas, and conditions."""
BY_OTHERS = (sp.cos, sp.cosh, sp.tanh, sp.log)
"""Functions by which SymPy may rewrite unsupported functions, in this order."""


def _differences(x: tuple[sp.Expr, ...]) -> tuple[sp.Expr, ...]:
    return tuple(a - b for a, b in itertools.combinations(x, 2))


NONSMOOTH: dict[type[sp.Basic], Callable[..., tuple[sp.Expr, tuple[sp.Expr, ...]]]] = {
    sp.Abs: lambda x: (Magnitude(x), (x,)),
    sp.sign: lambda x: (Sign(x), (x,)),
    sp.Max: lambda *x: (greater(*x), _differences(x)),
    sp.Min: lambda *x: (less(*x), _differences(x)),
    sp.Heaviside: lambda x, at: (Chosen(x, sp.Integer(0), at, sp.Integer(1)), (x,)),
}
"""Nonsmooth functions: their kernel form, and the expressions that are zero at breakpoints."""
NO_NUMBER = frozenset((sp.nan, sp.zoo, sp.oo, -sp.oo, sp.I))
UNDONE = (sp.Derivative, sp.Integral, sp.Sum, sp.Product, sp.Subs)


def read(x: sp.Expr, note: Callable[[sp.Expr], None]) -> sp.Expr:
    """Return an expression in the form for kernels.

    `note`: called with the expression that is zero at each breakpoint. Raises InputError if it is not a real
    expression, or contains an unsupported function.
    """
    expression = sp.sympify(x)
    if not isinstance(expression, sp.Expr):
        raise InputError(f"found {x!r}, expected an expression of SymPy or a number")
    if is_ready(expression):
        return expression
    for part in sp.preorder_traversal(expression):
        if part in NO_NUMBER:
            raise InputError(f"found {expression}, which is no real number, expected one")
        if isinstance(part, UNDONE):
            raise InputError(f"found {part}, which SymPy has not worked out, expected an expression without it")
    return _read(expression, note)


@lru_cache(maxsize=2**14)
def is_ready(x: sp.Basic) -> bool:
    """Return True if kernels support an expression unchanged; cached for shared subexpressions."""
    here = _is_plain(x) or _is_own(x)
    return here and x not in NO_NUMBER and not isinstance(x, UNDONE) and all(map(is_ready, x.args))


def _is_plain(part: sp.Basic) -> bool:
    """Return True if a part of an expression means the same in kernels and SymPy."""
    return not isinstance(part, sp.Function | sp.Max | sp.Min) or (
        isinstance(part, KNOWN) and not isinstance(part, sp.Piecewise)
    )


def _is_own(part: sp.Basic) -> bool:
    """Return True if a function belongs to this package."""
    return isinstance(part, NonsmoothBase) or type(part).__module__.startswith("stiffmbs.")


def _read(x: sp.Basic, note: Callable[[sp.Expr], None]) -> Any:
    if not x.args:
        return x
    arguments = [_read(part, note) for part in x.args]
    if type(x) in NONSMOOTH:
        value, breakpoints = NONSMOOTH[type(x)](*arguments)
        for breakpoint in breakpoints:
            note(breakpoint)
        return value
    if isinstance(x, sp.Piecewise):
        if x.args[-1].cond != True:  # noqa: E712 SymPy's own
            raise InputError(f"found {x}, which has no value elsewhere, expected a last part (value, True)")
        for relation in sp.Piecewise(*arguments).atoms(Relational):
            note(relation.lhs - relation.rhs)
    found = x.func(*arguments)
    if not isinstance(x, sp.Function) or isinstance(found, KNOWN) or _is_own(x) or not isinstance(found, sp.Function):
        return found
    return _by_others(found, note)


def _by_others(x: sp.Function, note: Callable[[sp.Expr], None]) -> sp.Expr:
    """Rewrite a function by others that kernels support."""
    for other in () if isinstance(x, AppliedUndef) else BY_OTHERS:
        written = x.rewrite(other)
        functions = (part for part in sp.preorder_traversal(written) if isinstance(part, sp.Function | sp.Max | sp.Min))
        if not written.has(sp.I) and all(isinstance(part, (*KNOWN, *NONSMOOTH)) or _is_own(part) for part in functions):
            return _read(written, note)
    names = ", ".join(sorted({part.__name__ for part in (*KNOWN, *NONSMOOTH)}))
    raise InputError(f"found the function {x.func}, expected one of {names}")
