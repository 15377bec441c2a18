"""Progress line of a run on a terminal: stage, time reached, and time left."""

from __future__ import annotations

from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeRemainingColumn

from ...show.escaped import console


def bar() -> Progress:
    """Return a transient progress bar; tasks have the fields ``reached`` and ``after`` (text after the time left)."""
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
