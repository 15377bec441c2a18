"""Source of kernels for directional derivatives of other kernels."""

from __future__ import annotations

import ast
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass

from ...errors import InputError
from ..terms import KERNEL_ARGUMENTS, KERNEL_SIGNATURE

STATE = ("t", "q", "turn", "u", "a", "lam", "mu")
NUMBER, TIME = "number", "t"
DIRECTION = f"{NUMBER}_d, " + ", ".join(f"{name}_d" for name in STATE)
SIGNATURE = KERNEL_SIGNATURE.removesuffix(")") + ", float64*, float64, " + ", ".join(["float64*"] * 6) + ")"
"""Signature of a kernel with the derivatives of its inputs appended; its values are derivatives."""


def directional_source(source: str, name: str, along: Collection[str]) -> str:
    """Return the source of the directional derivative of a kernel.

    `source`: source of the kernel, as written by `stiffmbs.compile.symbolic.generate`. `name`: name of the new
    function. `along`: quantities that change: ``number``, and names of `STATE`. Raises InputError if a function in it
    has no differentiation rule.
    """
    module = ast.parse(source)
    imports = [part for part in module.body if isinstance(part, ast.ImportFrom)]
    kernel = next(part for part in module.body if isinstance(part, ast.FunctionDef))
    *places, loop = kernel.body
    assert isinstance(loop, ast.For)
    statements = _Forward(along).statements(loop.body)
    return "\n".join([
        *map(ast.unparse, imports), "", "",
        f"def {name}({KERNEL_ARGUMENTS}, {DIRECTION}):",
        *(f"    {ast.unparse(place)}" for place in places),
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
                try:
                    one_less = number(ast.literal_eval(right) - 1)  # integer powers become products
                except ValueError:
                    one_less = y - number(1.0)
                return y * x**one_less * a + Part(node) * called("log", x) * b
        raise _without_rule(node)


def _without_rule(node: ast.expr) -> InputError:
    return InputError(f"found '{ast.unparse(node)}' in an equation, which has no rule of differentiation here")


@dataclass(frozen=True)
class Part:
    """Part of an expression; without a node it is zero, and false."""

    node: ast.expr | None = None

    def __bool__(self) -> bool:
        return self.node is not None

    def __neg__(self) -> Part:
        return Part(ast.UnaryOp(ast.USub(), self.node)) if self.node else self

    def __add__(self, other: Part) -> Part:
        return self._joined(ast.Add(), other) if self and other else self or other

    def __sub__(self, other: Part) -> Part:
        return self._joined(ast.Sub(), other) if self and other else self or -other

    def __mul__(self, other: Part) -> Part:
        return self._joined(ast.Mult(), other) if self and other else Part()

    def __truediv__(self, other: Part) -> Part:
        return self._joined(ast.Div(), other) if self else self

    def __pow__(self, other: Part) -> Part:
        return self._joined(ast.Pow(), other)

    def _joined(self, operator: ast.operator, other: Part) -> Part:
        return Part(ast.BinOp(self.whole, operator, other.whole))

    @property
    def whole(self) -> ast.expr:
        """Expression, or a literal zero."""
        return self.node or ast.Constant(0.0)

    @property
    def literal(self) -> int:
        """Value of an integer literal with or without a sign; `ValueError` for others."""
        return int(ast.literal_eval(self.whole))


ZERO = Part()


def number(value: float) -> Part:
    """Return a literal."""
    return Part(ast.Constant(value))


def called(name: str, *arguments: Part) -> Part:
    """Return a function call."""
    return Part(ast.Call(ast.Name(name), [argument.whole for argument in arguments], []))


Parts = Sequence[Part]
Rule = Callable[[Parts, Parts], Part]
ONE = number(1.0)


def _smooth(slope: Callable[[Part], Part]) -> Rule:
    return lambda arguments, moved: slope(arguments[0]) * moved[0]


def _of(name: str) -> Callable[[Part], Part]:
    return lambda x: called(name, x)


def _atan2(arguments: Parts, moved: Parts) -> Part:
    y, x = arguments[:2]
    return (x * moved[0] - y * moved[1]) / (x * x + y * y)


def _chosen(arguments: Parts, moved: Parts) -> Part:
    return called("chosen", arguments[0], *moved[1:]) if any(moved[1:]) else ZERO


def _extreme(greater: bool) -> Rule:
    def rule(arguments: Parts, moved: Parts) -> Part:
        first, second = arguments if greater else arguments[::-1]
        return _chosen([first - second, *arguments], [ZERO, moved[1], moved[0], moved[0]])

    return rule


def _inside(arguments: Parts, moved: Parts) -> Part:
    return called("inside", *arguments[:3], moved[3]) if moved[3] else ZERO


def _step(name: str) -> Rule:
    def rule(arguments: Parts, moved: Parts) -> Part:
        """Differentiate a step function as `stiffmbs.compile.symbolic.nonsmooth.Step.by_parts`."""
        x, x0, h0, x1, h1, order = arguments
        k, width = order.literal, x1 - x0
        shift = moved[0] + (moved[1] * (x - x1) - moved[3] * (x - x0)) / width
        inner = called(name, x, x0, h0, x1, h1, number(k + 1)) * shift
        if k:
            inner = inner - number(float(k)) * called(name, *arguments) * ((moved[3] - moved[1]) / width)
        levels = called(name, x, x0, moved[2], x1, moved[4], order) if moved[2] or moved[4] else ZERO
        return levels + (called("inside", x, x0, x1, inner) if inner else ZERO)

    return rule


def _spline(arguments: Parts, moved: Parts) -> Part:
    """Differentiate by the argument and by the table values, which ``number_d`` holds next to unchanged arguments."""
    numbers, table, x, order = arguments
    by_numbers = called("spline", moved[0], table, x, order) if moved[0] else ZERO
    if order.literal >= 3:  # the third derivative of a cubic is constant
        return by_numbers
    return by_numbers + called("spline", numbers, table, x, number(order.literal + 1)) * moved[2]


def _rotation_vector(arguments: Parts, moved: Parts) -> Part:
    h, order = arguments
    return called("rotation_vector", h, number(order.literal + 1)) * moved[0]


def _python_call(arguments: Parts, moved: Parts) -> Part:
    address, count, output, by, *given = arguments
    if by.literal >= 0:
        return _refuse(
            moved[4:], "a Python function whose second derivatives are needed, expected a formula in its place"
        )
    slopes = (called("python_call", address, count, output, number(k), *given) for k in range(len(given)))
    return sum((slope * part for slope, part in zip(slopes, moved[4:], strict=True)), ZERO)


def _common_normal(arguments: Parts, moved: Parts) -> Part:
    component, *pose = arguments
    normal = [called("common_normal", number(k), *pose) for k in range(3)]
    slopes = (called("common_normal_slope", component, number(k), *normal, *pose) for k in range(len(pose)))
    return sum((slope * part for slope, part in zip(slopes, moved[1:], strict=True)), ZERO)


def _refuse(moved: Parts, found: str) -> Part:
    """Return zero, or refuse arguments that change."""
    if any(moved):
        raise InputError(f"found {found}")
    return ZERO


RULES: dict[str, Rule] = {
    "sin": _smooth(_of("cos")),
    "cos": _smooth(lambda x: -called("sin", x)),
    "tan": _smooth(lambda x: ONE / (called("cos", x) * called("cos", x))),
    "asin": _smooth(lambda x: ONE / called("sqrt", ONE - x * x)),
    "acos": _smooth(lambda x: -(ONE / called("sqrt", ONE - x * x))),
    "atan": _smooth(lambda x: ONE / (ONE + x * x)),
    "sinh": _smooth(_of("cosh")),
    "cosh": _smooth(_of("sinh")),
    "tanh": _smooth(lambda x: ONE - called("tanh", x) * called("tanh", x)),
    "asinh": _smooth(lambda x: ONE / called("sqrt", ONE + x * x)),
    "exp": _smooth(_of("exp")),
    "log": _smooth(lambda x: ONE / x),
    "sqrt": _smooth(lambda x: number(0.5) / called("sqrt", x)),
    "magnitude": _smooth(_of("sign")),
    "abs": _smooth(_of("sign")),
    "atan2": _atan2, "continuous_angle": _atan2, "chosen": _chosen, "inside": _inside,
    "greater": _extreme(True), "less": _extreme(False), "step": _step("step"), "step5": _step("step5"),
    **dict.fromkeys(("sign", "copysign", "floor", "int"), lambda arguments, moved: ZERO),
    "spline": _spline, "rotation_vector": _rotation_vector, "python_call": _python_call,
    "common_normal": _common_normal,
    "common_normal_slope": lambda arguments, moved: _refuse(
        moved[2:], "a contact of solids whose second derivatives are needed, expected another contact"
    ),
}  # fmt: skip
"""Rules by name of the kernel function."""
