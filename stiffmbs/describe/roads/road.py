"""What a road is: its height, and how much friction there is."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from pydantic import Field, model_validator

from ..element import Component, Symbolic
from ..fields import typed
from ..formula.field import FormulaOf
from ..formula.formula import Formula
from ..table import Table
from ..units import si

if TYPE_CHECKING:
    import numpy as np

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

    rolled: ClassVar[Table | None] = None

    type: str = ""
    friction: Factor | None = Field(None, description="factor on the tyre's friction, of x and y; 1 by default")
    filter_radius: si.PositiveLength | None = Field(
        None, description="of a disc, m: the heights are those that it rolls on; those of the road by default"
    )

    @model_validator(mode="before")
    @classmethod
    def _of_its_kind(cls, found: Any) -> Any:
        """Let the type be the class's kind."""
        return typed(cls.kind, found)

    @model_validator(mode="after")
    def _may_be_filtered(self) -> Road:
        if self.filter_radius is not None and not self.level and self.extent() is None:
            raise ValueError(
                f"found filter_radius on a road '{self.kind}' without an extent, expected a road that states one"
            )
        return self

    def extent(self) -> tuple[float, float] | None:
        """The stretch of x, m, outside which the road goes on straight, for the rolling-radius filter; None: no such one."""
        return None

    def profile_heights(self, x: np.ndarray) -> np.ndarray:
        """Its heights, m, at places x, m, the same for all y, for the rolling-radius filter."""
        raise NotImplementedError

    def in_equations(self) -> dict[str, Any]:
        """Its fields, and with `filter_radius` the table ``rolled`` of the heights that a disc rolls on."""
        own = dict(super().in_equations())
        radius, extent = own.pop("filter_radius"), self.extent()
        if radius is None or extent is None:
            return own
        from .rolling_filter import rolled_profile

        return {**own, "rolled": rolled_profile(self.profile_heights, extent, radius)}

    @staticmethod
    def height(r: Symbolic, x: Any, y: Any) -> Any:
        """The height of the road at x along and y across, m."""
        raise NotImplementedError

    @staticmethod
    def place(r: Symbolic, e: Symbolic, x: Any, y: Any) -> tuple[Any, Any]:
        """How far along and across the road a point is, m; e is the element that is on the road."""
        return x, y

    @staticmethod
    def surface(r: Symbolic, x: Any, y: Any) -> Any:
        """The height that a wheel sees there, m: through the filter where the road has one."""
        return r.height(x, y) if r.rolled is None else r.rolled(x)

    @staticmethod
    def factor(r: Symbolic, x: Any, y: Any) -> Any:
        """The factor on friction there."""
        return 1 if r.friction is None else r.friction(x, y)


def ramp_at(x: np.ndarray, start: float, length: float) -> np.ndarray:
    """`ramp` of numbers."""
    return ((x - start) / length).clip(0.0, 1.0)


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
