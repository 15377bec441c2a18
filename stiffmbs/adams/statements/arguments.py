"""Named arguments of a statement: abbreviations, numbers, identifiers and functions."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from ...reading.files.quoted import quoted
from ...reading.files.requested import Fields
from .text import DatasetFault, Statement, Subsystem

_ASSIGNED = re.compile(r"([A-Za-z_]\w*)\s*=\s*(.*)", re.DOTALL)
_WORD = re.compile(r"[A-Za-z_]\w*")
_NUMBER = re.compile(r"([+-]?)\s*((?:\d+\.?\d*|\.\d+)(?:[ED][+-]?\d+)?)\s*(D?)", re.IGNORECASE)
_ANGULAR = {
    "PART": ("REULER", "WX", "WY", "WZ", "WM"), "POINT_MASS": ("REULER",), "MARKER": ("REULER",),
    "JOINT": ("IC", "ICROT", "ICTRAN"), "MOTION": ("ICDISP", "ICVEL"), "SPRINGDAMPER": ("ANGLE",), "FIELD": ("LENGTH",),
    "SENSOR": ("VALUE", "ERROR"), "SPLINE": ("X", "Y"), "ARRAY": ("NUMBERS",), "DIFF": ("IC",), "VARIABLE": ("IC",),
    "COUPLER": ("SCALES",), "MATRIX": ("VALUES",),
}  # fmt: skip
"""Arguments that may be angles, by statement: a D after a number means degrees there alone."""


@dataclass(frozen=True)
class Argument:
    """Named argument: its value split at top-level commas (empty for a keyword alone)."""

    name: str
    values: tuple[str, ...]
    line: int


class Arguments:
    """Arguments of a statement by full name.

    Parameters
    ----------
    keyword : str
        Its full name.
    names : sequence of str
        Valid arguments. An abbreviation matches the first that it begins.
    functions : sequence of str
        Arguments whose value is a function expression, in which commas do not separate values.
    repeated : sequence of str
        Arguments that may occur several times; their values follow each other.

    Raises
    ------
    DatasetFault
        If an argument is unknown, or repeated without being one of `repeated`.
    """

    def __init__(
        self,
        statement: Statement,
        keyword: str,
        names: Sequence[str],
        functions: Sequence[str] = (),
        repeated: Sequence[str] = (),
    ) -> None:
        self.statement, self.keyword = statement, keyword
        self.label = f"{keyword}/{quoted(statement.ident)}" if statement.ident else keyword
        self._names, self._functions, self._repeated = names, functions, repeated
        found = self._read(statement.pieces)
        for line, pieces in statement.changes:
            self.label += f" (changed in line {line} of the command file)"
            found |= self._read(pieces)
        self._found = Fields(keyword, self.label, found)
        statement.requests.append(self._found)

    def _read(self, pieces: Sequence[Subsystem]) -> dict[str, Argument]:
        """Return the arguments in the given pieces by full name."""
        found: dict[str, Argument] = {}
        name, line = "", self.statement.line
        texts: list[str] = []
        for piece in pieces:
            if name and self._continues(name, texts, piece):
                if texts == [""] and piece.on_new_line:  # the list begins on the continuation line
                    texts = []
                texts.append(piece.text)
                continue
            self._keep(found, name, texts, line)
            name, texts, line = *self._opened(piece), piece.line
        self._keep(found, name, texts, line)
        return found

    def _continues(self, name: str, texts: list[str], piece: Subsystem) -> bool:
        """Return True if a piece continues the argument before it."""
        if _ASSIGNED.fullmatch(piece.text) or not texts:
            return False
        if name in self._functions:
            return piece.on_new_line and not (_WORD.fullmatch(piece.text) and self._full(piece.text))
        return not (_WORD.fullmatch(piece.text) and self._full(piece.text))

    def _opened(self, piece: Subsystem) -> tuple[str, list[str]]:
        """Return the full name at the start of a piece, and its first value."""
        assigned = _ASSIGNED.fullmatch(piece.text)
        word = assigned[1] if assigned else piece.text
        name = self._full(word) if _WORD.fullmatch(word) else ""
        if not name:
            raise self.fault(f"found '{quoted(piece.text)}', expected one of {', '.join(self._names)}", piece.line)
        return name, [assigned[2].strip()] if assigned else []

    def _full(self, word: str) -> str:
        """Return the argument that a word or abbreviation matches; '' if none."""
        word = word.upper()
        if word in self._names:
            return word
        return next((name for name in self._names if name.startswith(word)), "")

    def _keep(self, found: dict[str, Argument], name: str, texts: list[str], line: int) -> None:
        if not name:
            return
        values = (" ".join(texts),) if name in self._functions and texts else tuple(texts)
        if name in found:
            if name not in self._repeated:
                raise self.fault(f"found {name} twice, expected it once", line)
            values = found[name].values + values
        found[name] = Argument(name, values, line)

    def without_effect(self, *names: str) -> None:
        """Exclude arguments from the report of unused arguments."""
        self._found.request(*names)

    def says(self, name: str) -> str:
        """Return an argument's value in capitals, empty if it is missing; it stays in the report of unused arguments."""
        found = self._found.unrecorded(name)
        return ", ".join(found.values).strip().upper() if found else ""

    def fault(self, reason: str, place: int | str = "") -> DatasetFault:
        """Return the error for a fault in this statement, at a line or an argument; by default at its first line."""
        return DatasetFault(self.line(place) if isinstance(place, str) else place, self.label, reason)

    def __contains__(self, name: str) -> bool:
        return name in self._found

    def line(self, name: str) -> int:
        """Return the line of an argument; that of the statement if it is missing."""
        return self._found[name].line if self._found.has(name) else self.statement.line

    def head(self) -> tuple[int, int, str, str]:
        """Return the fields of `Numbered`."""
        ident = _integer(self, self.statement.ident, "after the slash", self.statement.line)
        return ident, self.statement.line, self.statement.alias, self.keyword

    def refuse(self, names: Iterable[str], expected: str) -> None:
        """Raise the error for arguments that are not supported, if any is given."""
        for name in names:
            if name in self:
                raise self.fault(f"found {name}, expected {expected}", name)

    def one_of(self, *words: str) -> str | None:
        """Return the one of the given words that occurs in the statement; None if none does."""
        found = [word for word in words if word in self]
        if len(found) > 1:
            raise self.fault(f"found {' and '.join(found)}, expected one of them", self.line(found[1]))
        return found[0] if found else None

    def text(self, name: str) -> str | None:
        """Return an argument's value as written."""
        return ", ".join(self._found[name].values) if name in self else None

    def texts(self, name: str) -> tuple[str, ...]:
        """Return an argument's values as written; empty if it is missing."""
        return self._found[name].values if name in self else ()

    def numbers(self, name: str, *counts: int) -> tuple[float, ...] | None:
        """Return an argument's numbers, as many as one of `counts`; None if it is missing. Degrees become radians."""
        if name not in self:
            return None
        angular = name in _ANGULAR.get(self.keyword, ())
        values = tuple(number(text, angular) for text in self._found[name].values)
        wanted = " or ".join(map(str, counts))
        if None in values or (counts and len(values) not in counts):
            raise self.fault(
                f"found {name} = {quoted(self.text(name))}, expected {wanted or 'only'} numbers{_hint(self.texts(name))}",
                self.line(name),
            )
        return tuple(value for value in values if value is not None)

    def number(self, name: str) -> float | None:
        """Return an argument's only number; None if it is missing."""
        values = self.numbers(name, 1)
        return None if values is None else values[0]

    def positive(self, name: str) -> float | None:
        """Return an argument's number, which must be positive; None if it is missing."""
        value = self.number(name)
        if value is not None and not value > 0:
            raise self.fault(f"found {name} = {self.text(name)}, expected a number above zero", name)
        return value

    def needed(self, name: str) -> float:
        """Return the number of a required argument, which must be positive."""
        value = self.number(name)
        if value is None or not value > 0:
            raise self.fault(f"found no {name}, expected a number above zero", name)
        return value

    def idents(self, name: str, *counts: int) -> tuple[int, ...]:
        """Return the statement identifiers in an argument; empty if it is missing."""
        if name not in self:
            return ()
        found = tuple(_integer(self, text, name, name) for text in self._found[name].values)
        if counts and len(found) not in counts:
            raise self.fault(
                f"found {name} = {quoted(self.text(name))}, expected {' or '.join(map(str, counts))} numbers of statements",
                name,
            )
        return found

    def reference(self, name: str) -> int | None:
        """Return the single statement identifier in an argument; None if it is missing."""
        found = self.idents(name, 1)
        return found[0] if found else None

    def required(self, name: str) -> int:
        """Return the statement identifier in a required argument."""
        found = self.reference(name)
        if found is None:
            raise self.fault(f"found no {name}, expected {name} = the number of a statement")
        return found


def _hint(values: Sequence[str]) -> str:
    """Return how numbers are written if a value is none because of blanks, or of a D for degrees; empty otherwise."""
    if any(number(text) is None and number(text.replace(" ", "")) is not None for text in values):
        return " without blanks in them"
    return ", no angles in degrees (D)" if any(number(text, False) is None and number(text) for text in values) else ""


def number(text: str, angular: bool = True) -> float | None:
    """Return the number in a text, in radians if followed by D for degrees; None if not a finite number.

    Blanks are allowed after its sign and before a D. `angular`: False for a number that is no angle.
    """
    found = _NUMBER.fullmatch(text.strip())
    if found is None or (found[3] and not angular):
        return None
    value = float(found[1] + found[2].upper().replace("D", "E"))
    if math.isinf(value):  # overflow
        return None
    return math.radians(value) if found[3] else value


def _integer(arguments: Arguments, text: str, where: str, place: int | str) -> int:
    if not re.fullmatch(r"\d{1,18}", text.strip()):
        raise arguments.fault(f"found '{quoted(text)}' {where}, expected the number of a statement", place)
    return int(text)
