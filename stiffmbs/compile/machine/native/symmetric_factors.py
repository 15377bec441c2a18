"""L D L^T of the small blocks of J M^-1 J^T, and solutions with them, in registers."""

from __future__ import annotations

from ..translate.code import Code, constant
from ..translate.values import Operand, Value, builtin
from .simd import QUAD, fused, literal, loaded, minus_product, plus, spread, spread_over, times, write


@builtin
def factor_symmetric(code: Code, size: Operand, block: Operand, stride: Operand, pivots: Operand) -> None:
    """Factor a symmetric matrix (lower triangle, literal size) as L D L^T with 1/D on the diagonal; store D."""
    n = literal(size)
    places = _lower(code, n, block, stride)
    a = {at: code.load(place) for at, place in places.items()}
    for k in range(n):
        code.store(code.item(pivots, constant(k)), a[k, k])
        inverse = code.put_value("float", f"fdiv double 1.0, {a[k, k].text}")
        for i in range(k + 1, n):
            factor = code.put_value("float", f"fmul {a[i, k].typed}, {inverse.text}")
            for j in range(k + 1, i + 1):
                a[i, j] = minus_product(code, a[i, j], factor, a[j, k])
            code.store(places[i, k], factor)
        code.store(places[k, k], inverse)


@builtin
def eliminate_node(
    code: Code, size: Operand, quads: Operand, block: Operand, stride: Operand, pivots: Operand, scaled: Operand, x: Operand,
    y: Operand,
) -> None:  # fmt: skip
    """Factor a block as `factor_symmetric`, and compute L^-1 and D^-1 L^-1 times x and the rows right of the block.

    The rows start after the block's width, rounded up to whole SIMD vectors. Their length in SIMD vectors, `quads`, and
    the size are literals.
    """
    n, parts = literal(size), literal(quads)
    own = QUAD * -(-n // QUAD)
    width = 2 * QUAD if parts % 2 == 0 else QUAD
    shifts = range(0, QUAD * parts, width)
    places = _lower(code, n, block, stride)
    a = {at: code.load(place) for at, place in places.items()}
    begins = [times(code, stride, k) for k in range(n)]
    lines = [[code.item(block, plus(code, begin, own + shift)).text for shift in shifts] for begin in begins]
    rows = [[loaded(code, width, place) for place in line] for line in lines]
    value = [code.load(code.item(x, constant(k))) for k in range(n)]
    following: Value | None = None
    for k in range(n):
        code.store(code.item(pivots, constant(k)), a[k, k])
        inverse = following or _inverse(code, a[k, k])
        following = None if following or k + 1 == n else _next_inverse(code, a[k, k], a[k + 1, k], a[k + 1, k + 1])
        for i in range(k + 1, n):
            factor = code.put_value("float", f"fmul {a[i, k].typed}, {inverse.text}")
            for j in range(k + 1, i + 1):
                a[i, j] = minus_product(code, a[i, j], factor, a[j, k])
            minus = code.put_value("float", f"fneg {factor.typed}")
            many = spread_over(code, width, minus)
            rows[i] = [fused(code, row, many, above) for row, above in zip(rows[i], rows[k], strict=True)]
            value[i] = fused(code, value[i], minus, value[k])
            code.store(places[i, k], factor)
        code.store(places[k, k], inverse)
        many = spread_over(code, width, inverse)
        for shift, place, row in zip(shifts, lines[k], rows[k], strict=True):
            write(code, place, row)
            multiplied = code.put_value(row.kind, f"fmul {row.typed}, {many.text}")
            write(code, code.item(scaled, constant(QUAD * parts * k + shift)).text, multiplied)
        code.store(code.item(x, constant(k)), value[k])
        code.store(code.item(y, constant(k)), code.put_value("float", f"fmul {value[k].typed}, {inverse.text}"))


@builtin
def eliminate_rows(
    code: Code, size: Operand, block: Operand, stride: Operand, rows: Operand, scaled: Operand, scaled_stride: Operand
) -> None:
    """Compute rows = L^-1 rows and scaled = D^-1 L^-1 rows, four columns wide, with a literal size."""
    n = literal(size)
    factors = {at: code.load(place) for at, place in _lower(code, n, block, stride).items()}
    places, own = (_places(code, n, *lines) for lines in ((rows, stride), (scaled, scaled_stride)))
    line = [loaded(code, QUAD, place) for place in places]
    for k in range(n):
        for i in range(k + 1, n):
            minus = code.put_value("float", f"fneg {factors[i, k].typed}")
            line[i] = fused(code, line[i], spread.lower(code, minus), line[k])
    for k in range(n):
        write(code, places[k], line[k])
        inverse = spread.lower(code, factors[k, k])
        write(code, own[k], code.put_value("quad", f"fmul {line[k].typed}, {inverse.text}"))


@builtin
def eliminate_vector(code: Code, size: Operand, block: Operand, stride: Operand, x: Operand, scaled: Operand) -> None:
    """Compute x = L^-1 x and scaled = D^-1 L^-1 x. The size is a literal."""
    n = literal(size)
    factors = {at: code.load(place) for at, place in _lower(code, n, block, stride).items()}
    value = [code.load(code.item(x, constant(k))) for k in range(n)]
    for k in range(n):
        for i in range(k + 1, n):
            value[i] = minus_product(code, value[i], factors[i, k], value[k])
    for k in range(n):
        code.store(code.item(x, constant(k)), value[k])
        code.store(
            code.item(scaled, constant(k)), code.put_value("float", f"fmul {value[k].typed}, {factors[k, k].text}")
        )


@builtin
def complete_vector(code: Code, size: Operand, block: Operand, stride: Operand, x: Operand) -> None:
    """Compute x = L^-T x. The size is a literal."""
    n = literal(size)
    factors = {at: code.load(place) for at, place in _lower(code, n, block, stride).items()}
    value = [code.load(code.item(x, constant(k))) for k in range(n)]
    for k in reversed(range(n)):
        for i in range(k):
            value[i] = minus_product(code, value[i], factors[k, i], value[k])
        code.store(code.item(x, constant(k)), value[k])


def _inverse(code: Code, number: Value) -> Value:
    return code.put_value("float", f"fdiv double 1.0, {number.text}")


def _next_inverse(code: Code, pivot: Value, off_diagonal: Value, diagonal: Value) -> Value:
    """Return the inverse of the next pivot from a 2 x 2 determinant, so that both divisions run in parallel."""
    product = code.put_value("float", f"fmul {pivot.typed}, {diagonal.text}")
    inverse = _inverse(code, minus_product(code, product, off_diagonal, off_diagonal))
    return code.put_value("float", f"fmul {pivot.typed}, {inverse.text}")


def _places(code: Code, rows: int, into: Operand, stride: Operand) -> list[str]:
    """Return the places of SIMD vectors in some rows."""
    return [code.item(into, times(code, stride, i)).text for i in range(rows)]


def _lower(code: Code, size: int, block: Operand, stride: Operand) -> dict[tuple[int, int], Value]:
    """Return the places of a block's lower triangle."""
    return {(i, j): code.item(block, plus(code, times(code, stride, i), j)) for i in range(size) for j in range(i + 1)}
