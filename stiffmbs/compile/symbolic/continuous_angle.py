"""Continuous (unwrapped) angles between spatial markers.

Sine and cosine define an angle up to whole turns. A turn counter selects the turn: a coordinate of the system with the
angle's rate, which is integrated with the others. Its own integration error does not enter the angle.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import sympy as sp

from .nonsmooth import Inside, Less

if TYPE_CHECKING:
    from .element import SymbolicElement

POLE = sp.Float(1e-4)
"""Sine squared plus cosine squared below which an angle has no direction (an axis within 0.6 deg of the rotation axis);
the half turn made there must cost no steps."""


class ContinuousAngle(sp.Function):  # type: ignore[misc]
    """Angle with a given sine and cosine (or multiples of both) that is nearest to a counter."""

    is_real = True

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        sine, cosine, _ = self.args
        squares = sine**2 + cosine**2
        return {1: cosine / squares, 2: -sine / squares, 3: sp.Integer(0)}[argindex]


def counter(k: int) -> sp.Symbol:
    """Return the symbol of an element's k-th counter."""
    return sp.Symbol(f"counted{k}", real=True)


def away_from_pole(angle: ContinuousAngle, e: SymbolicElement) -> Callable[[sp.Expr], sp.Expr]:
    """Return a function that bounds the rate of an angle, and its derivatives, for use as a counter's rate.

    The rate is unchanged except near the pole, where sine and cosine both vanish. There the derivatives are
    approximate, which is acceptable because only the number of turns depends on the counter.
    """
    sine, cosine, _ = angle.args
    part = e.named(Less(sp.Integer(1), (sine**2 + cosine**2) / POLE))
    return lambda x: Inside(part, sp.Integer(0), sp.Integer(2), x * part)
