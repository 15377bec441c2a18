"""Angles between markers in space, counted over whole turns.

The sine and cosine of an angle tell it up to whole turns.  Which turn it is in, a counter remembers: a coordinate of the
system's own with the angle's rate, which is integrated with all others.  It decides about the turn alone, so that its
own error, far below half a turn, has no part in the angle.
"""

from __future__ import annotations

from typing import Any

import sympy as sp

POLE = sp.Float(1e-4)
"""Sine squared plus cosine squared below which an angle has no direction to speak of (an axis within 0.6 deg of the one that
it turns about): no step is to be spent on the half turn that the angle makes there at any speed."""


class ContinuousAngle(sp.Function):  # type: ignore[misc]
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


def angle_rate(angle: ContinuousAngle, e: Any) -> sp.Expr:
    """The rate of a counter: that of its angle, (c s' - s c')/(s^2 + c^2), bounded where s and c both vanish.

    The eighth power leaves the rate as it is outside of the pole: half a turn too much or too little, gathered over any number
    of turns, would put the angle in a wrong one.

    Parameters
    ----------
    angle : ContinuousAngle
    e : SymbolicElement
    """
    sine, cosine, _ = angle.args
    squares = e.named(sine**2 + cosine**2)
    return (cosine * e.rate(sine) - sine * e.rate(cosine)) * squares**7 / (squares**8 + POLE**8)
