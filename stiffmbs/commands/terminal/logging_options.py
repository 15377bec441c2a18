"""The options ``-q`` and ``-v``, for what the package tells by Python's logging under the name ``stiffmbs``."""

from __future__ import annotations

import logging
from typing import Any

import click

LOGGER = logging.getLogger("stiffmbs")
QUIET = "stiffmbs.quiet"
"""Key of a context under which commands find that they were asked to be quiet."""


class ToStandardError(logging.Handler):
    """Writes records to what is standard error at the time."""

    def emit(self, record: logging.LogRecord) -> None:
        """Write one record on a line."""
        click.echo(self.format(record), err=True)


def with_logging_options(command: click.Command) -> click.Command:
    """Give a command, or all commands of a group, the options ``-q`` and ``-v``."""
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
    """Whether the command that runs was asked to be quiet."""
    context = click.get_current_context(silent=True)
    return bool(context and context.meta.get(QUIET))


def _quieten(context: click.Context, _: click.Parameter, asked: bool) -> None:
    if asked:
        context.meta[QUIET] = True
        _listen(context, logging.ERROR)


def _tell_more(context: click.Context, _: click.Parameter, count: int) -> None:
    if count:
        _listen(context, logging.INFO if count == 1 else logging.DEBUG)


def _listen(context: click.Context, level: int) -> None:
    """Show records from a level on until the command ends."""
    handler, before = ToStandardError(), LOGGER.level
    LOGGER.addHandler(handler)
    LOGGER.setLevel(level)

    def leave(*_: Any) -> None:
        LOGGER.removeHandler(handler)
        LOGGER.setLevel(before)

    context.call_on_close(leave)
