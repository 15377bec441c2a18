"""What becomes of each statement of a dataset, and of each command of the file beside it."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path

from ..describe.files.text_file import checked, file_text, source_name
from ..errors import InputError
from .load import ENCODING, command_file
from .statements.changes import alters
from .statements.commands import ENDING, FOLLOWED, HARMLESS, SETTINGS, full_name, read_commands
from .statements.dataset import all_statements, faults_of
from .statements.fault import DatasetFault
from .statements.keywords import LEFT_OUT, REFUSED, keyword
from .statements.text import Statement, commands

READ, OMITTED, NOT_READ = "read", "left out", "refused"


@dataclass(frozen=True)
class ListedStatement:
    """One statement or command.

    Attributes
    ----------
    file : str
        Its name.
    line : int
    statement : str
        Its full name and number: ``JOINT/3``.
    fate : str
        ``read``, ``left out`` or ``refused``.
    reason : str
        Why it is left out or refused.
    """

    file: str
    line: int
    statement: str
    fate: str
    reason: str = ""

    def __str__(self) -> str:
        return f"{self.file}, line {self.line}, {self.statement}: {self.fate}" + (self.reason and f", {self.reason}")

    def as_dict(self) -> dict[str, str | int]:
        """An entry of ``statements`` of ``stiffmbs check --json``."""
        return asdict(self)


def listed_statements(path: str | Path) -> tuple[ListedStatement, ...]:
    """Every statement of a dataset's file and every command of the file beside it, in their order.

    A statement that is read alone may still not fit the others: that is told when the scene is made.

    Raises
    ------
    InputError
        When a file cannot be read as text.
    """
    text = checked(file_text(path, ENCODING), source_name(path))
    faults = {fault.line: fault.reason for fault in faults_of(text)}
    _, found, _ = all_statements(text)
    listed = [_statement(one, source_name(path), faults) for one in found]
    beside = command_file(path)
    if beside is not None:
        listed += _commands(file_text(beside, ENCODING), beside.name)
    return tuple(listed)


def _statement(statement: Statement, file: str, faults: dict[int, str]) -> ListedStatement:
    name = keyword(statement.word)
    label = f"{name or statement.word}/{statement.ident}".rstrip("/")
    if name is None:
        return ListedStatement(file, statement.line, label, NOT_READ, "found a statement that is not known")
    if name in REFUSED:
        return ListedStatement(file, statement.line, label, NOT_READ, REFUSED[name])
    if name in LEFT_OUT:
        return ListedStatement(file, statement.line, label, OMITTED, LEFT_OUT[name])
    if statement.line in faults:
        return ListedStatement(file, statement.line, label, NOT_READ, faults[statement.line])
    return ListedStatement(file, statement.line, label, READ)


def _commands(text: str, file: str) -> list[ListedStatement]:
    listed = []
    refused: dict[int, str] = {}
    try:
        read_commands(text)
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
        elif name in (*SETTINGS, *HARMLESS):
            fate, reason = OMITTED, "no effect on results" if name in HARMLESS else "analysis settings"
        elif not (name in (*FOLLOWED, *ENDING) or alters(name)):
            fate, reason = OMITTED, "the name of a file"
        ended = ended or name in ENDING
        listed.append(ListedStatement(file, command.line, label, fate, reason))
    return listed
