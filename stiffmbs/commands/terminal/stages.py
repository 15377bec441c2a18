"""The line on a terminal for a run: what is done, how far it is, and how long it will take."""

from __future__ import annotations

from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeRemainingColumn

from ...show.escaped import console


def bar() -> Progress:
    """A line that goes away in the end; a task in it has the fields ``reached`` and ``after``, what follows the time left."""
    return Progress(
        SpinnerColumn(),
        TextColumn("{task.description}", markup=False),
        BarColumn(bar_width=24),
        TextColumn("{task.fields[reached]}", markup=False),
        TimeRemainingColumn(compact=True),
        TextColumn("{task.fields[after]}", markup=False),
        console=console(stderr=True),
        transient=True,
        refresh_per_second=5,
    )
