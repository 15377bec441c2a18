"""Files of tyre properties (.tir) of Adams/Tire and MF-Tyre: sections of keys and values, with units."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ...errors import InputError
from ...reading.files.quoted import quoted
from ...reading.files.requested import Fields
from ...reading.files.text_file import file_text, finite_number, lines
from ...reading.units.units import UNITS as SI
from . import names

if TYPE_CHECKING:
    from .magic_formula import Formula

_NAMES = {
    "LENGTH": {"m": "meter meters m", "mm": "mm millimeter millimeters", "cm": "cm centimeter", "km": "km kilometer", "inch": "inch inches in", "ft": "foot feet ft"},
    "FORCE": {"N": "newton newtons n", "kN": "kn knewton kilonewton", "kgf": "kg_force kgf", "lbf": "pound_force lbf"},
    "ANGLE": {"rad": "radian radians rad", "deg": "degree degrees deg"},
    "MASS": {"kg": "kg kilogram", "g": "gram", "tonne": "tonne", "lb": "pound_mass", "slug": "slug"},
    "TIME": {"s": "second seconds sec s", "ms": "millisecond", "min": "minute", "h": "hour"},
    "PRESSURE": {"Pa": "pascal pa", "kPa": "kpascal kpa", "MPa": "mpascal mpa", "psi": "psi", "bar": "bar"},
}  # fmt: skip
"""Names in Adams/Tire of the units of scenes."""
UNITS = {
    kind: {word: SI[unit].value for unit, words in units.items() for word in words.split()}
    for kind, units in _NAMES.items()
}
"""Units of a file in SI units, by their names in Adams/Tire, case-insensitive."""
FRACTIONS: Mapping[str, tuple[str, str]] = {
    "": ("", ""), "length": ("LENGTH", ""), "force": ("FORCE", ""), "angle": ("ANGLE", ""), "velocity": ("LENGTH", "TIME"),
    "stiffness": ("FORCE", "LENGTH"), "damping": ("FORCE TIME", "LENGTH"), "pressure": ("FORCE", "LENGTH LENGTH"),
    "per length": ("", "LENGTH"), "mass": ("MASS", ""), "force per angle": ("FORCE", "ANGLE"),
}  # fmt: skip
"""Units whose product makes a dimension, and those that divide it."""


def composed_of(dimension: str, units: Iterable[str]) -> tuple[list[str], list[str]]:
    """Return the units whose product makes a dimension, and those that divide it.

    `units`: those of the file; a pressure has its own unit, or that of a force on an area.
    """
    product, divisor = FRACTIONS[dimension] if dimension != "pressure" or "PRESSURE" not in units else ("PRESSURE", "")
    return product.split(), divisor.split()


_KEY = re.compile(r"^\s*([A-Za-z_]\w*)\s*=\s*(.*)$")
_TEXT = re.compile(r"""^(['"])(?!.*\1\s*=).*\1$""")
_QUOTED = re.compile(r"^'([^']*)'|^\"([^\"]*)\"")


@dataclass(frozen=True)
class Entry:
    """Value of a key: text without quotes and comment, which may be empty, line, and section."""

    text: str
    line: int
    section: str

    def __str__(self) -> str:
        return self.text


@dataclass(frozen=True)
class Rows:
    """Rows of numbers after a heading in braces, and the line of the first row."""

    line: int
    numbers: tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class PropertyFile:
    """Content of a property file."""

    source: str  # name of the file in messages
    sections: Mapping[str, Fields[Entry]]  # keys of each section, in capital letters
    tables: Fields[Rows]  # tables by section

    def entry(self, key: str, home: str = "") -> Entry | None:
        """Return the entry of a key, or None.

        `home`: section to which the key belongs; it is used if several sections have the key. Raises InputError if
        sections to which the key does not belong give it different values.
        """
        having = [section for section in self.sections.values() if section.has(key)]
        own = [section for section in having if section.kind == f"[{home}]"]
        found = [section[key] for section in own or having]
        if not found:
            return None
        for other in found[1:]:
            if other.text != found[0].text:
                raise InputError(
                    f"{self.source}, line {other.line}: found {key} in [{other.section}] and in [{found[0].section}] "
                    f"(line {found[0].line}), expected it in one section" + (f", [{home}]" if home else "")
                )
        return found[0]

    def text(self, key: str, home: str = "") -> str:
        """Return a value in capital letters, or an empty string if there is none."""
        entry = self.entry(key, home)
        return entry.text.upper() if entry else ""

    def number(self, key: str, dimension: str = "", home: str = "") -> float:
        """Return a value in SI units.

        Raises InputError if the value is missing or not a number.
        """
        entry = self.entry(key, home)
        if entry is None:
            raise InputError(f"{self.source}: found no {key}, expected one" + (f" in [{home}]" if home else ""))
        if not entry.text:
            raise InputError(f"{self.source}, line {entry.line}: found no value after '=' of {key}, expected a number")
        return finite_number(entry.text, f"{self.source}, line {entry.line}: {key}") * self.factor(dimension)

    def factor(self, dimension: str) -> float:
        """Return the file's unit of a dimension in SI units; 1 if the file has no [UNITS].

        Raises InputError for an unknown unit.
        """
        product, divisor = map(self._units, composed_of(dimension, self.sections.get("UNITS", ())))
        return math.prod(product) * math.prod(unit**-1 for unit in divisor)

    def _units(self, kinds: Sequence[str]) -> Iterator[float]:
        """Yield the file's units of length, force and so on, SI units."""
        units: Mapping[str, Entry] = self.sections.get("UNITS", {})
        for entry, kind in ((units[kind], kind) for kind in kinds if kind in units):
            known = UNITS[kind]
            if entry.text.lower() not in known:
                raise InputError(
                    f"{self.source}, line {entry.line}: {kind}: found the unit '{quoted(entry.text)}', expected one of "
                    f"{', '.join(known)}"
                )
            yield known[entry.text.lower()]


def read_property_file(path: Path) -> PropertyFile:
    """Read a file of tyre properties.

    Raises InputError if it cannot be read, or a line is neither a section, a key with a value, a row of numbers nor a
    comment.
    """
    return parse_properties(file_text(path, otherwise="latin-1", expected="a tyre property file"), str(path))


def parse_properties(text: str, source: str) -> PropertyFile:
    """Return the properties in the text of a file; errors as for `read_property_file`."""
    sections: dict[str, dict[str, Entry]] = {}
    rows: dict[str, tuple[int, list[tuple[float, ...]]]] = {}
    section = ""
    for number, line in enumerate(lines(text), start=1):
        content = line.strip()
        where = f"{source}, line {number}"
        if not content or content[0] in "!$#{(" or _TEXT.match(content):
            continue
        if content.startswith("["):
            section = _section(content, where)
        elif key := _KEY.match(content):
            name, own = key[1].upper(), sections.setdefault(section, {})
            entry = Entry(_value(key[2]), number, section)
            if own.setdefault(name, entry).text != entry.text:
                raise InputError(f"{where}: found {name} again, which line {own[name].line} has too, expected it once")
        elif section:
            row = tuple(finite_number(part, where) for part in re.split(r"[\s,]+", _uncommented(content)))
            rows.setdefault(section, (number, []))[1].append(row)
        else:
            raise InputError(
                f"{where}: found '{quoted(content)}', expected a [SECTION], KEY = value, or a comment (! or $)"
            )
    if not sections:
        raise InputError(f"{source}: found no KEY = value, expected a file of tyre properties")
    tables = {f"[{name}]": Rows(line, tuple(numbers)) for name, (line, numbers) in rows.items()}
    found = {name: Fields(f"[{name}]", "", own, names.DEFAULT_VALUES) for name, own in sections.items()}
    if "UNITS" in found:
        found["UNITS"].request(*UNITS)  # including unused dimensions
    return PropertyFile(source, found, Fields("table", "", tables))


def _section(content: str, where: str) -> str:
    name, bracket, _ = content[1:].partition("]")
    if not bracket or not name.strip():
        raise InputError(f"{where}: found '{quoted(content)}', expected a section such as [UNITS]")
    return name.strip().upper()


def _uncommented(text: str) -> str:
    return re.split(r"[$!#]", text)[0].strip()


def _value(text: str) -> str:
    within = _QUOTED.match(text)
    return (within[1] or within[2] or "").strip() if within else _uncommented(text)


UNLIMITED = 1e12
"""Largest load of a file without FZMAX, N."""
NOMINAL_PRESSURE = 2e5
"""Nominal pressure of a file without NOMPRES, Pa."""


@dataclass(frozen=True)
class Version:
    """Version of the Magic Formula, or Fiala's formula."""

    name: str
    dimensions: Mapping[str, str]  # numbers that are neither coefficients nor scale factors, with their dimensions
    defaults: Mapping[str, float]  # default values; numbers without one are required
    largest: tuple[int, int, int]  # largest digits of USE_MODE: contact method, dynamics, slip
    required: tuple[str, ...] = names.REQUIRED  # numbers that a tyre must have
    may_vanish: tuple[str, ...] = ()  # required numbers that may be zero
    vertical: str = "VERTICAL"  # section of the vertical stiffness and damping

    @property
    def numbers(self) -> tuple[str, ...]:
        """Names of all numbers."""
        return tuple(dict.fromkeys((*self.defaults, *self.dimensions)))

    def home(self, name: str) -> str:
        """Return the section of a property file that a key belongs to."""
        section = names.home(name)
        return self.vertical if section == "VERTICAL" else section

    def has_mode(self, mode: float) -> bool:
        """Return True if a USE_MODE has valid digits; a negative one mirrors a tyre of the Magic Formula."""
        valid = all(digit <= most for digit, most in zip(digits(mode), self.largest, strict=True)) and mode % 1 == 0
        return valid and (self.is_magic or (mode > 0 and digits(mode)[2] > 0))

    @property
    def is_magic(self) -> bool:
        """True for the Magic Formula."""
        return self.name != "Fiala"

    @property
    def is_6(self) -> bool:
        """True for 6.1 and 6.2, whose contact depends on the forces along the road."""
        return "NOMPRES" in self.dimensions

    @property
    def equations(self) -> Formula:
        """Equations of the forces, whose import loads SymPy."""
        from . import fiala, magic_formula, magic_formula_6

        later = magic_formula_6.FORMULA
        return {"5.2": magic_formula.FORMULA, "Fiala": fiala.FORMULA}.get(self.name, later)


_OF_5 = {
    **dict.fromkeys((*names.COEFFICIENTS, *names.OF_PRESSURE, *names.OF_PAC2002), 0.0),
    **dict.fromkeys((*names.SCALES, "LIP"), 1.0), "VERTICAL_STIFFNESS": math.nan, "VERTICAL_DAMPING": 0.0, "BREFF": 0.0, "DREFF": 0.0, "FREFF": 1 / 3, "LONGVL": 16.7, "FZMAX": UNLIMITED, "PTY2": 1.0,
}  # fmt: skip
"""Default values; a tyre without VERTICAL_STIFFNESS has no deflection and radii, and FREFF gives the unloaded radius less a third of the deflection as rolling radius."""
_OF_6 = {
    **dict.fromkeys((*names.COEFFICIENTS_6, *names.DIMENSIONS_6), 0.0), **dict.fromkeys(names.SCALES_6, 1.0),
    "LMUV": 0.0, "VERTICAL_STIFFNESS": math.nan, "FREFF": 1 / 3, "LONGVL": 16.7, "FZMAX": UNLIMITED, "INFLPRES": 0.0, "NOMPRES": NOMINAL_PRESSURE, "Q_RE0": 1.0,
    "PKY4": names.AS_BEFORE["PKY4"], "QSY7": names.AS_BEFORE["QSY7"], "PHYP1": 1.0, "QDRP1": 1.0,
}  # fmt: skip
"""Default values; those of omitted coefficients of 6.1 have the effect of MF-Tyre 5.2, INFLPRES = 0 means NOMPRES."""
_OF_FIALA = {
    **dict.fromkeys(("VERTICAL_DAMPING", "ROLLING_RESISTANCE", "RELAX_LENGTH_X", "RELAX_LENGTH_Y"), 0.0),
    "FZMAX": UNLIMITED, "LONGVL": 16.7,
}  # fmt: skip
VERSIONS = {
    version.name: version
    for version in (
        Version("5.2", {**names.DIMENSIONS, **names.PRESSURES}, _OF_5, (0, 2, 4)),
        Version("6.1", names.DIMENSIONS_6, _OF_6, (5, 3, 5)),
        Version("6.2", names.DIMENSIONS_6, _OF_6, (5, 3, 5)),
        Version("Fiala", names.FIALA, _OF_FIALA, (0, 1, 2), names.FIALA_REQUIRED, ("WIDTH", "UMIN"), "PARAMETER"),
    )
}
OF_FITTYP = {
    **dict.fromkeys(("5", "6", "50", "51", "52", "MF52", "PAC2002"), "5.2"),
    **dict.fromkeys(("60", "61", "MF61"), "6.1"), **dict.fromkeys(("62", "MF62"), "6.2"),
}  # fmt: skip
"""Version by FITTYP; version 6.1 includes files of 6.0."""
OF_FORMAT = {
    **dict.fromkeys(("PAC2002", "MF05", "MFTYRE", "MF52", "52"), "5.2"),
    **dict.fromkeys(("MF61", "61"), "6.1"), **dict.fromkeys(("MF62", "62"), "6.2"), "FIALA": "Fiala", "USER": "",
}  # fmt: skip
"""Version by PROPERTY_FILE_FORMAT; empty if FITTYP states it."""


def plain(word: object) -> str:
    """Return a name of a version without punctuation, such as MF52 for 'MF_5.2'."""
    return "".join(letter for letter in str(word).upper() if letter.isalnum())


def digits(mode: float) -> tuple[int, int, int]:
    """Return contact method, dynamics and slip by the digits of a USE_MODE of either sign."""
    hundreds, rest = divmod(int(abs(mode)), 100)
    return hundreds, *divmod(rest, 10)
