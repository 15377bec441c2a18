"""Evaluation of tables in kernels."""

from math import floor
from typing import Final

from .access import compiled

REPEATS: Final = 1.0
HOLDS: Final = 2.0
"""End codes of tables (`stiffmbs.compile.table_values`)."""


@compiled
def _area(number, first_piece, knots, pieces):
    """Return the integral over the first pieces of a table."""
    area = 0.0
    for k in range(pieces):
        piece = first_piece + 4 * k
        h = number[knots + k + 1] - number[knots + k]
        area += _piece_area(number, piece, h)
    return area


@compiled
def _piece_area(number, piece, z):
    """Return the integral of one piece from its start to z."""
    a, b, c, d = number[piece], number[piece + 1], number[piece + 2], number[piece + 3]
    return (((a / 4.0 * z + b / 3.0) * z + c / 2.0) * z + d) * z


@compiled
def spline(number, at, x, order):
    """Return the order-th derivative of the table at ``number[at]``, or its integral from the first point for order -1.

    The data are those of `stiffmbs.compile.table_values.spline_data`; outside its points the table keeps its
    slope or its value, or is periodic.
    """
    count = int(number[at])
    knots = at + 2
    first = number[knots]
    last = number[knots + count - 1]
    turns = 0.0
    if number[at + 1] == REPEATS:
        turns = floor((x - first) / (last - first))
        x = x - turns * (last - first)
    low = 0
    high = count - 2
    while low < high:
        middle = (low + high + 1) // 2
        if x >= number[knots + middle]:
            low = middle
        else:
            high = middle - 1
    piece = knots + count + 4 * low
    a, b, c, d = number[piece], number[piece + 1], number[piece + 2], number[piece + 3]
    inside = min(max(x, first), last)
    z = inside - number[knots + low]
    slope = (3.0 * a * z + 2.0 * b) * z + c
    value = ((a * z + b) * z + c) * z + d
    if number[at + 1] == HOLDS and x != inside:
        slope = 0.0
    if order == 0:
        return value + (x - inside) * slope
    if order == -1:
        begin = knots + count
        area = turns * _area(number, begin, knots, count - 1) + _area(number, begin, knots, low)
        return area + _piece_area(number, piece, z) + (x - inside) * (value + (x - inside) / 2.0 * slope)
    if order == 1:
        return slope
    if x != inside:
        return 0.0
    if order == 2:
        return 6.0 * a * z + 2.0 * b
    return 6.0 * a
