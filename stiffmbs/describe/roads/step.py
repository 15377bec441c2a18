"""Step in a road."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import Field

from ..element import Symbolic
from ..units import si
from .road import Road, ramp, ramp_at

if TYPE_CHECKING:
    import numpy as np


class StepRoad(Road):
    """Level road with a rise or fall by a cubic with zero slope at both ends: a kerb, a pothole's edge."""

    kind: ClassVar[str] = "step"

    start: si.Length = Field(description="x where it begins, m")
    length: si.PositiveLength = Field(description="over which it rises, m")
    rise: si.Length = Field(description="height behind it, m; below zero it falls")

    @staticmethod
    def height(r: Symbolic, x: Any, y: Any) -> Any:
        s = ramp(x, r.start, r.length)
        return r.rise * s**2 * (3 - 2 * s)

    def extent(self) -> tuple[float, float]:
        return self.start, self.start + self.length

    def profile_heights(self, x: np.ndarray) -> np.ndarray:
        """Return the heights, m, at positions x, m."""
        s = ramp_at(x, self.start, self.length)
        return self.rise * s**2 * (3 - 2 * s)
