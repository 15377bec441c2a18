"""Cosine bump in a road."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import Field

from ..element import Symbolic
from ..units import si
from .road import Road, ramp, ramp_at

if TYPE_CHECKING:
    import numpy as np


class CosineBump(Road):
    """Level road with one bump: crest (1 - cos(2 pi (x - start)/length))/2."""

    kind: ClassVar[str] = "cosine_bump"

    start: si.Length = Field(description="x where it begins, m")
    length: si.PositiveLength = Field(description="of the bump, m")
    crest: si.Length = Field(description="its height in the middle, m; below zero it is a hole")

    @staticmethod
    def height(r: Symbolic, x: Any, y: Any) -> Any:
        from sympy import Rational, cos, pi

        return r.crest * (1 - cos(2 * pi * ramp(x, r.start, r.length))) * Rational(1, 2)

    def extent(self) -> tuple[float, float]:
        return self.start, self.start + self.length

    def profile_heights(self, x: np.ndarray) -> np.ndarray:
        """Return the heights, m, at positions x, m."""
        from numpy import cos, pi

        return self.crest * (1 - cos(2 * pi * ramp_at(x, self.start, self.length))) / 2
