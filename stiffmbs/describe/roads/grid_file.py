"""Files of heights on a grid: x in the first column, y in the first row."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo
from pydantic_core import core_schema

from ...errors import InputError
from ..files.files_read import file_beside
from ..files.quoted import quoted, written
from ..files.text_file import file_text, lines
from ..table import Table

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
    there.
    All are in m, separated by blanks, commas or semicolons; text after # is a comment.

    Raises
    ------
    InputError
        If it cannot be read; the message contains the line.
    """
    rows = list(_rows(file_text(path), str(path)))
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
        if content:
            yield (
                number,
                tuple(_number(part, f"{source}, line {number}") for part in re.split(r"[\s,;]+", content) if part),
            )


def _number(text: str, where: str) -> float:
    try:
        value = float(text)
    except ValueError:
        raise InputError(f"{where}: found '{quoted(text)}', expected a number") from None
    if not math.isfinite(value):
        raise InputError(f"{where}: found '{quoted(text)}', expected a finite number")
    return value


def _refuse_disorder(found: list[tuple[int, float]], name: str, path: Path) -> None:
    for (_, before), (number, after) in itertools.pairwise(found):
        if not after > before:
            raise InputError(
                f"{path}, line {number}: found {name} = {after:g} after {before:g}, expected increasing positions"
            )


class _GridField:
    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> Any:
        def read(found: object, info: ValidationInfo) -> Grid:
            return _read(found, info.context or {})

        return core_schema.with_info_plain_validator_function(read)

    def __get_pydantic_json_schema__(self, schema: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return {"type": "string", "description": "the name of a file of heights, beside the scene"}


def _read(found: object, context: Mapping[str, Any]) -> Grid:
    if isinstance(found, Grid):
        return found
    if not isinstance(found, str | Path):
        raise ValueError(f"found {written(found)}, expected the name of a file")
    try:
        return read_grid(file_beside(context, found))
    except InputError as error:
        raise ValueError(str(error)) from None


AnyGrid = Annotated[Grid, _GridField()]
