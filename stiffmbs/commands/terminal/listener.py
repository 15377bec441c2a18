"""Listener to the package's log records during a run, for a line on a terminal."""

from __future__ import annotations

import logging
from collections.abc import Callable

from .logging_options import LOGGER

SLOW = "stiffmbs.compile"
"""Package whose stages take seconds."""


class Listener(logging.Handler):
    """Logging handler for stages and steps, active between `begin` and `end`.

    Parameters
    ----------
    tell : callable
        Called with each stage, such as ``assembling``, and True if it is slow.

    Attributes
    ----------
    step : str
        Size and order of the last step, as text after the time; empty if unknown.
    """

    def __init__(self, tell: Callable[[str, bool], None]) -> None:
        super().__init__(logging.DEBUG)
        self._tell, self.step = tell, ""
        self._level = logging.NOTSET

    def begin(self) -> None:
        """Start listening to all records."""
        self._level = LOGGER.level
        LOGGER.addHandler(self)
        LOGGER.setLevel(logging.DEBUG)

    def end(self) -> None:
        """Stop listening."""
        LOGGER.removeHandler(self)
        LOGGER.setLevel(self._level)

    def emit(self, record: logging.LogRecord) -> None:
        """Process one record; warnings are printed by another handler."""
        size, order = getattr(record, "step", None), getattr(record, "order", None)
        if size is not None:
            self.step = f", step {size:.2g} s" + (f", order {order}" if order else "")
        elif record.levelno == logging.INFO:
            self._tell(record.getMessage(), record.name.startswith(SLOW))
