"""Products of three columns of J with entries in all rows of a joint, computed in registers."""

from __future__ import annotations

from ..translate.code import Code, constant
from ..translate.values import Operand, Value, builtin
from .simd import QUAD, fused, literal, loaded, plus, spread, sum_of, times, write

COLUMNS = range(3)


@builtin
def add_rows(
    code: Code, rows: Operand, values: Operand, source: Operand, scale: Operand, j: Operand, x: Operand, a: Operand,
    block: Operand, stride: Operand,
) -> None:  # fmt: skip
    """Compute j = scaled columns of J, x += j a, and the lower triangle of block += j j^T.

    `source` holds the position of the three entries of each row among the values; `scale` and `a` belong to the three
    columns. The number of rows is a literal. SIMD padding of j and x is zero; that of the block is undefined.
    """
    n = literal(rows)
    places = [code.load(code.item(source, constant(row))) for row in range(n)]
    roots = [code.load(code.item(scale, constant(column))) for column in COLUMNS]
    entries = [
        [
            code.put_value("float", f"fmul {code.load(code.item(values, plus(code, place, column))).typed}, {roots[column].text}")
            for column in COLUMNS
        ]
        for place in places
    ]  # fmt: skip
    lines = [
        [_line(code, [row[column] for row in entries[at : at + QUAD]]) for at in range(0, n, QUAD)]
        for column in COLUMNS
    ]
    forces = [spread.lower(code, code.load(code.item(a, constant(column)))) for column in COLUMNS]
    width = QUAD * len(lines[0])
    for part in range(len(lines[0])):
        place = code.item(x, constant(QUAD * part)).text
        total = loaded(code, QUAD, place)
        for column in COLUMNS:
            total = fused(code, total, forces[column], lines[column][part])
            write(code, code.item(j, constant(column * width + QUAD * part)).text, lines[column][part])
        write(code, place, total)
    for row, own in enumerate(entries):
        factors = [spread.lower(code, entry) for entry in own]
        begin = times(code, stride, row)
        for part in range(row // QUAD + 1):
            place = code.item(block, plus(code, begin, QUAD * part)).text
            total = loaded(code, QUAD, place)
            for column in COLUMNS:
                total = fused(code, total, factors[column], lines[column][part])
            write(code, place, total)


@builtin
def take_rows(code: Code, rows: Operand, j: Operand, x: Operand, a: Operand) -> None:
    """Compute a -= j^T x for three columns; the number of rows is a literal."""
    parts = -(-literal(rows) // QUAD)
    lines = [loaded(code, QUAD, code.item(x, constant(QUAD * part)).text) for part in range(parts)]
    for column in COLUMNS:
        total: Value | None = None
        for part, line in enumerate(lines):
            own = loaded(code, QUAD, code.item(j, constant(QUAD * (parts * column + part))).text)
            total = fused(code, total, own, line) if total else code.put_value("quad", f"fmul {own.typed}, {line.text}")
        place = code.item(a, constant(column))
        before = code.load(place)
        code.store(place, code.put_value("float", f"fsub {before.typed}, {sum_of.lower(code, total).text}"))


def _line(code: Code, numbers: list[Value]) -> Value:
    """Return a vector of up to four numbers, padded with zeros."""
    line = Value("quad", "zeroinitializer")
    for k, number in enumerate(numbers):
        line = code.put_value("quad", f"insertelement {line.typed}, {number.typed}, i32 {k}")
    return line
