"""Files of tyre properties (.tir), as Adams/Tire and MF-Tyre have them: sections of keys and values, with units."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from ...errors import InputError
from ..files.quoted import quoted
from ..files.text_file import file_text, lines

UNITS: Mapping[str, Mapping[str, float]] = {
    "LENGTH": {"meter": 1.0, "m": 1.0, "mm": 1e-3, "millimeter": 1e-3, "cm": 1e-2, "centimeter": 1e-2, "km": 1e3,
               "kilometer": 1e3, "inch": 0.0254, "in": 0.0254, "foot": 0.3048, "feet": 0.3048, "ft": 0.3048},
    "FORCE": {"newton": 1.0, "n": 1.0, "kn": 1e3, "knewton": 1e3, "kilonewton": 1e3, "kg_force": 9.80665, "kgf": 9.80665,
              "pound_force": 4.4482216152605, "lbf": 4.4482216152605},
    "ANGLE": {"radian": 1.0, "radians": 1.0, "rad": 1.0, "degree": math.pi / 180, "degrees": math.pi / 180, "deg": math.pi / 180},
    "MASS": {"kg": 1.0, "kilogram": 1.0, "gram": 1e-3, "tonne": 1e3, "pound_mass": 0.45359237, "slug": 14.593902937206},
    "TIME": {"second": 1.0, "seconds": 1.0, "sec": 1.0, "s": 1.0, "millisecond": 1e-3, "minute": 60.0, "hour": 3600.0},
}  # fmt: skip
"""What the units of a file are in SI units; as Adams/Tire spells them, in any case."""
POWERS = {
    "": {}, "length": {"LENGTH": 1}, "force": {"FORCE": 1}, "angle": {"ANGLE": 1}, "stiffness": {"FORCE": 1, "LENGTH": -1},
    "damping": {"FORCE": 1, "TIME": 1, "LENGTH": -1}, "velocity": {"LENGTH": 1, "TIME": -1},
}  # fmt: skip
"""Of what units a dimension is made."""
_KEY = re.compile(r"^\s*([A-Za-z_]\w*)\s*=\s*(.*)$")
_QUOTED = re.compile(r"^'([^']*)'|^\"([^\"]*)\"")


@dataclass(frozen=True)
class Entry:
    """The value of a key: text without quotes and comment, its line, and the section that it stands in."""

    text: str
    line: int
    section: str


@dataclass(frozen=True)
class PropertyFile:
    """What stands in a file.

    Attributes
    ----------
    source : str
        What messages call it.
    entries : mapping of str to Entry
        By key, in capital letters.
    tables : mapping of str to tuple of rows
        Rows of numbers below a heading in braces, by section; with the line of the first.
    """

    source: str
    entries: Mapping[str, Entry]
    tables: Mapping[str, tuple[int, tuple[tuple[float, ...], ...]]]

    def text(self, key: str) -> str:
        """A value in capital letters; empty where there is none."""
        return self.entries[key].text.upper() if key in self.entries else ""

    def number(self, key: str, dimension: str = "") -> float:
        """A value in SI units.

        Raises
        ------
        InputError
            When the file has none, or it is no number.
        """
        if key not in self.entries:
            raise InputError(f"{self.source}: found no {key}, expected one")
        entry = self.entries[key]
        return _number(entry.text, f"{self.source}, line {entry.line}: {key}") * self.factor(dimension)

    def factor(self, dimension: str) -> float:
        """The file's unit of a dimension in SI units; SI units where the file has no [UNITS].

        Raises
        ------
        InputError
            For a unit that is not known.
        """
        value = 1.0
        for kind, power in POWERS[dimension].items():
            entry = self.entries.get(kind)
            if entry is None or entry.section != "UNITS":
                continue
            known = UNITS[kind]
            if entry.text.lower() not in known:
                raise InputError(
                    f"{self.source}, line {entry.line}: {kind}: found the unit '{quoted(entry.text)}', expected one of "
                    f"{', '.join(known)}"
                )
            value *= known[entry.text.lower()] ** power
        return value


def read_property_file(path: Path) -> PropertyFile:
    """Read a file of tyre properties.

    Raises
    ------
    InputError
        When it cannot be read, or a line is neither a section, a key with a value, a row of numbers nor a comment.
    """
    return parse_properties(file_text(path, otherwise="latin-1"), str(path))


def parse_properties(text: str, source: str) -> PropertyFile:
    """The same for its text."""
    entries: dict[str, Entry] = {}
    tables: dict[str, tuple[int, list[tuple[float, ...]]]] = {}
    section = ""
    for number, line in enumerate(lines(text), start=1):
        content = line.strip()
        where = f"{source}, line {number}"
        if not content or content[0] in "!$#{(":
            continue
        if content.startswith("["):
            section = _section(content, where)
        elif key := _KEY.match(content):
            name = key[1].upper()
            if name in entries:
                raise InputError(
                    f"{where}: found {name} again, which line {entries[name].line} has too, expected it once"
                )
            entries[name] = Entry(_value(key[2], where), number, section)
        elif section:
            row = tuple(_number(part, where) for part in re.split(r"[\s,]+", _uncommented(content)))
            tables.setdefault(section, (number, []))[1].append(row)
        else:
            raise InputError(
                f"{where}: found '{quoted(content)}', expected a [SECTION], KEY = value, or a comment (! or $)"
            )
    if not entries:
        raise InputError(f"{source}: found no KEY = value, expected a file of tyre properties")
    return PropertyFile(source, entries, {name: (line, tuple(rows)) for name, (line, rows) in tables.items()})


def _section(content: str, where: str) -> str:
    name, bracket, _ = content[1:].partition("]")
    if not bracket or not name.strip():
        raise InputError(f"{where}: found '{quoted(content)}', expected a section such as [UNITS]")
    return name.strip().upper()


def _uncommented(text: str) -> str:
    return re.split(r"[$!]", text)[0].strip()


def _value(text: str, where: str) -> str:
    within = _QUOTED.match(text)
    value = (within[1] or within[2] or "").strip() if within else _uncommented(text)
    if not value and not within:
        raise InputError(f"{where}: found nothing behind '=', expected a value")
    return value


def _number(text: str, where: str) -> float:
    try:
        value = float(re.sub("[dD]", "e", text))
    except ValueError:
        raise InputError(f"{where}: found '{quoted(text)}', expected a number") from None
    if not math.isfinite(value):
        raise InputError(f"{where}: found '{quoted(text)}', expected a finite number")
    return value
