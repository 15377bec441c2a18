"""Road by a file of heights on a grid."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from pydantic import Field

from ...errors import InputError
from ...reading.files.text_file import file_text, finite_number, lines
from ...reading.table import Table
from ..element import Expr, Symbolic
from ..read_by import in_file
from .road import Road, clipped
from .rolling_filter import through_filter

MOST_LINES = 32
"""Largest number of lines along the road; each is a table in the equations."""


@dataclass(frozen=True)
class Grid:
    """Heights over x, m: one table for each y, m, in increasing order."""

    across: tuple[float, ...]
    tables: tuple[Table, ...]


def read_grid(path: Path) -> Grid:
    """Read a file of heights.

    The first row of numbers has the positions y across the road, each further row a position x along it and the heights
    there. All are in m, separated by blanks, commas or semicolons; text after # is a comment. Raises InputError if it
    cannot be read; the message contains the line.
    """
    rows = list(_rows(file_text(path, expected="a grid of heights"), str(path)))
    if len(rows) < 3:
        raise InputError(
            f"{path}: found {len(rows)} rows of numbers, expected one of y and two or more of x and heights"
        )
    (first, across), *heights = rows
    if not 2 <= len(across) <= MOST_LINES:
        raise InputError(f"{path}, line {first}: found {len(across)} positions y, expected 2 to {MOST_LINES}")
    _refuse_disorder([(first, y) for y in across], "y", path)
    for number, row in heights:
        if len(row) != len(across) + 1:
            raise InputError(
                f"{path}, line {number}: found {len(row)} numbers, expected x and {len(across)} heights, one for each y"
            )
    _refuse_disorder([(number, row[0]) for number, row in heights], "x", path)
    tables = (tuple((row[0], row[1 + k]) for _, row in heights) for k in range(len(across)))
    return Grid(across, tuple(Table(table=table) for table in tables))


def _rows(text: str, source: str) -> Iterator[tuple[int, tuple[float, ...]]]:
    for number, line in enumerate(lines(text), start=1):
        content = line.partition("#")[0].strip()
        words = filter(None, re.split(r"[\s,;]+", content))
        if content:
            yield number, tuple(finite_number(word, f"{source}, line {number}") for word in words)


def _refuse_disorder(found: list[tuple[int, float]], name: str, path: Path) -> None:
    for (_, before), (number, after) in itertools.pairwise(found):
        if not after > before:
            raise InputError(
                f"{path}, line {number}: found {name} = {after:g} after {before:g}, expected increasing positions"
            )


AnyGrid = Annotated[
    Grid, in_file(Grid, read_grid, "the name of a file of heights, relative to the folder of the file that names it")
]


class GridRoad(Road):
    """Road with heights on a grid in a file: the first row has y, each further row has x and the heights there, in m.

    The height is interpolated by monotone cubics (PCHIP) along each line, and linearly between two lines. It is
    constant beyond the first and the last line, and extrapolated with the end slopes beyond both ends.
    """

    kind = "grid"

    file: AnyGrid = Field(description="the name of a file of heights, relative to the folder of the file that names it")

    def extent(self) -> tuple[float, float]:
        points = self.file.tables[0].table
        return points[0][0], points[-1][0]

    def in_equations(self) -> dict[str, object]:
        """Return its tables along x, filtered with `filter_radius`, and their positions y."""
        tables = tuple(through_filter(table, self.filter_shape) for table in self.file.tables)
        return {"friction": self.friction, "lines": tables, "across": self.file.across}

    @staticmethod
    def height(r: Symbolic, x: Expr, y: Expr) -> Expr:
        return between_lines(r, x, y)


def between_lines(r: Symbolic, x: Expr, y: Expr) -> Expr:
    """Return the height of a road with tables `lines` at positions `across`, interpolated linearly between them."""
    heights = [line(x) for line in r.lines]
    height = heights[0]
    for k in range(1, len(heights)):
        part = clipped((y - r.across[k - 1]) / (r.across[k] - r.across[k - 1]))
        height = height + (heights[k] - heights[k - 1]) * part
    return height
