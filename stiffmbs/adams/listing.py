"""Listing of the statements of a dataset and the commands of its command file: read, ignored or refused."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

from ..describe.files.text_file import file_text, source_name
from ..errors import InputError
from .commands.command_files import Read, command_file_of
from .commands.commands import ENDING, FOLLOWED, HARMLESS, SETTINGS, full_name, read_commands
from .listed_arguments import arguments_of, unread_functions
from .load import ENCODING, command_file, other_commands
from .statements.changes import Key, alters, key_of
from .statements.dataset import all_statements, faults_of
from .statements.fault import DatasetFault
from .statements.keywords import LEFT_OUT, REFUSED, keyword
from .statements.left_out import LEFT_OUT_ARGUMENTS, UNREAD_SYSTEM, is_unread_system
from .statements.text import ZERO_BYTE, Statement, commands

READ, OMITTED, NOT_READ = "read", "left out", "refused"


@dataclass(frozen=True)
class ListedStatement:
    """Statement or command with its treatment.

    Attributes
    ----------
    file : str
        Its name.
    line : int
    statement : str
        Full name and number: ``JOINT/3``.
    fate : str
        ``read``, ``left out`` or ``refused``.
    reason : str
        Reason why it is left out or refused, or its meaning.
    argument : str
        Argument, or function in an argument, that this entry is about; empty for the whole statement.
    arguments : tuple of str
        Full names of the arguments that are read, for a whole statement.
    """

    file: str
    line: int
    statement: str
    fate: str
    reason: str = ""
    argument: str = ""
    arguments: tuple[str, ...] = ()

    def __str__(self) -> str:
        what = f"{self.statement}, {self.argument}" if self.argument else self.statement
        told = f" ({' '.join(self.arguments)})" if self.arguments else self.reason and f", {self.reason}"
        return f"{self.file}, line {self.line}, {what}: {self.fate}{told}"

    def as_dict(self) -> dict[str, Any]:
        """Return an entry of ``statements`` of ``stiffmbs check --json``."""
        return asdict(self)


def listed_statements(path: str | Path) -> tuple[ListedStatement, ...]:
    """Return every statement of a dataset file and every command of its command file, in order.

    Ignored arguments and refused functions have separate entries after that of their statement. Each statement is
    checked alone; inconsistencies between statements are reported when the scene is built.

    Raises
    ------
    InputError
        If a file cannot be read as text.
    """
    text = file_text(path, ENCODING, ZERO_BYTE)
    faults = {fault.line: fault.reason for fault in faults_of(text)}
    _, found, _ = all_statements(text)
    solids = _solids(found)
    listed = [entry for one in found for entry in _statement(one, source_name(path), faults, solids, found)]
    beside = command_file(path)
    if beside is not None:
        read = partial(other_commands, beside)
        listed += _commands(file_text(beside, ENCODING), beside.name, {key_of(one) for one in found}, read)
    return tuple(listed)


def _solids(found: Iterable[Statement]) -> set[tuple[str, int]]:
    """Return the GRAPHICS used by contacts, by name and number."""
    contacts = (arguments_of(one, "CONTACT") for one in found if keyword(one.word) == "CONTACT")
    named = (value for given in contacts for side in ("IGEOM", "JGEOM") for value in given.get(side, (0, ()))[1])
    return {("GRAPHICS", int(value)) for value in named if value.strip().isdecimal()}


def _statement(
    statement: Statement, file: str, faults: dict[int, str], solids: set[tuple[str, int]], every: Sequence[Statement]
) -> Iterator[ListedStatement]:
    name = keyword(statement.word)
    label = f"{name or statement.word}/{statement.ident}".rstrip("/")
    one = partial(ListedStatement, file, statement.line, label)
    if name is None:
        yield one(NOT_READ, "found a statement that is not known")
    elif is_unread_system(name, statement, every):
        yield one(OMITTED, UNREAD_SYSTEM)
    elif name in REFUSED:
        yield one(NOT_READ, REFUSED[name])
    elif key_of(statement) in solids:
        yield one(READ, "the solid of a CONTACT")
    elif name in LEFT_OUT:
        yield one(OMITTED, LEFT_OUT[name])
    elif faults_here := [faults[line] for line in sorted(faults) if line in _lines(statement)]:
        yield one(NOT_READ, faults_here[0])
    else:
        found = arguments_of(statement, name)
        omitted = LEFT_OUT_ARGUMENTS.get(name, {})
        yield one(READ, arguments=tuple(argument for argument in found if argument not in omitted))
        for argument, (line, values) in found.items():
            if argument in omitted:
                yield ListedStatement(file, line, label, OMITTED, omitted[argument], argument)
            for function in unread_functions(name, values):
                yield ListedStatement(
                    file, line, label, NOT_READ, f"a function that {argument} cannot use here", function
                )


def _lines(statement: Statement) -> set[int]:
    return {statement.line, *(piece.line for piece in statement.pieces)}


def _commands(text: str, file: str, known: Collection[Key], read: Read) -> list[ListedStatement]:
    listed = []
    refused: dict[int, str] = {}
    try:
        read_commands(text, known, read)
    except DatasetFault as fault:
        refused[fault.line] = fault.reason
    except InputError as error:
        refused[1] = str(error)
    ended = False
    for command in commands(text):
        name = full_name(command.word)
        label = f"{name or command.word}/{command.ident}".rstrip("/")
        fate, reason = READ, ""
        if command.line in refused:
            fate, reason = NOT_READ, refused[command.line]
        elif ended:
            fate, reason = OMITTED, "after STOP"
        elif (other := command_file_of(command)) is not None:
            reason = f"the commands of {other}"
        elif name in (*SETTINGS, *HARMLESS):
            fate, reason = OMITTED, "no effect on results" if name in HARMLESS else "analysis settings"
        elif not (name in (*FOLLOWED, *ENDING) or alters(name)):
            fate, reason = OMITTED, "the name of a file"
        ended = ended or name in ENDING
        listed.append(ListedStatement(file, command.line, label, fate, reason))
    return listed
