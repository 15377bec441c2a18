r"""Lexer of datasets: title, statements, comments, continuation lines, END.

The first line is the title. ``!`` starts a comment; ``,`` at the start of a line (or ``&`` at the end of the line
before) continues a statement; ``;`` ends one. Text after END is ignored. Top-level commas split a statement into
pieces; ``\`` ends a function.  MSC Adams/Solver, "Using statements to define your model".
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TypeVar

from ...errors import InputError
from ...reading.files.quoted import MOST_LISTED
from ...reading.files.requested import Fields
from ...reading.files.text_file import lines

if TYPE_CHECKING:
    from ...reading.files.yaml_text import Content

Thing = TypeVar("Thing")


class DatasetFault(InputError):
    """Error in a statement, with its line; the reader of the file prepends the file name."""

    def __init__(self, line: int, label: str, reason: str) -> None:
        super().__init__(f"line {line}, {label}: {reason}")
        self.line, self.label, self.reason = line, label, reason


class CommandFault(DatasetFault):
    """Error in a command, with its line in the command file."""


def of_each(things: Iterable[Thing], make: Callable[[Thing], dict[str, object]]) -> Content:
    """Merge the results of a function for each item; the faults of all items are raised as one."""
    found: dict[str, object] = {}
    faults = []
    for thing in things:
        try:
            found |= make(thing)
        except DatasetFault as fault:
            faults.append(fault)
    raise_all(faults)
    return found


def raise_all(faults: Sequence[DatasetFault]) -> None:
    """Raise several faults as one, at the line of the first; do nothing if there are none."""
    if not faults:
        return
    first, *others = faults
    sentences = [first.reason, *map(str, others[: MOST_LISTED - 1])]
    more = f"; and {len(faults) - MOST_LISTED} more" if len(faults) > MOST_LISTED else ""
    raise DatasetFault(first.line, first.label, "; ".join(sentences) + more)


_HEAD = re.compile(r"\s*([A-Za-z_]\w*)\s*(?:/\s*((?:\w+(?=\s*(?:[,\x00]|\Z)))?))?\s*(.*)", re.DOTALL)
"""Name, optional number after the slash, and rest of a statement."""
_ALIAS = re.compile(r"!\s*adams_view_name\s*=\s*'([^']*)'", re.IGNORECASE)
_TWO_VALUES = re.compile(r"[\w.)]\s*\x00\s*[\w.]|[\d.)]\s*\x00\s*\(")
ZERO_BYTE = "\ufffd"
"""Placeholder of a zero byte, which ignored statements may contain."""
_LINE_COMMA = "\x00"
"""Placeholder of a comma that starts a continuation line: it separates arguments, but not terms of a function."""


@dataclass(frozen=True)
class Subsystem:
    """Part of a statement between two top-level commas.

    `line`: first line in the file. `on_new_line`: true if its comma starts a continuation line. `ended`: true if it
    ends with a backslash.
    """

    text: str
    line: int
    on_new_line: bool = False
    ended: bool = False


@dataclass(frozen=True)
class Statement:
    """Statement of a dataset or command file."""

    word: str  # text before the slash, in capitals
    ident: str  # text after the slash
    pieces: tuple[Subsystem, ...]
    line: int
    alias: str = ""  # name in Adams/View, from a comment before the statement
    changes: tuple[tuple[int, tuple[Subsystem, ...]], ...] = ()  # arguments changed by commands, with the line of each
    # arguments, with a record of those that are requested; filled when the statement is read
    requests: list[Fields[Any]] = field(default_factory=list, compare=False)


def statements(text: str) -> tuple[str, tuple[Statement, ...], bool]:
    """Return the title, the statements in order, and whether END was found."""
    title, *rest = lines(text) or [""]
    found, ended = _statements(rest, 2)
    return title.strip(), found, ended


def untitled(text: str) -> tuple[tuple[Statement, ...], bool]:
    """Return the statements of a dataset without a title, and whether END was found."""
    return _statements(lines(text), 1)


def commands(text: str) -> tuple[Statement, ...]:
    """Return the commands of a command file, which has no title."""
    return _statements(lines(text), 1)[0]


def _statements(texts: list[str], first: int) -> tuple[tuple[Statement, ...], bool]:
    """Return the statements of lines numbered from `first`, and whether END was found."""
    found: list[Statement] = []
    open_lines: list[tuple[int, str]] = []
    alias = next_alias = ""
    joined = False
    for number, line in enumerate(texts, start=first):
        alias_here = _ALIAS.search(line)
        if alias_here:
            next_alias = alias_here[1]
        for k, part in enumerate(_uncommented(line).split(";")):
            if not part.strip():
                continue
            continues = joined or (k == 0 and part.lstrip().startswith(","))
            if not continues:
                found += _made(open_lines, alias)
                open_lines, alias, next_alias = [], next_alias, ""
                if re.fullmatch(r"\s*END\s*", part, re.IGNORECASE):
                    return tuple(found), True
            if continues and not joined:
                part = _LINE_COMMA + part.lstrip()[1:]
            joined = part.rstrip().endswith("&")
            open_lines.append((number, part.rstrip().removesuffix("&") if joined else part))
    return (*found, *_made(open_lines, alias)), False


def _uncommented(line: str) -> str:
    """Return a line without its comment; an exclamation mark in double quotes starts none."""
    quoted, last = False, line.rfind('"')
    for k, sign in enumerate(line):
        if sign == '"' and (quoted or k < last):
            quoted = not quoted
        if sign == "!" and not quoted:
            return line[:k]
    return line


def _made(parts: list[tuple[int, str]], alias: str) -> Iterator[Statement]:
    if not parts:
        return
    text = "\n".join(part for _, part in parts)
    head = _HEAD.match(text)
    first = parts[0][0]
    if head is None:
        yield Statement(re.sub(rf"[\s{_LINE_COMMA}]+", " ", text).strip()[:20], "", (), first, alias)
        return
    start = head.start(3)
    numbers = [number for number, part in parts for _ in range(len(part) + 1)]
    yield Statement(
        head[1].upper(), head[2] or "", tuple(_pieces(text[start:], numbers[start:] or [first])), first, alias
    )


def _pieces(text: str, numbers: list[int]) -> Iterator[Subsystem]:
    """Yield the parts of a statement between top-level commas."""
    depth, start, on_new_line, quoted = 0, 0, False, False
    for k, sign in enumerate(text + ","):
        if sign == '"':
            quoted = not quoted
        if quoted and k < len(text):
            continue
        depth += (sign == "(") - (sign == ")")
        outermost = depth <= 0 or k == len(text)
        if sign in (",", _LINE_COMMA, "\\") and outermost:
            yield from _piece(text[start:k], numbers, start, on_new_line, sign == "\\")
            start, on_new_line = k + 1, sign == _LINE_COMMA


def _piece(text: str, numbers: list[int], start: int, on_new_line: bool, ended: bool) -> Iterator[Subsystem]:
    """Yield the part from `start` on with joined continuation lines and its line, unless it is empty."""
    before = len(text) - len(text.lstrip())
    # the comma of a continuation line is kept between two values
    kept = _TWO_VALUES.sub(lambda found: found[0].replace(_LINE_COMMA, ","), text).replace(_LINE_COMMA, " ")
    joined = re.sub(r"\s+", " ", kept).strip()
    if joined or ended:
        yield Subsystem(joined, numbers[min(start + before, len(numbers) - 1)], on_new_line, ended)
