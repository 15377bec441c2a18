"""Angles between markers in space, counted over whole turns.

The sine and cosine of an angle tell it up to whole turns.  Which turn it is in, a counter remembers: a coordinate of the
system's own with the angle's rate, which is integrated with all others.  It decides about the turn alone, so that its
own error, far below half a turn, has no part in the angle.
"""

from __future__ import annotations

import sympy as sp


class CountedAngle(sp.Function):  # type: ignore[misc]
    """The angle with a sine and a cosine (or multiples of both) that is nearest to a counter."""

    nargs = 3
    is_real = True

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        sine, cosine, _ = self.args
        squares = sine**2 + cosine**2
        return {1: cosine / squares, 2: -sine / squares, 3: sp.Integer(0)}[argindex]


def counter(k: int) -> sp.Symbol:
    """The symbol of an element's k-th counter."""
    return sp.Symbol(f"counted{k}", real=True)
