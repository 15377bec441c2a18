"""Angles between markers in space, counted over whole turns.

The sine and cosine of an angle tell it up to whole turns.  Which turn it is in, a counter remembers: a coordinate of the
system's own with the angle's rate, which is integrated with all others.  It decides about the turn alone, so that its
own error, far below half a turn, has no part in the angle.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import sympy as sp

from .nonsmooth import Inside, Less

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


def away_from_pole(angle: ContinuousAngle, e: Any) -> Callable[[sp.Expr], sp.Expr]:
    """What makes the rate of a counter, and its derivatives, of those of its angle: they are bounded where s and c both vanish.

    Outside of the pole the rate stays as it is: half a turn too much or too little, gathered over any number of turns, would
    put the angle in a wrong one.  Derivatives are those of the angle's rate, times the same: within the pole they tell less,
    where nothing but the turn follows from a counter.

    Parameters
    ----------
    angle : ContinuousAngle
    e : SymbolicElement
    """
    sine, cosine, _ = angle.args
    part = e.named(Less(sp.Integer(1), (sine**2 + cosine**2) / POLE))
    return lambda x: Inside(part, sp.Integer(0), sp.Integer(2), x * part)
