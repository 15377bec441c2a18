"""Progress of a command on standard error, on a terminal."""

from __future__ import annotations

import logging
import sys
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Self

from ..show.escaped import console
from .subcommands import LOGGER, is_quiet

if TYPE_CHECKING:
    from rich.progress import Progress


SHOWN_AFTER, BETWEEN_UPDATES = 2.0, 0.1
"""Delay before progress is shown, and least time between updates, s."""
SLOW = "stiffmbs.compile"
"""Package whose stages take seconds."""


class Display:
    """Display on a terminal, which is made on first use and stopped at the end of a ``with`` block."""

    def __init__(self) -> None:
        self._seen = sys.stderr.isatty()
        self._shown: Any = None

    def _started(self, made: Callable[[], object]) -> Any:
        if self._shown is None:
            self._shown = made()
            self._shown.start()
        return self._shown

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self._shown is not None:
            self._shown.stop()


class StatusLine(Display):
    """Status line, called with a line on the progress."""

    def __call__(self, line: str) -> None:
        if self._seen:
            shown = self._started(lambda: console(stderr=True).status(line, refresh_per_second=4))
            shown.update(line)


class CaseBar(Display):
    """Progress bar of a study, called with the numbers of completed and of all cases, and the time left, s."""

    def __call__(self, done: int, total: int, left: float) -> None:
        if self._seen and (self._shown or left >= SHOWN_AFTER):
            self._started(lambda: self._made(total)).update(
                self._task, completed=done, description=f"case {done} of {total}, {left:.0f} s left"
            )

    def _made(self, total: int) -> Any:
        from rich.progress import Progress

        bar = Progress(console=console(stderr=True), transient=True)
        self._task = bar.add_task("solving", total=total)
        return bar


class ProgressBar(Display):
    """Progress bar of a long run: stage, time reached, and time left.

    It is called with the time reached, and listens to the log records of the package for derivation, compilation,
    assembly, and the size and order of steps. `start`, `end`: start and end of the run, s.
    """

    def __init__(self, start: float, end: float) -> None:
        super().__init__()
        self._start, self._end = start, end
        self._begun = self._updated = time.monotonic()
        self._seen = self._seen and not is_quiet()
        self._listener = _Listener(self._tell_stage)
        self._level = logging.NOTSET

    def __call__(self, t: float) -> None:
        if not self._seen:
            return
        now = time.monotonic()
        if now - self._begun < SHOWN_AFTER or now - self._updated < BETWEEN_UPDATES:
            return
        self._updated = now
        reached = f"t = {t:.4g} s{self._listener.step}"
        self._show(reached=reached, after="left", total=self._end - self._start, completed=t - self._start)

    def _tell_stage(self, stage: str, slow: bool) -> None:
        """Show the stages before and between steps; slow ones, as derivation and compilation, at once."""
        if slow or self._shown is not None or time.monotonic() - self._begun > SHOWN_AFTER:
            self._show(description=stage)

    def _show(self, **changed: Any) -> None:
        self._started(lambda: self._made(changed.get("description", "solving"))).update(self._task, **changed)

    def _made(self, stage: str) -> Progress:
        from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeRemainingColumn

        bar = Progress(
            SpinnerColumn(), TextColumn("{task.description}", markup=False), BarColumn(bar_width=24),
            TextColumn("{task.fields[reached]}", markup=False), TimeRemainingColumn(compact=True),
            TextColumn("{task.fields[after]}", markup=False), console=console(stderr=True), transient=True, refresh_per_second=5,
        )  # fmt: skip
        self._task = bar.add_task(stage, total=None, reached="", after="")
        return bar

    def __enter__(self) -> Self:
        if self._seen:
            self._level = LOGGER.level
            LOGGER.addHandler(self._listener)
            LOGGER.setLevel(logging.DEBUG)
        return self

    def __exit__(self, *_: object) -> None:
        if self._seen:
            LOGGER.removeHandler(self._listener)
            LOGGER.setLevel(self._level)
        super().__exit__()


class _Listener(logging.Handler):
    """Handler of log records that calls a function with each stage, and True if it is slow.

    `step`: size and order of the last step, as text after the time; empty if unknown.
    """

    def __init__(self, tell: Callable[[str, bool], None]) -> None:
        super().__init__(logging.DEBUG)
        self._tell, self.step = tell, ""

    def emit(self, record: logging.LogRecord) -> None:
        """Process one record; warnings are printed by another handler."""
        size, order = getattr(record, "step", None), getattr(record, "order", None)
        if size is not None:
            self.step = f", step {size:.2g} s" + (f", order {order}" if order else "")
        elif record.levelno == logging.INFO:
            self._tell(record.getMessage(), record.name.startswith(SLOW))
