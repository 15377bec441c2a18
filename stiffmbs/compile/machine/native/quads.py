"""Four floats side by side, which a processor multiplies and adds at once.

Every machine gives the same numbers: products are added with one rounding, in an order that is written down here.
"""

from __future__ import annotations

from ..translate.code import Code, constant
from ..translate.values import Operand, Untranslatable, Value, builtin

QUAD = 4
"""Floats of a quad."""


@builtin
def quad(code: Code, pointer: Operand, index: Operand) -> Value:
    """The four floats from `index` on."""
    return _loaded(code, code.item(pointer, index).text)


@builtin
def set_quad(code: Code, pointer: Operand, index: Operand, value: Operand) -> None:
    """Write four floats from `index` on."""
    _store(code, code.item(pointer, index).text, _quad(value))


@builtin
def spread(code: Code, number: Operand) -> Value:
    """Four times the same float."""
    one = code.put_value("quad", f"insertelement <4 x double> poison, {code.converted(number, 'float').typed}, i32 0")
    return code.put_value("quad", f"shufflevector {one.typed}, <4 x double> poison, <4 x i32> zeroinitializer")


@builtin
def plus_product(code: Code, total: Operand, a: Operand, b: Operand) -> Value:
    """total + a * b, rounded once."""
    return _plus_product(code, _quad(total), _quad(a), _quad(b))


@builtin
def sum_of(code: Code, value: Operand) -> Value:
    """The sum of four floats: of both halves first."""
    vector = _quad(value).typed
    upper = code.put_value(
        "quad", f"shufflevector {vector}, <4 x double> poison, <4 x i32> <i32 2, i32 3, i32 2, i32 3>"
    )
    halves = code.put_value("quad", f"fadd {vector}, {upper.text}")
    first, second = (code.put_value("float", f"extractelement {halves.typed}, i32 {k}") for k in (0, 1))
    return code.put_value("float", f"fadd {first.typed}, {second.text}")


@builtin
def add_products(
    code: Code, rows: Operand, quads: Operand, into: Operand, stride: Operand, a: Operand, a_stride: Operand, b: Operand,
    b_stride: Operand, depth: Operand,
) -> None:  # fmt: skip
    """into[i, :] += sum of a[k, i] * b[k, :] over k, for so many rows i and quads of columns: both are literals.

    The sums stay in registers.  Strides are those of rows of `into`, and of k in `a` and `b`.
    """
    n, m = _literal(rows), _literal(quads)
    places = [
        code.item(into, code.put_value("int", f"add {_product(code, stride, i).typed}, {4 * j}")).text
        for i in range(n)
        for j in range(m)
    ]
    sums = [code.variable("quad") for _ in places]
    for total, place in zip(sums, places, strict=True):
        code.store(total, _loaded(code, place))
    k, at_a, at_b = (code.variable("int") for _ in range(3))
    for counter in (k, at_a, at_b):
        code.store(counter, constant(0))
    head, inside, end = code.name("depth"), code.name("product"), code.name("done")
    code.label(head)
    code.choose(code.put_value("bool", f"icmp slt {code.load(k).typed}, {code.integer(depth).text}"), inside, end)
    code.label(inside)
    columns = [_loaded(code, code.item(b, _sum(code, code.load(at_b), 4 * j)).text) for j in range(m)]
    for i in range(n):
        factor = spread.lower(code, code.load(code.item(a, _sum(code, code.load(at_a), i))))
        for j in range(m):
            total = sums[i * m + j]
            code.store(total, _plus_product(code, code.load(total), factor, columns[j]))
    for counter, step in ((k, constant(1)), (at_a, code.integer(a_stride)), (at_b, code.integer(b_stride))):
        code.store(counter, code.put_value("int", f"add nsw {code.load(counter).typed}, {step.text}"))
    code.branch(head)
    code.label(end)
    for total, place in zip(sums, places, strict=True):
        _store(code, place, code.load(total))


def _quad(value: Operand) -> Value:
    if not isinstance(value, Value) or value.kind != "quad":
        raise Untranslatable(f"found {value}, expected a quad")
    return value


def _literal(value: Operand) -> int:
    if not isinstance(value, Value) or not value.text.isdigit():
        raise Untranslatable(f"found {value}, expected a literal")
    return int(value.text)


def _sum(code: Code, index: Value, shift: int) -> Value:
    return code.put_value("int", f"add nsw {index.typed}, {shift}")


def _product(code: Code, stride: Operand, count: int) -> Value:
    return code.put_value("int", f"mul nsw {code.integer(stride).typed}, {count}")


def _loaded(code: Code, place: str) -> Value:
    return code.put_value("quad", f"load <4 x double>, ptr {place}, align 8")


def _store(code: Code, place: str, value: Value) -> None:
    code.put(f"store {value.typed}, ptr {place}, align 8")


def _plus_product(code: Code, total: Value, a: Value, b: Value) -> Value:
    declared = "declare <4 x double> @llvm.fma.v4f64(<4 x double>, <4 x double>, <4 x double>)"
    code.unit.declare(declared)
    return code.put_value("quad", f"call <4 x double> @llvm.fma.v4f64({a.typed}, {b.typed}, {total.typed})")
