"""Group of commands whose files are loaded on first use."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import Any

import click

from .logging_options import with_logging_options
from .process import Process


class Subcommands(Process):
    """A group whose commands have a file each: a run need not load what draws or fits.

    Parameters
    ----------
    sections : mapping of str to mapping of str to str
        The module of each command in `stiffmbs.commands`, by section of the help.  After a colon the name of the command
        in the module, if it differs.
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
