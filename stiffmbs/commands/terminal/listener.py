"""What the package tells by Python's logging while a run goes on, for a line on a terminal."""

from __future__ import annotations

import logging
from collections.abc import Callable

from .logging_options import LOGGER

SLOW = "stiffmbs.compile"
"""The package whose stages take seconds."""


class Listener(logging.Handler):
    """Hears of stages and steps between `begin` and `end`.

    Parameters
    ----------
    tell : callable
        Called with each stage, such as ``assembling``, and whether it is a slow one.

    Attributes
    ----------
    step : str
        Size and order of the last step, as words to follow the time; empty where none was told.
    """

    def __init__(self, tell: Callable[[str, bool], None]) -> None:
        super().__init__(logging.DEBUG)
        self._tell, self.step = tell, ""
        self._level = logging.NOTSET

    def begin(self) -> None:
        """Hear of everything from now on."""
        self._level = LOGGER.level
        LOGGER.addHandler(self)
        LOGGER.setLevel(logging.DEBUG)

    def end(self) -> None:
        """Hear of nothing any more."""
        LOGGER.removeHandler(self)
        LOGGER.setLevel(self._level)

    def emit(self, record: logging.LogRecord) -> None:
        """Take note of one record; warnings are told by others."""
        size, order = getattr(record, "step", None), getattr(record, "order", None)
        if size is not None:
            self.step = f", step {size:.2g} s" + (f", order {order}" if order else "")
        elif record.levelno == logging.INFO:
            self._tell(record.getMessage(), record.name.startswith(SLOW))
