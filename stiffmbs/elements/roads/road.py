"""Base of roads: height and friction factor."""

from __future__ import annotations

import ast
from types import SimpleNamespace
from typing import Annotated, Any, ClassVar

import numpy as np
from pydantic import Field, PrivateAttr, model_validator

from ...reading.fields import typed
from ...reading.formula.field import FormulaOf
from ...reading.formula.formula import Formula
from ...reading.formula.value import formula_value
from ...reading.table import Table
from ...reading.units import si
from ..element import Component, Expr, Symbolic, sp
from .rolling_filter import Cam

OF_PLACE = ("x", "y"), ("length", "length")
"""Variables of a road's formulas with dimensions: along and across, m."""
Factor = Annotated[Formula, FormulaOf(*OF_PLACE, "number", time=False)]


class Road(Component):
    """Base of roads; a subclass consists of its fields and its `height`.

    Attributes
    ----------
    kind : str
        Name of the kind in scenes, its `type`.
    level : bool
        Whether its height is constant.
    """

    kind: ClassVar[str] = ""
    level: ClassVar[bool] = False

    rolled: ClassVar[Table | None] = None

    type: str = ""
    friction: Factor | None = Field(None, description="factor on the tyre's friction, of x and y; 1 by default")
    filter_radius: si.PositiveLength | None = Field(
        None, description="radius of a rolling disc that filters the heights of the road, m; by default no filter"
    )

    _cam: Cam | None = PrivateAttr(None)

    @model_validator(mode="before")
    @classmethod
    def _of_its_kind(cls, found: object) -> object:
        return typed(cls.kind, found)

    @model_validator(mode="after")
    def _may_be_filtered(self) -> Road:
        if self.filter_radius is not None and not self.level and self.extent() is None:
            raise ValueError(
                f"found filter_radius on a road '{self.kind}' without an extent, expected a road with one, such as a table"
            )
        return self

    @model_validator(mode="after")
    def _has_friction(self) -> Road:
        """Refuse a friction factor below zero, if it is the same everywhere."""
        if self.friction is not None:
            used = {node.id for node in ast.walk(self.friction.tree) if isinstance(node, ast.Name)}
            if used.isdisjoint((*OF_PLACE[0], *self.friction.tables)) and (factor := formula_value(self.friction)) < 0:
                raise ValueError(f"friction: found {factor:g}, expected zero or a positive number")
        return self

    def extent(self) -> tuple[float, float] | None:
        """Return the interval of x, m, outside which the road is straight, for the rolling-radius filter, or None."""
        return None

    def profile_heights(self, x: np.ndarray) -> np.ndarray:
        """Return the heights, m, at positions x, m, for the rolling-radius filter; they are independent of y.

        By default they are those of `height`, which then has to take arrays.
        """
        return self._of_equation(x, 0.0 * x)

    def heights(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Return the unfiltered heights, m, at points along and across the road, m, for drawings.

        Raises
        ------
        NotImplementedError
            If `height` does not take arrays, and there are no `profile_heights`.
        """
        if type(self).profile_heights is Road.profile_heights:
            return self._of_equation(x, y)
        return self.profile_heights(x.ravel()).reshape(x.shape)

    def _of_equation(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Return the unfiltered heights by `height`, with functions of arrays for tables and formulas."""
        from .rolling_filter import of_arrays

        plain = self.model_copy(update={"filter_radius": None})
        plain._cam = None
        r = SimpleNamespace(**{name: of_arrays(value) for name, value in plain.in_equations().items()})
        try:
            return np.broadcast_to(np.asarray(self.height(r, x, y), dtype=float), x.shape)
        except (AttributeError, TypeError, ValueError):  # of a function of symbols
            raise NotImplementedError from None

    def in_equations(self) -> dict[str, object]:
        """Return its fields, and with `filter_radius` the table ``rolled`` of filtered heights."""
        own = dict(super().in_equations())
        del own["filter_radius"]
        shape, extent = self.filter_shape, self.extent()
        if shape is None or extent is None:
            return own
        from .rolling_filter import rolled_profile

        return {**own, "rolled": rolled_profile(self.profile_heights, extent, shape)}

    @property
    def filter_shape(self) -> float | Cam | None:
        """Disc or cam whose heights the equations have, or None for those of the road."""
        return self._cam or self.filter_radius

    def under_cams(self, cam: Cam) -> Road:
        """Return the road with the heights that a cam rolls on, instead of those of `filter_radius`.

        Raises
        ------
        ValueError
            If the road has no extent.
        """
        if self.level:
            return self
        if self.extent() is None:
            raise ValueError(f"found a road '{self.kind}' without an extent, expected a road with one, such as a table")
        road = self.model_copy()
        road._cam = cam
        return road

    @staticmethod
    def height(r: Symbolic, x: Expr, y: Expr) -> Expr:
        """Return the height of the road at x along and y across, m."""
        raise NotImplementedError

    @staticmethod
    def place(r: Symbolic, e: Symbolic, x: Expr, y: Expr) -> tuple[Expr, Expr]:
        """Return the position of a point along and across the road, m; e is the element on the road."""
        return x, y

    @staticmethod
    def surface(r: Symbolic, x: Expr, y: Expr) -> Expr:
        """Return the height for a wheel, m, filtered if the road has a filter."""
        return r.height(x, y) if r.rolled is None else r.rolled(x)

    @staticmethod
    def factor(r: Symbolic, x: Expr, y: Expr) -> Expr:
        """Return the factor on friction."""
        return 1 if r.friction is None else r.friction(x, y)


def functions_of(x: Any) -> Any:
    """Return the module with the functions of x: of NumPy for arrays, of SymPy for symbols."""
    from importlib import import_module

    return import_module("numpy" if hasattr(x, "clip") else "sympy")


def ramp(x: Expr, start: Expr, length: Expr) -> Expr:
    """Return a linear ramp from 0 at `start` to 1 at `start` + `length`, constant outside; x may be an array."""
    s = (x - start) / length
    if hasattr(s, "clip"):
        return s.clip(0.0, 1.0)
    return sp.Min(sp.Max(s, 0), 1)


def clipped(s: Expr) -> Expr:
    """Return s limited to 0 .. 1 without events, for functions with zero slope at the limits; s may be an array."""
    return s.clip(0.0, 1.0) if hasattr(s, "clip") else (magnitude(s) - magnitude(s - 1) + 1) / 2


def above_zero(x: Expr) -> Expr:
    """Return max(x, 0) without an event at zero.

    Name x before if it is a small sum of large terms, because rounding errors would be those of the terms.
    """
    return (x + magnitude(x)) * sp.Rational(1, 2)


def magnitude(*parts: Expr) -> Expr:
    """Return the absolute value of a number, or the magnitude of a vector, without an event at zero."""
    return sp.sqrt(sum(part**2 for part in parts) + sp.Float("1e-60"))


class FlatRoad(Road):
    """Level road."""

    kind = "flat"
    level = True

    z: si.Length = Field(0.0, description="height, m")

    @staticmethod
    def height(r: Symbolic, x: Expr, y: Expr) -> Expr:
        return r.z
