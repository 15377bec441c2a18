"""Options ``-q`` and ``-v``, for the package's log records under the name ``stiffmbs``."""

from __future__ import annotations

import logging
from typing import Any

import click

LOGGER = logging.getLogger("stiffmbs")
QUIET = "stiffmbs.quiet"
"""Key of a click context for a requested ``--quiet``."""
LOUDNESS = (logging.WARNING, logging.INFO, logging.DEBUG)
"""Log levels without ``-v``, with one and with two."""


class ToStandardError(logging.Handler):
    """Handler that writes records to the current standard error."""

    def emit(self, record: logging.LogRecord) -> None:
        """Write one record on a line."""
        click.echo(self.format(record), err=True)


def with_logging_options(command: click.Command) -> click.Command:
    """Add the options ``-q`` and ``-v`` to a command, or to all commands of a group."""
    if isinstance(command, click.Group):
        for own in command.commands.values():
            with_logging_options(own)
        return command
    command.params += [
        click.Option(["-q", "--quiet"], is_flag=True, expose_value=False, callback=_quieten, help="No progress and no notes."),
        click.Option(
            ["-v", "--verbose"], count=True, expose_value=False, callback=_tell_more,
            help="Tell on standard error what is done; -vv in detail.",
        ),
    ]  # fmt: skip
    return command


def is_quiet() -> bool:
    """Return True if the running command, or the one that called it, was started with ``--quiet``."""
    context = click.get_current_context(silent=True)
    return context is not None and bool(context.meta.get(QUIET))


def _quieten(context: click.Context, _: click.Parameter, asked: bool) -> None:
    if asked:
        context.meta[QUIET] = True


def _tell_more(context: click.Context, _: click.Parameter, count: int) -> None:
    """Print records of the requested levels until the command ends."""
    if not count and any(isinstance(handler, ToStandardError) for handler in LOGGER.handlers):
        return  # same levels as in the calling command
    level = logging.ERROR if context.meta.get(QUIET) else LOUDNESS[min(count, 2)]
    handler, before = ToStandardError(level), LOGGER.level
    LOGGER.addHandler(handler)
    LOGGER.setLevel(level)

    def leave(*_: Any) -> None:
        LOGGER.removeHandler(handler)
        LOGGER.setLevel(before)

    context.call_on_close(leave)
