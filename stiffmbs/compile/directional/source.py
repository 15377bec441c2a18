"""Source of kernels for directional derivatives of other kernels."""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterator

from ...errors import InputError
from ..terms import KERNEL_ARGUMENTS, KERNEL_SIGNATURE
from .expressions import ZERO, Part, called, number
from .rules import RULES

STATE = ("t", "q", "turn", "u", "a", "lam", "mu")
NUMBER, TIME = "number", "t"
DIRECTION = f"{NUMBER}_d, " + ", ".join(f"{name}_d" for name in STATE)
SIGNATURE = KERNEL_SIGNATURE.removesuffix(")") + ", float64*, float64, " + ", ".join(["float64*"] * 6) + ")"
"""Signature of a kernel with the derivatives of its inputs appended; its values are derivatives."""


def directional_source(source: str, name: str, along: Collection[str]) -> str:
    """Return the source of the directional derivative of a kernel.

    Parameters
    ----------
    source : str
        Source of the kernel, as written by `stiffmbs.compile.symbolic.generate`.
    name : str
        Name of the new function.
    along : collection of str
        Quantities that change: ``number``, and names of `STATE`.

    Raises
    ------
    InputError
        If a function in it has no differentiation rule.
    """
    module = ast.parse(source)
    imports = [part for part in module.body if isinstance(part, ast.ImportFrom)]
    kernel = next(part for part in module.body if isinstance(part, ast.FunctionDef))
    (loop,) = kernel.body
    assert isinstance(loop, ast.For)
    statements = _Forward(along).statements(loop.body)
    return "\n".join([
        *map(ast.unparse, imports), "", "",
        f"def {name}({KERNEL_ARGUMENTS}, {DIRECTION}):",
        "    for e in range(count):",
        *(f"        {line}" for line in statements),
        "",
    ])  # fmt: skip


class _Forward:
    """Forward-mode differentiation of the statements of one loop; derivatives have the suffix ``_d``."""

    def __init__(self, along: Collection[str]) -> None:
        self._along = along
        self._moving: set[str] = {TIME, NUMBER} & set(along)

    def statements(self, body: list[ast.stmt]) -> Iterator[str]:
        """Yield each statement and the statement for its derivative."""
        for statement in body:
            assert isinstance(statement, ast.Assign)
            (target,) = statement.targets
            moved = self._derivative(statement.value)
            if isinstance(target, ast.Subscript):  # an output value: replaced by its derivative
                yield f"{ast.unparse(target)} = {ast.unparse(moved.whole)}"
                continue
            assert isinstance(target, ast.Name)
            yield ast.unparse(statement)
            self._moving.discard(target.id)
            if moved:
                self._moving.add(target.id)
                yield f"{target.id}_d = {ast.unparse(moved.whole)}"

    def _derivative(self, node: ast.expr) -> Part:
        match node:
            case ast.Constant() | ast.Compare() | ast.BoolOp():
                return ZERO
            case ast.Name(name):
                return Part(ast.Name(f"{name}_d")) if name in self._moving else ZERO
            case ast.Subscript(ast.Name(array), index):
                return Part(ast.Subscript(ast.Name(f"{array}_d"), index)) if array in self._along else ZERO
            case ast.UnaryOp(ast.USub(), operand):
                return -self._derivative(operand)
            case ast.UnaryOp(ast.UAdd(), operand):
                return self._derivative(operand)
            case ast.BinOp(left, operator, right):
                return self._of_operation(node, operator, left, right)
            case ast.IfExp(condition, then, otherwise):
                a, b = self._derivative(then), self._derivative(otherwise)
                return Part(ast.IfExp(condition, a.whole, b.whole)) if a or b else ZERO
            case ast.Call(ast.Name(name), arguments) if name in RULES:
                return RULES[name](list(map(Part, arguments)), list(map(self._derivative, arguments)))
        raise _without_rule(node)

    def _of_operation(self, node: ast.expr, operator: ast.operator, left: ast.expr, right: ast.expr) -> Part:
        a, b, x, y = self._derivative(left), self._derivative(right), Part(left), Part(right)
        match operator:
            case ast.Add():
                return a + b
            case ast.Sub():
                return a - b
            case ast.Mult():
                return a * y + x * b
            case ast.Div():
                return (a - Part(node) * b) / y
            case ast.Pow():
                return y * x ** _one_less(right) * a + Part(node) * called("log", x) * b
        raise _without_rule(node)


def _without_rule(node: ast.expr) -> InputError:
    return InputError(f"found '{ast.unparse(node)}' in an equation, which has no rule of differentiation here")


def _one_less(exponent: ast.expr) -> Part:
    """Return the exponent minus one, as a literal if possible: integer powers become products."""
    try:
        return number(ast.literal_eval(exponent) - 1)
    except ValueError:
        return Part(exponent) - number(1.0)
