"""What shows on standard error, on a terminal, that a command is at work."""

from __future__ import annotations

import sys
import time
from types import TracebackType
from typing import Any

PATIENCE = 2.0
BETWEEN_UPDATES = 0.1


class ProgressBar:
    """Called with the time reached; shows a bar when the run takes long and someone can see it.

    Parameters
    ----------
    start, end : float
        Of the run, s.
    """

    def __init__(self, start: float, end: float) -> None:
        self._start, self._end = start, end
        self._begun = self._shown = time.monotonic()
        self._seen = sys.stderr.isatty()
        self._bar: Any = None
        self._task: Any = None

    def __call__(self, t: float) -> None:
        if not self._seen:
            return
        now = time.monotonic()
        if now - self._begun < PATIENCE or now - self._shown < BETWEEN_UPDATES:
            return
        self._shown = now
        if self._bar is None:
            from rich.console import Console
            from rich.progress import Progress

            self._bar = Progress(console=Console(stderr=True), transient=True)
            self._bar.start()
            self._task = self._bar.add_task("solving", total=self._end - self._start)
        self._bar.update(self._task, completed=t - self._start)

    def __enter__(self) -> ProgressBar:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._bar is not None:
            self._bar.stop()


class Telling:
    """Called with a line on what is being done; shows the last one while someone can see it."""

    def __init__(self) -> None:
        self._seen = sys.stderr.isatty()
        self._status: Any = None

    def __call__(self, line: str) -> None:
        if not self._seen:
            return
        if self._status is None:
            from rich.console import Console

            console = Console(stderr=True, markup=False, emoji=False)
            self._status = console.status(line, refresh_per_second=4)
            self._status.start()
        self._status.update(line)

    def __enter__(self) -> Telling:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._status is not None:
            self._status.stop()
