"""Listing of the statements of a dataset and the commands of its command file: read, ignored or refused."""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path

from ..errors import InputError
from ..reading.files.text_file import file_text, source_name
from .commands.command_files import Read, command_file_of
from .commands.commands import ENDING, FOLLOWED, HARMLESS, SETTINGS, full_name, read_commands
from .functions.adams_functions import ADAMS_FUNCTIONS
from .functions.expression import ExpressionError, parse
from .functions.force_laws import LAWS
from .functions.inputs import PLANTS
from .functions.measures import ANGLES_OF_AXES, COMPONENTS, REACTIONS
from .functions.splines import CURVES
from .functions.translate import ANGLES, ANGULAR_VELOCITIES, COUPLED, PLAIN, POSITIONS, VELOCITIES
from .functions.translate_output import ACCELERATIONS, ANGULAR_ACCELERATIONS, ROUNDING_FUNCTIONS
from .load import ENCODING, command_file, other_commands
from .statements.arguments import Argument
from .statements.changes import Key, alters, key_of
from .statements.dataset import all_statements, faults_of, read_statement
from .statements.keywords import LEFT_OUT, LEFT_OUT_ARGUMENTS, REFUSED, UNREAD_SYSTEM, is_unread_system, keyword
from .statements.text import ZERO_BYTE, DatasetFault, Statement, commands
from .statements.units import Units

READ, OMITTED, NOT_READ = "read", "left out", "refused"
ANYWHERE = {
    *POSITIONS, *ANGLES, *VELOCITIES, *ANGULAR_VELOCITIES, *PLAIN, *ADAMS_FUNCTIONS, *CURVES, *ANGLES_OF_AXES, *REACTIONS,
    *LAWS, *COMPONENTS, "INTERP", "ARYVAL", *PLANTS, "VARVAL", "DIF", "DIF1", "INCANG", "SENVAL",
}  # fmt: skip
IN_REQUESTS = {*ANYWHERE, *COUPLED, *ACCELERATIONS, *ANGULAR_ACCELERATIONS, *ROUNDING_FUNCTIONS, "ORIENT"}
REPORTED = ("REQUEST", "VARIABLE", "SENSOR")
"""Statements that may use request functions; a VARIABLE used by forces is checked when the scene is built."""


@dataclass(frozen=True)
class ListedStatement:
    """Statement or command with its treatment."""

    file: str  # name of the dataset or command file
    line: int  # line in it
    statement: str  # full name and number: ``JOINT/3``
    fate: str  # treatment: ``read``, ``left out`` or ``refused``
    reason: str = ""  # reason why it is left out or refused, or its meaning
    argument: str = ""  # argument, or function in an argument, that this entry is about; empty for the whole statement
    arguments: tuple[str, ...] = ()  # full names of the arguments that are read, for a whole statement

    def __str__(self) -> str:
        what = f"{self.statement}, {self.argument}" if self.argument else self.statement
        detail = f" ({' '.join(self.arguments)})" if self.arguments else self.reason and f", {self.reason}"
        return f"{self.file}, line {self.line}, {what}: {self.fate}{detail}"

    def as_dict(self) -> dict[str, object]:
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
    commands_file = command_file(path)
    if commands_file is not None:
        read = partial(other_commands, commands_file)
        listed += _commands(
            file_text(commands_file, ENCODING), commands_file.name, {key_of(one) for one in found}, read
        )
    return tuple(listed)


def _solids(found: Iterable[Statement]) -> set[tuple[str, int]]:
    """Return the GRAPHICS used by contacts, by name and number."""
    contacts = (_arguments(one, "CONTACT") for one in found if keyword(one.word) == "CONTACT")
    named = (text for given in contacts for one in given if one.name in ("IGEOM", "JGEOM") for text in one.values)
    return {("GRAPHICS", int(text)) for text in named if text.strip().isdecimal()}


def _arguments(statement: Statement, name: str) -> list[Argument]:
    """Return the arguments of a statement, up to the first fault."""
    fresh = replace(statement, requests=[])
    with suppress(DatasetFault):
        read_statement(name, fresh, Units())
    return list({argument.name: argument for found in fresh.requests for argument in found.values()}.values())


def _unread_functions(name: str, values: Sequence[str]) -> Iterator[str]:
    """Yield the unsupported functions in an argument of a statement."""
    known = IN_REQUESTS if name in REPORTED else ANYWHERE
    for value in values:
        with suppress(ExpressionError):
            calls = (node for node in ast.walk(parse(value.strip().strip('"'))) if isinstance(node, ast.Call))
            called = dict.fromkeys(node.func.id for node in calls if isinstance(node.func, ast.Name))
            yield from (function for function in called if function not in known)


def _statement(
    statement: Statement, file: str, faults: dict[int, str], solids: set[tuple[str, int]], every: Sequence[Statement]
) -> Iterator[ListedStatement]:
    name = keyword(statement.word)
    label = f"{name or statement.word}/{statement.ident}".rstrip("/")
    one = partial(ListedStatement, file, statement.line, label)
    if name is None:
        yield one(NOT_READ, "found an unknown statement")
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
        found = _arguments(statement, name)
        omitted = LEFT_OUT_ARGUMENTS.get(name, {})
        yield one(READ, arguments=tuple(argument.name for argument in found if argument.name not in omitted))
        for argument in found:
            of_argument = partial(ListedStatement, file, argument.line, label)
            if argument.name in omitted:
                yield of_argument(OMITTED, omitted[argument.name], argument.name)
            for function in _unread_functions(name, argument.values):
                yield of_argument(NOT_READ, f"a function that {argument.name} of this statement cannot use", function)


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
            fate, reason = OMITTED, "a file name"
        ended = ended or name in ENDING
        listed.append(ListedStatement(file, command.line, label, fate, reason))
    return listed
