"""Group of commands whose files are loaded on first use, each with the options ``-q`` and ``-v``."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from importlib import import_module
from typing import Any

import click

from .process import Process

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
            help="Print progress messages on standard error; -vv for details.",
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

    def leave(*_: object) -> None:
        LOGGER.removeHandler(handler)
        LOGGER.setLevel(before)

    context.call_on_close(leave)


class Subcommands(Process):
    """A group whose commands are in several files: a run need not load what draws or fits.

    `sections`: the module of each command in `stiffmbs.commands`, by section of the help.  After a colon the name of
    the command in the module, if it differs.
    """

    def __init__(
        self, *arguments: Any, sections: Mapping[str, Mapping[str, str]] | None = None, **options: Any
    ) -> None:
        super().__init__(*arguments, **options)
        self.sections = sections or {}
        self.files = {name: module for section in self.sections.values() for name, module in section.items()}

    def list_commands(self, context: click.Context) -> list[str]:
        """Return the names of all commands, in alphabetical order."""
        return sorted(self.files)

    def get_command(self, context: click.Context, name: str) -> click.Command | None:
        """Return the command of a name, or None."""
        for wanted in [name] if name in self.files else self.files:  # all commands, to suggest a similar one
            if wanted not in self.commands:
                self.add_command(with_logging_options(self._loaded(wanted)), wanted)
        return super().get_command(context, name)

    def format_commands(self, context: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the commands with their short help, section by section."""
        longest = max(map(len, self.files), default=0)
        for title, names in self.sections.items():
            commands = {name: self.get_command(context, name) for name in names}
            rows = [
                (name.ljust(longest), command.get_short_help_str(formatter.width - longest - 4))
                for name, command in commands.items()
                if command is not None
            ]
            with formatter.section(title):
                formatter.write_dl(rows)

    def _loaded(self, name: str) -> click.Command:
        module, _, own_name = self.files[name].partition(":")
        command: click.Command = getattr(import_module(f".{module}", __package__), own_name or name)
        return command
