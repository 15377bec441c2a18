"""Four-lane (SIMD) vectors of doubles.

Results are the same on every machine: products are added with one rounding, in the order written here.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from ..layout import QUAD
from ..translate.code import Code, constant
from ..translate.values import (
    LLVM_TYPES,
    Builtin,
    Dual,
    Operand,
    Untranslatable,
    Value,
    builtin,
    dual,
    slope_of,
    undirected,
)

WIDTHS = {QUAD: "quad", 2 * QUAD: "octet"}
"""Kinds of vectors by number of lanes."""
Lines = tuple[Operand, Operand]
"""Start of rows of numbers, and their stride."""


@builtin
def quad(code: Code, pointer: Operand, index: Operand) -> Value:
    """Load four floats from `index` on."""
    if isinstance(pointer, Dual):
        return dual(quad.lower(code, pointer.value, index), quad.lower(code, pointer.slope, index))
    return loaded(code, QUAD, code.item(pointer, index).text)


@builtin
def set_quad(code: Code, pointer: Operand, index: Operand, value: Operand) -> None:
    """Store four floats from `index` on."""
    write(code, code.item(pointer, index).text, as_quad(value))


@builtin
def spread(code: Code, number: Operand) -> Value:
    """Broadcast a float to four lanes."""
    return spread_over(code, QUAD, code.converted(number, "float"))


def by_case(
    function: Builtin, cases: Mapping[int, Sequence[int]], general: Callable[..., Any] | None = None
) -> Builtin:
    """Return a function that calls a built-in one with the literals of a case in place of its first argument.

    Others call a general function with the first argument itself; without one, they count as the last case.
    """

    def lower(code: Code, case: Operand, *arguments: Operand) -> None:
        """Emit a branch for each case."""
        end, number = code.name("done"), code.integer(case)
        for k, (wanted, literals) in enumerate(cases.items(), start=1):
            here, other = code.name("case"), code.name("other")
            if k < len(cases) or general:
                code.choose(code.put_value("bool", f"icmp eq {number.typed}, {wanted}"), here, other)
                code.label(here)
            function.lower(code, *map(constant, literals), *arguments)
            code.branch(end)
            code.label(other)
        if general:
            code.unit.called(code, general, [number, *arguments])
        code.label(end)

    return Builtin(lower)


@builtin
def quad_of(code: Code, *numbers: Operand) -> Value:
    """Return a vector of four floats."""
    found = Value("quad", "poison")
    for k, number in enumerate(numbers):
        one = code.converted(number, "float")
        found = code.put_value("quad", f"insertelement {found.typed}, {one.typed}, i32 {k}")
    return found


@builtin
def item_of(code: Code, value: Operand, index: Operand) -> Value:
    """Return one lane of a vector; the index is a literal."""
    return code.put_value("float", f"extractelement {as_quad(value).typed}, i32 {literal(index)}")


@builtin
def nearest_whole(code: Code, value: Operand) -> Value:
    """Round four floats to the nearest integers."""
    code.unit.declare("declare <4 x double> @llvm.rint.v4f64(<4 x double>)")
    return code.put_value("quad", f"call <4 x double> @llvm.rint.v4f64({as_quad(value).typed})")


@builtin
def product_of(code: Code, a: Operand, b: Operand) -> Value:
    """Return a * b."""
    return code.put_value("quad", f"fmul {as_quad(a).typed}, {as_quad(b).text}")


@builtin
def plus_product(code: Code, total: Operand, a: Operand, b: Operand) -> Value:
    """Return total + a * b of vectors, or of floats, rounded once."""
    if any(isinstance(part, Dual) for part in (total, a, b)):
        values, slopes = [undirected(part) for part in (total, a, b)], [slope_of(part) for part in (total, a, b)]
        change = slopes[0] or (constant(0.0) if values[0].kind == "float" else spread.lower(code, constant(0.0)))
        for x, y in ((slopes[1], values[2]), (values[1], slopes[2])):
            change = plus_product.lower(code, change, x, y) if x and y else change
        return dual(plus_product.lower(code, *values), change)
    if isinstance(total, Value) and total.kind == "float":
        return fused(code, total, *(code.converted(factor, "float") for factor in (a, b)))
    return fused(code, as_quad(total), as_quad(a), as_quad(b))


@builtin
def sum_of(code: Code, value: Operand) -> Value:
    """Return the sum of four lanes; both halves are added first."""
    if isinstance(value, Dual):
        return dual(sum_of.lower(code, value.value), sum_of.lower(code, value.slope))
    vector = as_quad(value).typed
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
    """Compute into[i, :] += sum of a[k, i] * b[k, :] over k; numbers of rows and column vectors are literals.

    The sums stay in registers. Strides are those of the rows of `into`, and of k in `a` and `b`. A literal depth is
    unrolled.
    """
    if isinstance(into, Dual):
        for to, x, y in (
            (into.value, undirected(a), undirected(b)),
            (into.slope, slope_of(a), undirected(b)),
            (into.slope, undirected(a), slope_of(b)),
        ):
            if x and y:
                _change(code, 1.0, (rows, quads), (to, stride), (x, a_stride), (y, b_stride), depth)
        return
    _change(code, 1.0, (rows, quads), (into, stride), (a, a_stride), (b, b_stride), depth)


@builtin
def add_pair_products(
    code: Code, rows: Operand, quads: Operand, into: Operand, stride: Operand, a: Operand, a_stride: Operand, b: Operand,
    b_stride: Operand, depth: Operand,
) -> None:  # fmt: skip
    """Compute into[i, :] += sum of a[k, i] * b[k, :], as `add_products`, of complex numbers: pairs of real and imaginary part.

    Sums with the real and with the imaginary parts of `a` stay in registers, hence of few rows at a time.
    """
    width, most = QUAD * literal(quads), QUAD // literal(quads)
    for first in range(0, literal(rows), most):
        numbers = range(first, min(first + most, literal(rows)))
        places = [code.item(into, times(code, stride, i)).text for i in numbers]
        real = [_kept(code, loaded(code, width, place)) for place in places]
        imaginary = [_kept(code, Value(WIDTHS[width], "zeroinitializer")) for _ in places]
        parts = [
            (total, 2 * i + part)
            for part, sums in enumerate((real, imaginary))
            for i, total in zip(numbers, sums, strict=True)
        ]

        def add(at_a: Value, at_b: Value, parts: Sequence[tuple[Value, int]] = parts) -> None:
            line = loaded(code, width, code.item(b, at_b).text)
            for total, shift in parts:
                number = code.load(code.item(a, plus(code, at_a, shift)))
                code.store(total, fused(code, code.load(total), spread_over(code, width, number), line))

        _loop(code, add, a_stride, b_stride, depth)
        for place, re, im in zip(places, real, imaginary, strict=True):
            total = code.load(re)
            turn = _times_i(code, code.load(im), width)
            write(code, place, code.put_value(total.kind, f"fadd {total.typed}, {turn.text}"))


@builtin
def times_i(code: Code, value: Operand) -> Value:
    """Return two complex numbers, pairs of real and imaginary part, times the imaginary unit."""
    return _times_i(code, as_quad(value), QUAD)


def _times_i(code: Code, value: Value, width: int) -> Value:
    exchanged = ", ".join(f"i32 {k ^ 1}" for k in range(width))
    parts = code.put_value(
        value.kind, f"shufflevector {value.typed}, <{width} x double> poison, <{width} x i32> <{exchanged}>"
    )
    signs = ", ".join(["double -1.0", "double 1.0"] * (width // 2))
    return code.put_value(value.kind, f"fmul {parts.typed}, <{signs}>")


@builtin
def take_products(
    code: Code, rows: Operand, quads: Operand, into: Operand, stride: Operand, a: Operand, a_stride: Operand, b: Operand,
    b_stride: Operand, depth: Operand,
) -> None:  # fmt: skip
    """Compute into[i, :] -= sum of a[k, i] * b[k, :], as `add_products`."""
    _change(code, -1.0, (rows, quads), (into, stride), (a, a_stride), (b, b_stride), depth)


def _kept(code: Code, value: Value) -> Value:
    variable = code.variable(value.kind)
    code.store(variable, value)
    return variable


def _change(
    code: Code, sign: float, shape: tuple[Operand, Operand], into: Lines, a: Lines, b: Lines, depth: Operand
) -> None:
    """Add sums of products times a sign; unrolled for a literal number of terms, else in a loop."""
    rows, quads = map(literal, shape)
    width = QUAD * quads
    places = [code.item(into[0], times(code, into[1], i)).text for i in range(rows)]
    sums = [_kept(code, loaded(code, width, place)) for place in places]

    def add(at_a: Value, at_b: Value) -> None:
        line = loaded(code, width, code.item(b[0], at_b).text)
        for i, total in enumerate(sums):
            number = code.load(code.item(a[0], plus(code, at_a, i)))
            number = number if sign > 0 else code.put_value("float", f"fneg {number.typed}")
            code.store(total, fused(code, code.load(total), spread_over(code, width, number), line))

    if _is_literal(depth):
        for term in range(literal(depth)):
            add(times(code, a[1], term), times(code, b[1], term))
    else:
        _loop(code, add, a[1], b[1], depth)
    for total, place in zip(sums, places, strict=True):
        write(code, place, code.load(total))


def _loop(
    code: Code, add: Callable[[Value, Value], None], a_stride: Operand, b_stride: Operand, depth: Operand
) -> None:
    k, at_a, at_b = (_kept(code, constant(0)) for _ in range(3))
    head, inside, end = code.name("depth"), code.name("product"), code.name("done")
    code.label(head)
    code.choose(code.put_value("bool", f"icmp slt {code.load(k).typed}, {code.integer(depth).text}"), inside, end)
    code.label(inside)
    add(code.load(at_a), code.load(at_b))
    for counter, step in ((k, constant(1)), (at_a, code.integer(a_stride)), (at_b, code.integer(b_stride))):
        code.store(counter, code.put_value("int", f"add nsw {code.load(counter).typed}, {step.text}"))
    code.branch(head)
    code.label(end)


def as_quad(value: Operand) -> Value:
    """Return the operand if it is a four-lane vector."""
    if not isinstance(value, Value) or value.kind != "quad":
        raise Untranslatable(f"found {value}, expected a quad")
    return value


def _is_literal(value: Operand) -> bool:
    return isinstance(value, Value) and value.text.isdigit()


def literal(value: Operand) -> int:
    """Return the value of a literal."""
    if not isinstance(value, Value) or not _is_literal(value):
        raise Untranslatable(f"found {value}, expected a literal")
    return int(value.text)


def plus(code: Code, index: Value, shift: int) -> Value:
    """Return an index plus a literal."""
    return code.put_value("int", f"add nsw {code.integer(index).typed}, {shift}")


def times(code: Code, stride: Operand, count: int) -> Value:
    """Return a multiple of a stride."""
    return code.put_value("int", f"mul nsw {code.integer(stride).typed}, {count}")


def write(code: Code, place: str, value: Value) -> None:
    """Store a vector."""
    code.put(f"store {value.typed}, ptr {place}, align 8")


def loaded(code: Code, width: int, place: str) -> Value:
    """Load four or eight floats."""
    return code.put_value(WIDTHS[width], f"load <{width} x double>, ptr {place}, align 8")


def spread_over(code: Code, width: int, number: Value) -> Value:
    """Broadcast a float to four or eight lanes."""
    one = code.put_value(WIDTHS[width], f"insertelement <{width} x double> poison, {number.typed}, i32 0")
    return code.put_value(
        WIDTHS[width], f"shufflevector {one.typed}, <{width} x double> poison, <{width} x i32> zeroinitializer"
    )


def fused(code: Code, total: Value, a: Value, b: Value) -> Value:
    """Return total + a * b of floats, or of vectors of one width, rounded once."""
    kind = LLVM_TYPES[total.kind]
    name = "llvm.fma." + {"float": "f64", "quad": "v4f64", "octet": "v8f64"}[total.kind]
    code.unit.declare(f"declare {kind} @{name}({kind}, {kind}, {kind})")
    return code.put_value(total.kind, f"call {kind} @{name}({a.typed}, {b.typed}, {total.typed})")


def minus_product(code: Code, total: Value, a: Value, b: Value) -> Value:
    """Return total - a * b of floats, rounded once."""
    return fused(code, total, code.put_value("float", f"fneg {a.typed}"), b)
