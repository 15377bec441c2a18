"""Four floats side by side, which a processor multiplies and adds at once.

Every machine gives the same numbers: products are added with one rounding, in an order that is written down here.
"""

from __future__ import annotations

from collections.abc import Callable

from ..translate.code import Code, constant
from ..translate.values import Operand, Untranslatable, Value, builtin

QUAD = 4
"""Floats of a quad."""
Lines = tuple[Operand, Operand]
"""Where lines of numbers begin, and how far they are apart."""


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
def quad_of(code: Code, *numbers: Operand) -> Value:
    """Four floats side by side."""
    found = Value("quad", "poison")
    for k, number in enumerate(numbers):
        one = code.converted(number, "float")
        found = code.put_value("quad", f"insertelement {found.typed}, {one.typed}, i32 {k}")
    return found


@builtin
def item_of(code: Code, value: Operand, index: Operand) -> Value:
    """One of four floats; the index is a literal."""
    return code.put_value("float", f"extractelement {_quad(value).typed}, i32 {_literal(index)}")


@builtin
def nearest_whole(code: Code, value: Operand) -> Value:
    """The whole numbers next to four floats."""
    code.unit.declare("declare <4 x double> @llvm.rint.v4f64(<4 x double>)")
    return code.put_value("quad", f"call <4 x double> @llvm.rint.v4f64({_quad(value).typed})")


@builtin
def product_of(code: Code, a: Operand, b: Operand) -> Value:
    """a * b."""
    return code.put_value("quad", f"fmul {_quad(a).typed}, {_quad(b).text}")


@builtin
def plus_product(code: Code, total: Operand, a: Operand, b: Operand) -> Value:
    """total + a * b of quads, or of floats, rounded once."""
    if isinstance(total, Value) and total.kind == "float":
        return _plus_product_of_floats(code, total, *(code.converted(factor, "float") for factor in (a, b)))
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

    The sums stay in registers.  Strides are those of rows of `into`, and of k in `a` and `b`.  A literal depth is written
    out without a loop.
    """
    _change(code, 1.0, (rows, quads), (into, stride), (a, a_stride), (b, b_stride), depth)


@builtin
def take_products(
    code: Code, rows: Operand, quads: Operand, into: Operand, stride: Operand, a: Operand, a_stride: Operand, b: Operand,
    b_stride: Operand, depth: Operand,
) -> None:  # fmt: skip
    """into[i, :] -= sum of a[k, i] * b[k, :], as `add_products`."""
    _change(code, -1.0, (rows, quads), (into, stride), (a, a_stride), (b, b_stride), depth)


@builtin
def factor_symmetric(code: Code, size: Operand, block: Operand, stride: Operand, pivots: Operand) -> None:
    """L D L^T of a symmetric matrix in its lower triangle, 1/D on the diagonal; writes the pivots D.  The size is a literal."""
    n = _literal(size)
    places = _lower(code, n, block, stride)
    a = {at: code.load(place) for at, place in places.items()}
    for k in range(n):
        code.store(code.item(pivots, constant(k)), a[k, k])
        inverse = code.put_value("float", f"fdiv double 1.0, {a[k, k].text}")
        for i in range(k + 1, n):
            factor = code.put_value("float", f"fmul {a[i, k].typed}, {inverse.text}")
            for j in range(k + 1, i + 1):
                a[i, j] = _minus_product(code, a[i, j], factor, a[j, k])
            code.store(places[i, k], factor)
        code.store(places[k, k], inverse)


@builtin
def eliminate_rows(
    code: Code, size: Operand, block: Operand, stride: Operand, rows: Operand, scaled: Operand, scaled_stride: Operand
) -> None:
    """rows = L^-1 rows, and scaled = D^-1 L^-1 rows, a quad wide; `rows` have the stride of the factors.  The size is a literal."""
    n = _literal(size)
    factors = {at: code.load(place) for at, place in _lower(code, n, block, stride).items()}
    places, own = (_places(code, n, 1, *lines) for lines in ((rows, stride), (scaled, scaled_stride)))
    line = [_loaded(code, place) for place in places]
    for k in range(n):
        for i in range(k + 1, n):
            minus = code.put_value("float", f"fneg {factors[i, k].typed}")
            line[i] = _plus_product(code, line[i], spread.lower(code, minus), line[k])
    for k in range(n):
        _store(code, places[k], line[k])
        inverse = spread.lower(code, factors[k, k])
        _store(code, own[k], code.put_value("quad", f"fmul {line[k].typed}, {inverse.text}"))


@builtin
def eliminate_vector(code: Code, size: Operand, block: Operand, stride: Operand, x: Operand, scaled: Operand) -> None:
    """x = L^-1 x, and scaled = D^-1 L^-1 x.  The size is a literal."""
    n = _literal(size)
    factors = {at: code.load(place) for at, place in _lower(code, n, block, stride).items()}
    value = [code.load(code.item(x, constant(k))) for k in range(n)]
    for k in range(n):
        for i in range(k + 1, n):
            value[i] = _minus_product(code, value[i], factors[i, k], value[k])
    for k in range(n):
        code.store(code.item(x, constant(k)), value[k])
        code.store(
            code.item(scaled, constant(k)), code.put_value("float", f"fmul {value[k].typed}, {factors[k, k].text}")
        )


@builtin
def complete_vector(code: Code, size: Operand, block: Operand, stride: Operand, x: Operand) -> None:
    """x = L^-T x.  The size is a literal."""
    n = _literal(size)
    factors = {at: code.load(place) for at, place in _lower(code, n, block, stride).items()}
    value = [code.load(code.item(x, constant(k))) for k in range(n)]
    for k in reversed(range(n)):
        for i in range(k):
            value[i] = _minus_product(code, value[i], factors[k, i], value[k])
        code.store(code.item(x, constant(k)), value[k])


def _lower(code: Code, size: int, block: Operand, stride: Operand) -> dict[tuple[int, int], Value]:
    """The places of a block's lower triangle."""
    return {
        (i, j): code.item(block, _sum(code, _product(code, stride, i), j)) for i in range(size) for j in range(i + 1)
    }


