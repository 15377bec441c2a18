"""Evaluation of tables in kernels."""

from __future__ import annotations

from math import floor

from .access import compiled


@compiled
def spline(number, at, x, order):
    """The order-th derivative of the table at ``number[at]`` (`stiffmbs.compile.kind.spline_data`).

    Outside its points it goes on with the slope of its end, or repeats.
    """
    count = int(number[at])
    knots = at + 2
    first = number[knots]
    last = number[knots + count - 1]
    if number[at + 1] == 1.0:
        x = x - floor((x - first) / (last - first)) * (last - first)
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
    if order == 0:
        return ((a * z + b) * z + c) * z + d + (x - inside) * slope
    if order == 1:
        return slope
    if x != inside:
        return 0.0
    if order == 2:
        return 6.0 * a * z + 2.0 * b
    return 6.0 * a
