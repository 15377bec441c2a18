"""Comparisons as text with tables."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from io import StringIO
from typing import TYPE_CHECKING, Any

from ..show.escaped import console as escaping_console
from ..show.summary import UNBROKEN
from .compare import Comparison
from .comparison_over import ComparisonOver
from .measures import MEASURES
from .row import Row

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

BETTER = "*"
"""Mark of a time at which all settings of a solver are more accurate than required."""
BETTER_WORDS = f"{BETTER} more accurate at every setting: the time of the fastest"
INTERRUPTED = "interrupted by the user; what was measured is shown"
BESIDE, FIRST, EACH = 4, 16, 28
"""Number of solvers side by side at most; characters of the first column, and of a solver's."""
Print = Callable[["Console"], None]


def text(comparison: Comparison) -> str:
    """Return the output of `print_comparison`."""
    return _text(partial(print_comparison, comparison))


def text_over(comparison: ComparisonOver) -> str:
    """Return the output of `print_over`."""
    return _text(partial(print_over, comparison))


def _text(show: Print) -> str:
    written = StringIO()
    show(escaping_console(file=written, width=UNBROKEN))
    return written.getvalue().rstrip()


def print_comparison(comparison: Comparison, console: Console) -> None:
    """Print the measurements, times at equal errors, the reference, and the conclusion."""
    say = partial(console.print, highlight=False, markup=False, emoji=False)
    unit = MEASURES[comparison.measure].unit
    say(
        f"{comparison.name or 'model'}: error in {comparison.measure} ({unit}), median time of the integration (ms), steps"
    )
    beside = max(1, min(BESIDE, (console.width - FIRST) // EACH))
    for table in measured_tables(comparison, beside):
        console.print(table)
    for sentence in failures(comparison.rows):
        say(sentence)
    if comparison.at_errors:
        say(f"ms at an error of ({unit}):")
        console.print(at_errors_table(comparison))
        if any(at.better for at in comparison.at_errors):
            say(BETTER_WORDS)
    for sentence in comparison.reference.sentences():
        say(sentence)
    if comparison.interrupted:
        say(INTERRUPTED)
    say(f"conclusion: {comparison.conclusion}")


def print_over(comparison: ComparisonOver, console: Console) -> None:
    """Print times against the parameter, and the crossings of integrators."""
    say = partial(console.print, highlight=False, markup=False, emoji=False)
    unit = MEASURES[comparison.measure].unit
    say(
        f"{comparison.name or 'model'}: median time of the integration (ms) at an error of {comparison.error:g} {unit} in "
        f"{comparison.measure}"
    )
    console.print(over_table(comparison))
    if any(at.better for at in comparison.at if at):
        say(BETTER_WORDS)
    for one in comparison.values:
        if one.message:
            say(f"{comparison.parameter} = {one.value:.4g}: {one.message}")
    if comparison.interrupted:
        say(INTERRUPTED)
    say(f"conclusion: {comparison.conclusion}")


def measured_tables(comparison: Comparison, beside: int) -> Iterator[Table]:
    """Yield tables with a line for each setting and several solvers side by side, grouped by the kind of setting."""
    from rich.table import Table

    of_solver: dict[str, dict[str, Row]] = {}
    for row in comparison.rows:
        of_solver.setdefault(row.solver, {})[row.setting] = row
    resolved = comparison.reference.resolved(comparison.measure)
    for names in _together(of_solver, beside):
        table = Table()
        table.add_column("setting", no_wrap=True)
        for name in names:
            for head in (f"{name}\nerror", "\nms", "\nsteps"):
                table.add_column(head, justify="right", no_wrap=True)
        for setting in dict.fromkeys(setting for name in names for setting in of_solver[name]):
            rows = [of_solver[name].get(setting) for name in names]
            table.add_row(setting, *(cell for row in rows for cell in _cells(row, comparison.measure, resolved)))
        yield table


def _together(of_solver: dict[str, dict[str, Row]], beside: int) -> Iterator[list[str]]:
    """Yield the names of solvers whose rows share a table."""
    kinds: dict[str, list[str]] = {}
    for name, rows in of_solver.items():
        kinds.setdefault(next(iter(rows)).partition(" ")[0], []).append(name)
    for names in kinds.values():
        yield from (names[k : k + beside] for k in range(0, len(names), beside))


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


def at_errors_table(comparison: Comparison) -> Table:
    """Return a table of the time of each solver at each error."""
    heads = [f"{at.error:.0e}" for at in comparison.at_errors]
    names = dict.fromkeys(name for at in comparison.at_errors for name in at.seconds)
    rows = [[name, *(_time(name, at) for at in comparison.at_errors)] for name in names]
    return _table(["solver", *heads], rows)


def over_table(comparison: ComparisonOver) -> Table:
    """Return a table of the time of each solver at each value of the parameter."""
    names = [entry.name for entry in comparison.entries]
    rows = [[f"{one.value:.4g}", *(_time(name, one.at) for name in names)] for one in comparison.values]
    return _table([comparison.parameter, *names], rows)


def _time(name: str, at: Any) -> str:
    if at is None or name not in at.seconds:
        return "-"
    return milliseconds(at.seconds[name]) + BETTER * (name in at.better)


def _table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> Table:
    from rich.table import Table

    table = Table()
    for k, head in enumerate(heads):
        table.add_column(head, justify="right" if k else "left", no_wrap=True)
    for row in rows:
        table.add_row(*row)
    return table


def milliseconds(seconds: float) -> str:
    """Return a time with three digits, ms."""
    return f"{seconds * 1e3:#.3g}".rstrip(".")
