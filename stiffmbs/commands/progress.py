"""Progress of a command on standard error, on a terminal."""

from __future__ import annotations

import sys
import time
from types import TracebackType
from typing import Any

from ..show.escaped import console
from .terminal.listener import Listener
from .terminal.logging_options import is_quiet

SHOWN_AFTER, BETWEEN_UPDATES = 2.0, 0.1
"""Delay before progress is shown, and least time between updates, s."""


class ProgressBar:
    """Progress bar of a long run on a terminal, called with the time reached.

    As a context manager it listens to the log records of the package: derivation, compilation, assembly, and the size
    and order of steps.

    Parameters
    ----------
    start, end : float
        Start and end of the run, s.
    """

    def __init__(self, start: float, end: float) -> None:
        self._start, self._end = start, end
        self._begun = self._shown = time.monotonic()
        self._seen = sys.stderr.isatty() and not is_quiet()
        self._listener = Listener(self._tell_stage) if self._seen else None
        self._bar: Any = None
        self._task: Any = None

    def __call__(self, t: float) -> None:
        if not self._seen:
            return
        now = time.monotonic()
        if now - self._begun < SHOWN_AFTER or now - self._shown < BETWEEN_UPDATES:
            return
        self._shown = now
        reached = f"t = {t:.4g} s" + (self._listener.step if self._listener else "")
        self._show(reached=reached, after="left", total=self._end - self._start, completed=t - self._start)

    def _tell_stage(self, stage: str, slow: bool) -> None:
        """Show the stages before and between steps; slow ones, as derivation and compilation, at once."""
        if slow or self._bar is not None or time.monotonic() - self._begun > SHOWN_AFTER:
            self._show(description=stage)

    def _show(self, **changed: Any) -> None:
        if self._bar is None:
            from .terminal.stages import bar

            self._bar = bar()
            self._bar.start()
            self._task = self._bar.add_task(changed.get("description", "solving"), total=None, reached="", after="")
        self._bar.update(self._task, **changed)

    def __enter__(self) -> ProgressBar:
        if self._listener is not None:
            self._listener.begin()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._listener is not None:
            self._listener.end()
        if self._bar is not None:
            self._bar.stop()


class Telling:
    """Status line on a terminal, called with a line on the progress."""

    def __init__(self) -> None:
        self._seen = sys.stderr.isatty()
        self._status: Any = None

    def __call__(self, line: str) -> None:
        if not self._seen:
            return
        if self._status is None:
            self._status = console(stderr=True).status(line, refresh_per_second=4)
            self._status.start()
        self._status.update(line)

    def __enter__(self) -> Telling:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._status is not None:
            self._status.stop()
