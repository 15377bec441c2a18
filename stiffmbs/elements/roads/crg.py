"""Road by a curved regular grid (OpenCRG)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, PrivateAttr, model_validator

from ...errors import InputError, prefixed
from ...reading.table import Table
from ..element import Expr, Symbolic
from ..read_by import in_file
from .crg_grid import CrgGrid, read_crg
from .grid import between_lines
from .reference_line import ReferenceLine, nearest, reference_line
from .road import Road
from .rolling_filter import table_of, through_filter

MOST_SECTIONS, MOST_HEIGHTS = 32, 400_000
"""Largest number of long sections, and of heights on all of them, in the equations."""
STRAIGHT = 1e-9
"""Largest departure of a straight reference line from its direction, m."""
LEVEL = 3
"""Number of points before and after the road that keep it level there."""


AnyCrg = Annotated[
    CrgGrid, in_file(CrgGrid, read_crg, "the name of an OpenCRG file, relative to the folder of the file that names it")
]


class CrgRoad(Road):
    """Road by an OpenCRG file (.crg): heights along a straight or curved reference line, with slope and banking.

    The height is interpolated by monotone cubics (PCHIP) along each long section, and linearly between two sections; it
    is constant beyond the road. If the file has more long sections than `sections`, that number of equally spaced ones
    is used, and a note reports it. The line may turn by up to 80 deg from its mean direction.

    ASAM OpenCRG 1.2, user manual.
    """

    kind = "crg"

    file: AnyCrg = Field(description="the name of an OpenCRG file, relative to the folder of the file that names it")
    placed: Literal["origin", "file"] = Field(
        "origin",
        description="whether the road begins at the origin along x (OpenCRG's default), or at the position in the file",
    )
    sections: int = Field(
        MOST_SECTIONS, ge=2, le=MOST_SECTIONS, description="largest number of long sections that are used"
    )

    _line: ReferenceLine | None = PrivateAttr(None)

    @model_validator(mode="after")
    def _of_bounded_size(self) -> CrgRoad:
        count = len(self.file.u) * len(self._columns)
        if count > MOST_HEIGHTS:
            raise ValueError(
                f"found {count} heights, {len(self.file.u)} on each of {len(self._columns)} long sections, expected at most "
                f"{MOST_HEIGHTS}: use fewer sections, or cut the road"
            )
        with prefixed("", InputError, ValueError):
            self._line = self._reference_line()
        return self

    @property
    def _columns(self) -> np.ndarray:
        count = len(self.file.v)
        return np.unique(np.round(np.linspace(0, count - 1, min(count, self.sections))).astype(int))

    def _at_its_place(self) -> tuple[np.ndarray, np.ndarray, float]:
        """Return x and y of the reference line, m, and the reference level of heights, m."""
        x, y = self.file.x, self.file.y
        if self.placed == "file":
            return x, y, 0.0
        c, s = np.cos(self.file.heading), np.sin(self.file.heading)
        x, y = x - x[0], y - y[0]
        return c * x + s * y, c * y - s * x, self.file.level

    def _reference_line(self) -> ReferenceLine | None:
        """Return the reference line if it is curved."""
        x, y, _ = self._at_its_place()
        c, s = self._direction()
        across = (y - y[0]) * c - (x - x[0]) * s
        if np.abs(across).max() <= STRAIGHT:
            return None
        return reference_line(self.file.u, x, y, self.file.v, self.file.path)

    def _direction(self) -> tuple[float, float]:
        import math

        heading = 0.0 if self.placed == "origin" else self.file.heading
        return math.cos(heading), math.sin(heading)

    def notes(self) -> Iterator[str]:
        """Yield notes on unused long sections, and remarks of the reader."""
        used, count = len(self._columns), len(self.file.v)
        if used < count:
            yield f"{used} of the {count} long sections of {self.file.path} are used"
        yield from self.file.remarks

    def extent(self) -> tuple[float, float]:
        return float(self.file.u[0]), float(self.file.u[-1])

    def in_equations(self) -> dict[str, object]:
        """Return the tables of its long sections, filtered with `filter_radius`, and its reference line."""
        x, y, level = self._at_its_place()
        columns = self._columns
        tables = tuple(
            through_filter(_section(self.file.u, self.file.heights[:, k] - level), self.filter_shape) for k in columns
        )
        own = {"friction": self.friction, "lines": tables, "across": tuple(self.file.v[columns].tolist())}
        if self._line is not None:
            return {**own, **self._line.in_equations()}
        return {
            **own,
            "guess": None,
            "direction": self._direction(),
            "start": (float(x[0]), float(y[0]), float(self.file.u[0])),
        }

    def surface_points(self, most: int) -> np.ndarray:
        """Return points of the road for drawings, m, shape (along, across, 3), at most as many along as given."""
        x, y, level = self._at_its_place()
        step = max(1, -(-len(x) // most))
        turn = np.unwrap(np.arctan2(np.gradient(y), np.gradient(x)))[::step]
        columns = self._columns
        v = np.asarray(self.file.v)[columns]
        z = self.file.heights[::step][:, columns] - level
        return np.stack(
            [x[::step, None] - v * np.sin(turn)[:, None], y[::step, None] + v * np.cos(turn)[:, None], z], axis=-1
        )

    @staticmethod
    def place(r: Symbolic, e: Symbolic, x: Expr, y: Expr) -> tuple[Expr, Expr]:
        """Return u and v of the point."""
        if r.guess is not None:
            return nearest(r, e, x, y)
        (c, s), (x0, y0, u0) = r.direction, r.start
        return e.named((x - x0) * c + (y - y0) * s + u0), e.named((y - y0) * c - (x - x0) * s)

    @staticmethod
    def height(r: Symbolic, x: Expr, y: Expr) -> Expr:
        return between_lines(r, x, y)


def _section(u: np.ndarray, heights: np.ndarray) -> Table:
    """Return the heights of a long section, constant beyond its ends."""
    outside = (u[1] - u[0]) * np.arange(1, LEVEL + 1)
    at = np.concatenate([u[0] - outside[::-1], u, u[-1] + outside])
    z = np.concatenate([np.full(LEVEL, heights[0]), heights, np.full(LEVEL, heights[-1])])
    return table_of(at, z)
