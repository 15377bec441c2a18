"""A road by formula."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar

from pydantic import Field

from ..element import Symbolic
from ..formula.field import FormulaOf
from ..formula.formula import Formula
from .road import OF_PLACE, Road

Height = Annotated[Formula, FormulaOf(*OF_PLACE, "length", time=False)]


class FormulaRoad(Road):
    """A road whose height is a formula of x and y.  Breakpoints of its functions are located as events."""

    kind: ClassVar[str] = "formula"

    z: Height = Field(description="height, m, of x along and y across, m")

    @staticmethod
    def height(r: Symbolic, x: Any, y: Any) -> Any:
        return r.z(x, y)
