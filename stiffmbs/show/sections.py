"""Sections of a report, and that of the differences of two runs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..model.scene import Figure
from ..results.listings import Difference, differences
from ..results.scales import ROUNDING
from ..results.solution import Solution
from .figure import SIZE, draw_runs
from .style import new_sheet

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Sheet


@dataclass(frozen=True)
class Table:
    """Table: heads of columns, and rows of cells."""

    heads: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


@dataclass(frozen=True)
class Section:
    """Section: a title, sentences, tables, and figures of matplotlib."""

    title: str
    sentences: tuple[str, ...]
    tables: tuple[Table, ...] = ()
    figures: tuple[Sheet, ...] = ()


MOST_ROWS, MOST_FIGURES = 15, 3
"""Numbers of channels that are listed and drawn, those with the largest relative differences first."""


def differences_section(solution: Solution, name: str, other: Solution) -> Section:
    """Return the largest differences of a run from another one.

    `name`: name of the other run. Raises InputError if the runs have no channels or times in common.
    """
    found = sorted(differences(solution, other), key=lambda one: -np.nan_to_num(one.relative))
    unequal = [one for one in found if one.relative > ROUNDING]
    only = [
        f"{len(names)} channels are in {where} alone, such as {names[0]}."
        for where, names in (
            ("this run", [c for c in solution.channels if c not in other.channels]),
            (name, [c for c in other.channels if c not in solution.channels]),
        )
        if names
    ]
    head = f"{len(unequal)} of {len(found)} common channels differ from {name} by more than {ROUNDING:g} of their largest value."
    rows = tuple(_row(one, solution, other) for one in unequal[:MOST_ROWS])
    heads = ("channel", "unit", "largest difference", "relative", "at (s)", "this run", name)
    sheets = []
    for one in unequal[:MOST_FIGURES]:
        sheet = new_sheet(SIZE, False)
        draw_runs(sheet, {"this run": solution, name: other}, Figure(title=one.channel, y=(one.channel,)))
        sheets.append(sheet)
    return Section(f"Differences from {name}", (head, *only), (Table(heads, rows),) if rows else (), tuple(sheets))


def _row(one: Difference, solution: Solution, other: Solution) -> tuple[str, ...]:
    values = (np.interp(one.t, run.time, run.channels[one.channel]) for run in (solution, other))
    return (
        one.channel, solution.unit(one.channel), f"{one.largest:.4g}", f"{one.relative:.2g}", f"{one.t:.6g}",
        *(f"{value:.6g}" for value in values),
    )  # fmt: skip
