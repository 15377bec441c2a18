"""Channels over time for other programs: MATLAB (.mat), Excel (.xlsx) and Parquet (.parquet), with units and origin."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import InputError
from ..reading.ascii import in_ascii
from ..reading.files.quoted import quoted

if TYPE_CHECKING:
    from .solution import Solution


@dataclass(frozen=True)
class Limits:
    """Limits of formats.

    Source: MATLAB's `namelengthmax`; Microsoft, Excel specifications and limits.
    """

    name: int = 63
    """Characters of a variable of MATLAB."""
    rows: int = 1_048_576
    """Rows of a sheet of Excel."""
    columns: int = 16_384
    """Columns of a sheet of Excel."""
    cell: int = 32_767
    """Characters of a cell of Excel."""


LIMITS = Limits()


def about(solution: Solution) -> dict[str, str]:
    """Return the name and outcome of a run, and the origin of its results, as texts."""
    texts = {"title": solution.name, "outcome": solution.outcome.name, "message": str(solution.message)}
    return texts | (solution.provenance.as_texts() if solution.provenance else {})


def variable_names(channels: list[str]) -> list[str]:
    """Return a name for each channel that MATLAB accepts: ASCII letters, digits and ``_``, a letter first, all different."""
    found: dict[str, None] = {"time": None, "about": None, "channels": None}
    for channel in channels:
        letters = "".join(letter if letter.isalnum() else "_" for letter in in_ascii(channel))
        whole = letters if letters[:1].isalpha() else f"x{letters}"
        name, number = whole[: LIMITS.name], 1
        while name in found:
            number += 1
            name = f"{whole[: LIMITS.name - 1 - len(str(number))]}_{number}"
        found[name] = None
    return list(found)[3:]


def write_matlab(path: Path, solution: Solution) -> None:
    """Write a MAT file (version 5).

    Each channel is a column under its name with ``_`` for dots; ``channels`` has the variable, channel, unit and uniqueness of
    each, and ``about`` the origin.
    """
    from scipy.io import savemat

    names = variable_names(list(solution.channels))
    columns = dict(zip(names, solution.channels.values(), strict=True))
    listed = [
        (variable, channel, solution.unit(channel) or "", float(channel not in solution.not_unique))
        for variable, channel in zip(names, solution.channels, strict=True)
    ]
    fields = [(name, object) for name in ("variable", "channel", "unit", "unique")]
    content: dict[str, Any] = {"time": solution.time, **columns}
    content |= {"channels": np.array(listed, dtype=fields)[:, None], "about": about(solution)}
    savemat(path, content, long_field_names=True, oned_as="column", do_compression=True)


def write_excel(path: Path, solution: Solution) -> None:
    """Write a workbook: sheet ``results`` with rows of names and units before the values, and ``about`` with the origin.

    Values that are not finite are empty cells. Raises an InputError if a sheet cannot have so many rows or columns.
    """
    columns = (solution.time, *solution.channels.values())
    rows = len(solution.time) + 2
    if rows > LIMITS.rows or len(columns) > LIMITS.columns:
        raise InputError(
            f"{quoted(path.suffix)}: found {rows} rows and {len(columns)} columns, expected at most {LIMITS.rows} and {LIMITS.columns}; "
            "use .parquet or .csv"
        )
    from openpyxl import Workbook

    book = Workbook(write_only=True)
    sheet = book.create_sheet("results")
    sheet.freeze_panes = "B3"
    sheet.append(["time", *solution.channels])
    sheet.append(["s", *(solution.unit(name) or "" for name in solution.channels)])
    for row in np.column_stack(columns):
        sheet.append([value if abs(value) < np.inf else None for value in row.tolist()])
    origin = book.create_sheet("about")
    for name, text in (about(solution) | {"not unique": "\n".join(solution.not_unique)}).items():
        origin.append([name, *_cells(text)])
    book.save(path)


def _cells(text: str) -> list[str]:
    """Return a text in parts that fit into cells."""
    return [text[first : first + LIMITS.cell] for first in range(0, len(text), LIMITS.cell)]


def write_parquet(path: Path, solution: Solution) -> None:
    """Write a table of Parquet; each column has its unit and uniqueness as metadata, the table the origin."""
    import pyarrow
    from pyarrow import parquet

    columns = {"time": solution.time, **solution.channels}
    fields = [
        pyarrow.field(
            name, pyarrow.float64(),
            metadata={"unit": "s" if name == "time" else solution.unit(name) or "", "unique": str(name not in solution.not_unique)},
        )
        for name in columns
    ]  # fmt: skip
    table = pyarrow.table(
        [np.asarray(values, dtype=float) for values in columns.values()],
        schema=pyarrow.schema(fields, metadata=about(solution)),
    )
    parquet.write_table(table, path)
