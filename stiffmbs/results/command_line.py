"""Command line and date of results."""

from __future__ import annotations

import os
import shlex
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar

_COMMAND: ContextVar[str] = ContextVar("command", default="")


def date() -> str:
    """Return the time in SOURCE_DATE_EPOCH, or now, in UTC (ISO 8601)."""
    given = os.environ.get("SOURCE_DATE_EPOCH", "")
    return time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(int(given) if given.isdecimal() else None))


def command_line() -> str:
    """Return the command that is executed, or the command line of the Python program."""
    return _COMMAND.get() or shlex.join(["python", *sys.argv])


@contextmanager
def commanded(arguments: Sequence[str]) -> Iterator[None]:
    """Record the command line of a command within a context."""
    token = _COMMAND.set(shlex.join(["stiffmbs", *arguments]))
    try:
        yield
    finally:
        _COMMAND.reset(token)