def _places(code: Code, rows: int, quads: int, into: Operand, stride: Operand) -> list[str]:
    """Of the quads of some rows."""
    return [
        code.item(into, _sum(code, _product(code, stride, i), 4 * j)).text for i in range(rows) for j in range(quads)
    ]


def _kept(code: Code, value: Value) -> Value:
    """A variable with a value."""
    variable = code.variable(value.kind)
    code.store(variable, value)
    return variable


def _change(
    code: Code, sign: float, shape: tuple[Operand, Operand], into: Lines, a: Lines, b: Lines, depth: Operand
) -> None:
    """Add sums of products, times a sign: their terms written out one by one where the number is a literal, else in a loop."""
    rows, quads = map(_literal, shape)
    places = _places(code, rows, quads, *into)
    sums = [_kept(code, _loaded(code, place)) for place in places]

    def add(at_a: Value, at_b: Value) -> None:
        columns = [_loaded(code, code.item(b[0], _sum(code, at_b, 4 * j)).text) for j in range(quads)]
        for i in range(rows):
            number = code.load(code.item(a[0], _sum(code, at_a, i)))
            number = number if sign > 0 else code.put_value("float", f"fneg {number.typed}")
            factor = spread.lower(code, number)
            for j in range(quads):
                total = sums[i * quads + j]
                code.store(total, _plus_product(code, code.load(total), factor, columns[j]))

    if _is_literal(depth):
        for term in range(_literal(depth)):
            add(_product(code, a[1], term), _product(code, b[1], term))
    else:
        _loop(code, add, a[1], b[1], depth)
    for total, place in zip(sums, places, strict=True):
        _store(code, place, code.load(total))


def _loop(
    code: Code, add: Callable[[Value, Value], None], a_stride: Operand, b_stride: Operand, depth: Operand
) -> None:
    """So many terms."""
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


def _quad(value: Operand) -> Value:
    if not isinstance(value, Value) or value.kind != "quad":
        raise Untranslatable(f"found {value}, expected a quad")
    return value


def _is_literal(value: Operand) -> bool:
    return isinstance(value, Value) and value.text.isdigit()


def _literal(value: Operand) -> int:
    if not isinstance(value, Value) or not _is_literal(value):
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


def _plus_product_of_floats(code: Code, total: Value, a: Value, b: Value) -> Value:
    code.unit.declare("declare double @llvm.fma.f64(double, double, double)")
    return code.put_value("float", f"call double @llvm.fma.f64({a.typed}, {b.typed}, {total.typed})")


def _minus_product(code: Code, total: Value, a: Value, b: Value) -> Value:
    """total - a * b of floats, rounded once."""
    return _plus_product_of_floats(code, total, code.put_value("float", f"fneg {a.typed}"), b)
