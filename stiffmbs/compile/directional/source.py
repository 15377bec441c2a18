"""Source of kernels for directional derivatives of other kernels."""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterator

from ...errors import InputError
from ..terms import KERNEL_ARGUMENTS, KERNEL_SIGNATURE
from .expressions import Part, added, difference, divided, multiplied, negated, number
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
                yield f"{ast.unparse(target)} = {ast.unparse(moved or number(0.0))}"
                continue
            assert isinstance(target, ast.Name)
            yield ast.unparse(statement)
            self._moving.discard(target.id)
            if moved is not None:
                self._moving.add(target.id)
                yield f"{target.id}_d = {ast.unparse(moved)}"

    def _derivative(self, node: ast.expr) -> Part:
        match node:
            case ast.Constant() | ast.Compare() | ast.BoolOp():
                return None
            case ast.Name(name):
                return ast.Name(f"{name}_d") if name in self._moving else None
            case ast.Subscript(ast.Name(array), index):
                return ast.Subscript(ast.Name(f"{array}_d"), index) if array in self._along else None
            case ast.UnaryOp(ast.USub(), operand):
                return negated(self._derivative(operand))
            case ast.UnaryOp(ast.UAdd(), operand):
                return self._derivative(operand)
            case ast.BinOp(left, operator, right):
                return self._of_operation(node, left, operator, right)
            case ast.IfExp(condition, then, otherwise):
                return self._of_choice(condition, then, otherwise)
            case ast.Call(ast.Name(name), arguments) if name in RULES:
                return RULES[name](arguments, [self._derivative(argument) for argument in arguments])
        raise InputError(f"found '{ast.unparse(node)}' in an equation, which has no rule of differentiation here")

    def _of_operation(self, node: ast.expr, left: ast.expr, operator: ast.operator, right: ast.expr) -> Part:
        a, b = self._derivative(left), self._derivative(right)
        match operator:
            case ast.Add():
                return added(a, b)
            case ast.Sub():
                return difference(a, b)
            case ast.Mult():
                return added(multiplied(a, right), multiplied(left, b))
            case ast.Div():
                return divided(difference(a, multiplied(node, b)), right)
            case ast.Pow():
                return self._of_power(node, left, right, a, b)
        raise InputError(f"found '{ast.unparse(node)}' in an equation, which has no rule of differentiation here")

    @staticmethod
    def _of_power(node: ast.expr, base: ast.expr, exponent: ast.expr, a: Part, b: Part) -> Part:
        lower = ast.BinOp(base, ast.Pow(), _one_less(exponent))
        by_base = multiplied(multiplied(exponent, lower), a)
        by_exponent = multiplied(multiplied(node, ast.Call(ast.Name("log"), [base], [])), b)
        return added(by_base, by_exponent)

    def _of_choice(self, condition: ast.expr, then: ast.expr, otherwise: ast.expr) -> Part:
        a, b = self._derivative(then), self._derivative(otherwise)
        if a is None and b is None:
            return None
        return ast.IfExp(condition, a or number(0.0), b or number(0.0))


def _one_less(exponent: ast.expr) -> ast.expr:
    """Return the exponent minus one, as a literal if possible: integer powers become products."""
    try:
        return number(ast.literal_eval(exponent) - 1)
    except ValueError:
        return ast.BinOp(exponent, ast.Sub(), number(1.0))
