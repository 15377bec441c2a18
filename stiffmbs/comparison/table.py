"""Comparisons as text with tables, and as a section of a report."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from io import StringIO
from typing import TYPE_CHECKING, Any

from ..show.escaped import console as escaping_console
from ..show.force_table import rich_table
from ..show.sections import Section
from ..show.sections import Table as Cells
from ..show.summary import UNBROKEN
from .at_error import Row
from .compare import Comparison
from .comparison_over import ComparisonOver
from .measures import MEASURES

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

BETTER = "*"
"""Mark of a time at which all settings of a solver are more accurate than required."""
NO_TIME = "-"
BETTER_WORDS = f"{BETTER} more accurate at every setting: the time of the fastest"
COLUMNS, FIRST, EACH = 4, 16, 28
"""Number of solvers side by side at most; characters of the first column, and of a solver's."""
Say = Callable[[str], None]


def text(comparison: Comparison | ComparisonOver) -> str:
    """Return the output of `show`."""
    written = StringIO()
    show(comparison, escaping_console(file=written, width=UNBROKEN))
    return written.getvalue().rstrip()


def show(comparison: Comparison | ComparisonOver, console: Console) -> None:
    """Print the measurements or the times against the parameter, and the conclusion."""
    say = partial(console.print, highlight=False, markup=False, emoji=False)
    if isinstance(comparison, Comparison):
        _show_measured(comparison, console, say)
    else:
        _show_over(comparison, console, say)
    if comparison.interrupted:
        say("interrupted by the user; what was measured is shown")
    say(f"conclusion: {comparison.conclusion}")


def _show_measured(comparison: Comparison, console: Console, say: Say) -> None:
    unit = MEASURES[comparison.measure].unit
    say(
        f"{comparison.name or 'model'}: error in {comparison.measure} ({unit}), median time of the integration (ms), steps"
    )
    columns = max(1, min(COLUMNS, (console.width - FIRST) // EACH))
    for table in measured_tables(comparison, columns):
        console.print(table)
    for sentence in failures(comparison.rows):
        say(sentence)
    if comparison.at_errors:
        say(f"ms at an error of ({unit}):")
        heads, rows = _at_errors(comparison)
        console.print(rich_table(heads, *rows))
        if any(at.better for at in comparison.at_errors):
            say(BETTER_WORDS)
    for sentence in comparison.reference.sentences():
        say(sentence)


def _show_over(comparison: ComparisonOver, console: Console, say: Say) -> None:
    unit = MEASURES[comparison.measure].unit
    say(
        f"{comparison.name or 'model'}: median time of the integration (ms) at an error of {comparison.error:g} {unit} in "
        f"{comparison.measure}"
    )
    names = [entry.name for entry in comparison.entries]
    rows = [[f"{one.value:.4g}", *(_time(name, one.at) for name in names)] for one in comparison.values]
    console.print(rich_table([comparison.parameter, *names], *rows))
    if any(at.better for at in comparison.at if at):
        say(BETTER_WORDS)
    for one in comparison.values:
        if one.message:
            say(f"{comparison.parameter} = {one.value:.4g}: {one.message}")


def measured_tables(comparison: Comparison, columns: int) -> Iterator[Table]:
    """Yield tables with a line for each setting and several solvers side by side, grouped by the kind of setting."""
    of_solver: dict[str, dict[str, Row]] = {}
    for row in comparison.rows:
        of_solver.setdefault(row.solver, {})[row.setting] = row
    resolved = comparison.reference.resolved(comparison.measure)
    for names in _together(of_solver, columns):
        lines = [["setting", *(head for name in names for head in (f"{name}\nerror", "\nms", "\nsteps"))]]
        for setting in dict.fromkeys(setting for name in names for setting in of_solver[name]):
            rows = [of_solver[name].get(setting) for name in names]
            lines.append([setting, *(cell for row in rows for cell in _cells(row, comparison.measure, resolved))])
        yield rich_table(*lines)


def _together(of_solver: dict[str, dict[str, Row]], columns: int) -> Iterator[list[str]]:
    """Yield the names of solvers whose rows share a table."""
    kinds: dict[str, list[str]] = {}
    for name, rows in of_solver.items():
        kinds.setdefault(next(iter(rows)).partition(" ")[0], []).append(name)
    for names in kinds.values():
        yield from (names[k : k + columns] for k in range(0, len(names), columns))


def _cells(row: Row | None, measure: str, resolved: float) -> list[str]:
    if row is None:
        return ["", "", ""]
    if row.message:
        return ["failed", "-", str(row.steps)]
    error = row.errors[measure]
    return [f"{error:.1e}" if error > resolved else f"< {resolved:.0e}", milliseconds(row.seconds), str(row.steps)]


def failures(rows: Sequence[Row]) -> Iterator[str]:
    """Yield a sentence for each row that failed."""
    for row in rows:
        if row.message:
            yield f"{row.solver}, {row.setting}: {row.message}"


def _at_errors(comparison: Comparison) -> tuple[list[str], list[list[str]]]:
    """Return heads and rows of a table of the time of each solver at each error."""
    heads = [f"{at.error:.0e}" for at in comparison.at_errors]
    names = dict.fromkeys(name for at in comparison.at_errors for name in at.seconds)
    return ["solver", *heads], [[name, *(_time(name, at) for at in comparison.at_errors)] for name in names]


def comparison_section(comparison: Comparison) -> Section:
    """Return a report section with times at equal errors, the reference, the conclusion, and the figure."""
    heads, rows = _at_errors(comparison)
    sentences = [
        f"Median times of the integration, ms, by the error in {comparison.measure}.",
        *([BETTER_WORDS] if any(one.better for one in comparison.at_errors) else []),
        *comparison.reference.sentences(), *failures(comparison.rows), comparison.conclusion,
    ]  # fmt: skip
    cells = tuple(tuple("" if cell == NO_TIME else cell for cell in row) for row in rows)
    return Section("Solvers compared", tuple(sentences), (Cells(tuple(heads), cells),), (comparison.plot(),))


def _time(name: str, at: Any) -> str:
    if at is None or name not in at.seconds:
        return NO_TIME
    return milliseconds(at.seconds[name]) + BETTER * (name in at.better)


def milliseconds(seconds: float) -> str:
    """Return a time with three digits, ms."""
    return f"{seconds * 1e3:#.3g}".rstrip(".")
