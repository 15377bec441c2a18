"""Notebook representations of models, reports and solutions: tables, and pictures if matplotlib is installed."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape as quoted
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from ..analyses.check import Report
from ..analyses.linearised.modes import Modes
from ..analyses.linearised.modes_table import HEADS, mode_rows
from ..errors import StiffmbsError
from ..model.model_builder import ModelBuilder
from ..model.model_data import ModelData
from ..results.displayed import displayed
from ..results.solution import Solution, channel_ranges
from .escaped import escaped
from .style import data_url

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Sheet

MOST_ROWS = 40
"""Number of rows of a table; further ones are counted."""
MOST_DRAWN = 200
"""Number of bodies and elements up to which a model is drawn by default."""


def html(shown: Any) -> str:
    """Return a model, a report or a solution as HTML, as notebooks show it.

    Parameters
    ----------
    shown : Model, Scene, Report, Modes or Solution

    Returns
    -------
    str
        Tables of the content; with the drawing or the figure if matplotlib is installed.
    """
    if isinstance(shown, Solution):
        return _of_solution(shown)
    if isinstance(shown, Report):
        return _of_report(shown)
    if isinstance(shown, Modes):
        notes = "".join(f"<p>{escape(note)}</p>" for note in shown.notes)
        return _page(shown.name, notes, _table(HEADS, mode_rows(shown.modes)))
    return _of_model(shown)


def _of_model(model: ModelBuilder | ModelData) -> str:
    """Return a model's content by sections, with its drawing as described."""
    sections = {name: getattr(model, name) for name in ("bodies", "joints", "forces")}
    rows = [
        (
            section,
            name,
            getattr(part, "kind", "") or "body",
            ", ".join(str(marker) for end in "ij" if (marker := getattr(part, end, None)) is not None),
        )
        for section, parts in sections.items()
        for name, part in parts.items()
    ]
    return _page(
        model.name or type(model).__name__, _drawing(model, len(rows)), _table(("", "name", "type", "between"), rows)
    )


def _of_report(report: Report) -> str:
    """Return the findings of `stiffmbs.check`."""
    rows = [
        ("degrees of freedom", report.degrees_of_freedom), ("constraint equations", report.equations), ("rank", report.rank),
        ("redundant", ", ".join(f"{joint}.{equation}" for joint, equation in report.redundant) or "none"),
        ("reactions without a unique value", ", ".join(report.not_unique) or "none"),
        ("unknowns", f"{report.unknowns[0]}, solved for {report.unknowns[1]}"),
    ]  # fmt: skip
    sentences = [("", sentence) for sentence in (*report.inconsistencies, *report.presolve, *report.messages)]
    return _page(report.name, "", _table(("", ""), [*rows, *sentences]))


def _of_solution(solution: Solution) -> str:
    """Return the final message of a run, its figure, and the range of every channel."""
    from .figure import drawn

    shown = displayed(solution)
    ranges = channel_ranges(shown)
    rows = [
        (name, shown.unit(name), *(f"{found[key]:.6g}" for key in ("first", "last", "min", "max")))
        for name, found in ranges.items()
    ]
    sentences = "".join(f"<p>{escape(sentence)}</p>" for sentence in (solution.message, *solution.notes))
    drawable = find_spec("matplotlib") is not None and solution.figure is not None and len(solution.time) > 1
    figure = _picture(drawn(solution, solution.figure)) if drawable else ""
    return _page(solution.name, sentences + figure, _table(("channel", "unit", "first", "last", "min", "max"), rows))


def escape(text: str) -> str:
    """Return text escaped for HTML."""
    return quoted(escaped(text))


def _page(title: str, above: str, table: str) -> str:
    return f"<div><b>{escape(title)}</b>{above}{table}</div>"


def _table(heads: Sequence[str], rows: Sequence[Iterable[object]]) -> str:
    lines = ["".join(f"<td>{escape(str(cell))}</td>" for cell in row) for row in rows[:MOST_ROWS]]
    if len(rows) > MOST_ROWS:
        lines.append(f'<td colspan="{len(heads)}">and {len(rows) - MOST_ROWS} more</td>')
    head = "".join(f"<th>{escape(cell)}</th>" for cell in heads)
    return f"<table><tr>{head}</tr>{''.join(f'<tr>{line}</tr>' for line in lines)}</table>"


def _drawing(model: ModelBuilder | ModelData, count: int) -> str:
    """Return a picture of the described model, or an empty string if it cannot be drawn."""
    if find_spec("matplotlib") is None or count > MOST_DRAWN:
        return ""
    from .drawing.draw import state_drawn
    from .drawing.picture import Shown, picture
    from .drawing.view import view_named

    try:
        drawing, poses = state_drawn(model, described=True)
        sheet = picture(drawing, poses, view_named("", drawing.dimensions, drawing.gravity), Shown(True, False))
    except StiffmbsError:  # the model may be incomplete
        return ""
    return _picture(sheet)


def _picture(sheet: Sheet) -> str:
    return f'<br><img alt="" src="{data_url(sheet, "png", 90)}">'
