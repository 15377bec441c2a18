"""What a road is: its height, and how much friction there is."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar

from pydantic import Field, model_validator

from ..element import Component, Symbolic
from ..fields import typed
from ..formula.field import FormulaOf
from ..formula.formula import Formula

OF_PLACE = ("x", "y"), ("length", "length")
"""The variables of a road's formulas: along and across, m."""
Factor = Annotated[Formula, FormulaOf(*OF_PLACE, "number", time=False)]


class Road(Component):
    """Base of roads.  A subclass is its fields and its `height`.

    Attributes
    ----------
    kind : str
        What scenes call it, as its `type`.
    level : bool
        Whether its height is the same everywhere.
    """

    kind: ClassVar[str] = ""
    level: ClassVar[bool] = False

    type: str = ""
    friction: Factor | None = Field(None, description="factor on the tyre's friction, of x and y; 1 by default")

    @model_validator(mode="before")
    @classmethod
    def _of_its_kind(cls, found: Any) -> Any:
        """Let the type be the class's kind."""
        return typed(cls.kind, found)

    @staticmethod
    def height(r: Symbolic, x: Any, y: Any) -> Any:
        """The height of the road at x along and y across, m."""
        raise NotImplementedError

    @staticmethod
    def factor(r: Symbolic, x: Any, y: Any) -> Any:
        """The factor on friction there."""
        return 1 if r.friction is None else r.friction(x, y)


def ramp(x: Any, start: Any, length: Any) -> Any:
    """From 0 at the start to 1 a length behind it, straight in between."""
    import sympy

    return sympy.Min(sympy.Max((x - start) / length, 0), 1)


def clipped(s: Any) -> Any:
    """A number between 0 and 1, else the nearer of them, without events: for what has no slope there."""
    from sympy import Rational

    return (magnitude(s) - magnitude(s - 1) + 1) * Rational(1, 2)


def above_zero(x: Any) -> Any:
    """The greater of a number and zero, without an event where it turns round; the number has a name where it is a small sum
    of large parts, or rounding would be that of the parts."""
    from sympy import Rational

    return (x + magnitude(x)) * Rational(1, 2)


def magnitude(x: Any) -> Any:
    """The absolute value, without an event where it turns round."""
    from sympy import Float, sqrt

    return sqrt(x**2 + Float("1e-60"))
