"""Nested command files: FILE/COMMAND executes the commands of another file in its place."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

from ...errors import InputError
from ..statements.arguments import Arguments
from ..statements.text import DatasetFault, Statement, Subsystem, commands

ARGUMENTS = ("MODEL", "COMMAND", "OUTPUT_PREFIX", "GRAPHICS", "REQUEST", "RESULTS", "OUTPUT", "FEMDATA")
"""Arguments of FILE."""
Read = Callable[[str], str]
"""Function that returns the text of a command file by its name."""


def all_commands(text: str, read: Read | None = None, within: tuple[str, ...] = ()) -> Iterator[Statement]:
    """Yield the commands of a text and of the files that it executes; the latter have the line of their FILE/COMMAND.

    `text`: the content of a command file. `read`: reads another command file; without it FILE/COMMAND is refused.
    `within`: the names of the files that execute this one. Raises DatasetFault if a file cannot be read, or executes
    itself.
    """
    for command in commands(text):
        name = command_file_of(command)
        if name is None:
            yield command
            continue
        content = _content(command, name, read, within)
        try:
            others = list(all_commands(content, read, (*within, name)))
        except DatasetFault as fault:
            raise DatasetFault(command.line, "FILE/COMMAND", f"{name}, {fault}") from None
        for other in others:
            yield replace(
                other, line=command.line, pieces=tuple(replace(piece, line=command.line) for piece in other.pieces)
            )


def command_file_of(command: Statement) -> str | None:
    """Return the name of the file executed by FILE/COMMAND; None for any other command."""
    if not is_file(command.word):
        return None
    found = Arguments(with_first_argument(command), "FILE", ARGUMENTS)
    return found.text("COMMAND") if "COMMAND" in found else None


def is_file(word: str) -> bool:
    """Return True for FILE and its abbreviations of three letters or more."""
    return len(word) > 2 and "FILE".startswith(word)


def with_first_argument(command: Statement) -> Statement:
    """Return a command with its first argument, written after the slash, as one of its pieces."""
    head = (Subsystem(command.ident, command.line),) if command.ident else ()
    return replace(command, ident="", pieces=(*head, *command.pieces))


def _content(command: Statement, name: str, read: Read | None, within: tuple[str, ...]) -> str:
    if read is None:
        reason = f"found COMMAND = {name}, expected the commands of that file in this one"
    elif name in within:
        reason = f"found COMMAND = {name}, expected no file that executes itself"
    else:
        try:
            return read(name)
        except InputError as error:
            reason = str(error)
    raise DatasetFault(command.line, "FILE/COMMAND", reason)
