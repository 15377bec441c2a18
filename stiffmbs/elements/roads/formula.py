"""Road by a formula."""

from __future__ import annotations

import ast
from typing import Annotated

from pydantic import Field, model_validator

from ...reading.formula.field import FormulaOf
from ...reading.formula.formula import Formula
from ...reading.units import si
from ..element import Expr, Symbolic
from .road import OF_PLACE, Road

Height = Annotated[Formula, FormulaOf(*OF_PLACE, "length", time=False)]


class FormulaRoad(Road):
    """Road with a formula of x and y for its height; breakpoints of its functions are located as events.

    With `filter_radius` the formula is of x alone, and the filter applies between `first` and `last`.
    """

    kind = "formula"

    z: Height = Field(description="height, m: a formula of x along and y across the road, m")
    first: si.Length | None = Field(None, description="x at the start of the interval for the filter, m")
    last: si.Length | None = Field(None, description="x at the end of this interval, m")

    @model_validator(mode="after")
    def _may_be_filtered(self) -> FormulaRoad:
        if (self.first is None or self.last is None) != (self.filter_radius is None):
            raise ValueError("found only some of first, last and filter_radius, expected all three or none")
        if self.first is not None and self.last is not None and not self.first < self.last:
            raise ValueError(f"found last = {self.last:g} m, expected it after first = {self.first:g} m")
        names = {node.id for node in ast.walk(self.z.tree) if isinstance(node, ast.Name)}
        if self.filter_radius is not None and "y" in names:
            raise ValueError("found y in the formula of a road with filter_radius, expected a formula of x only")
        return self

    def extent(self) -> tuple[float, float] | None:
        return None if self.first is None or self.last is None else (self.first, self.last)

    @staticmethod
    def height(r: Symbolic, x: Expr, y: Expr) -> Expr:
        return r.z(x, y)
