"""Road by a file of heights on a grid."""

from __future__ import annotations

from typing import Any, ClassVar

from pydantic import Field

from ..element import Symbolic
from .grid_file import AnyGrid
from .road import Road, clipped
from .rolling_filter import through_filter


class GridRoad(Road):
    """Road with heights on a grid in a file: the first row has y, each further row has x and the heights there, in m.

    The height is interpolated by monotone cubics (PCHIP) along each line, and linearly between two lines. It is
    constant beyond the first and the last line, and extrapolated with the end slopes beyond both ends.
    """

    kind: ClassVar[str] = "grid"

    file: AnyGrid = Field(description="the name of a file of heights, beside the scene")

    def extent(self) -> tuple[float, float]:
        points = self.file.tables[0].table
        return points[0][0], points[-1][0]

    def in_equations(self) -> dict[str, Any]:
        """Return its tables along x, filtered with `filter_radius`, and their positions y."""
        tables = tuple(through_filter(table, self.filter_radius) for table in self.file.tables)
        return {"friction": self.friction, "lines": tables, "across": self.file.across}

    @staticmethod
    def height(r: Symbolic, x: Any, y: Any) -> Any:
        return between_lines(r, x, y)


def between_lines(r: Symbolic, x: Any, y: Any) -> Any:
    """Return the height of a road with tables `lines` at positions `across`, interpolated linearly between them."""
    heights = [line(x) for line in r.lines]
    height = heights[0]
    for k in range(1, len(heights)):
        part = clipped((y - r.across[k - 1]) / (r.across[k] - r.across[k - 1]))
        height = height + (heights[k] - heights[k - 1]) * part
    return height
