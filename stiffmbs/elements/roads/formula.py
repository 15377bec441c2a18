"""Road by a formula."""

from __future__ import annotations

import ast
from functools import partial
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field, model_validator

from ...reading.formula.field import FormulaOf
from ...reading.formula.formula import Formula
from ...reading.units import si
from ..element import Symbolic
from .road import OF_PLACE, Road

if TYPE_CHECKING:
    import numpy as np

Height = Annotated[Formula, FormulaOf(*OF_PLACE, "length", time=False)]


class FormulaRoad(Road):
    """Road with a formula of x and y for its height; breakpoints of its functions are located as events.

    With `filter_radius` the formula is of x alone, and the filter applies between `first` and `last`.
    """

    kind = "formula"

    z: Height = Field(description="height, m, of x along and y across, m")
    first: si.Length | None = Field(None, description="x where the stretch for the filter begins, m")
    last: si.Length | None = Field(None, description="x where it ends, m")

    @model_validator(mode="after")
    def _may_be_filtered(self) -> FormulaRoad:
        if (self.first is None or self.last is None) != (self.filter_radius is None):
            raise ValueError("found some of first, last and filter_radius, expected all three or none")
        if self.first is not None and self.last is not None and not self.first < self.last:
            raise ValueError(f"found last = {self.last:g} m, expected it behind first = {self.first:g} m")
        names = {node.id for node in ast.walk(self.z.tree) if isinstance(node, ast.Name)}
        if self.filter_radius is not None and "y" in names:
            raise ValueError("found y in the formula of a road with filter_radius, expected a formula of x alone")
        return self

    def extent(self) -> tuple[float, float] | None:
        return None if self.first is None or self.last is None else (self.first, self.last)

    def profile_heights(self, x: np.ndarray) -> np.ndarray:
        """Return the heights, m, of the formula at positions x, m."""
        return self.heights(x, 0.0 * x)

    def heights(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Return the heights, m, of the formula."""
        from numpy import broadcast_to

        from ...reading.formula.functions import IN_FORMULAS
        from ...reading.formula.text import evaluate
        from .rolling_filter import heights_of

        functions = {name: function.array for name, function in IN_FORMULAS.items()}
        tables = {name: partial(heights_of, table) for name, table in self.z.tables.items()}
        found = evaluate(self.z.tree, {**self.z.values, "x": x, "y": y}.__getitem__, {**functions, **tables})
        return broadcast_to(found, x.shape)

    @staticmethod
    def height(r: Symbolic, x: Any, y: Any) -> Any:
        return r.z(x, y)
