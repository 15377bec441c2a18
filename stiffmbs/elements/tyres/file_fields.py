"""Fields of a tyre property file that are not single numbers: version, mode, curves and ranges."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from pydantic import Field

from ...errors import InputError
from ...reading.files.quoted import quoted
from ...reading.table import Table
from ..element import Component
from .names import AS_BEFORE, LATER, RANGES, home
from .property_file import OF_FITTYP, OF_FORMAT, PropertyFile, Version, digits, plain

SIDES = ("left", "right", "symmetric")
DEEP = 0.1
"""Second point of the linear curve of BOTTOM_STIFF, m; it is extrapolated."""


class Bottoming(Component):
    """Contact of the rim with the road: [BOTTOMING_CURVE] of PAC2002."""

    radius: float = Field(gt=0, description="BOTTOMING_RADIUS, m")
    width: float = Field(0.0, ge=0, description="WIDTH of the tyre, m; without it camber has no effect")
    load: Table = Field(description="force (N) over penetration (m)")


def version_of(file: PropertyFile) -> tuple[str, list[str]]:
    """Return the version of a file's formula by FITTYP, or by its format, and notes on it.

    Raises InputError if it is unknown, or 5.2 without FITTYP and with coefficients that MF-Tyre 5.2 does not have.
    """
    form, kind = file.text("PROPERTY_FILE_FORMAT"), file.text("FITTYP", "MODEL")
    if form and plain(form) not in OF_FORMAT:
        raise InputError(
            f"{_where(file, 'PROPERTY_FILE_FORMAT')}: found the format '{quoted(form)}', expected PAC2002 or MF-Tyre "
            "(PAC2002, MF_05, MF-TYRE, MF_52, MF_61, MF_62)"
        )
    if kind:
        name = _whole(kind)
        if name not in OF_FITTYP:
            raise InputError(
                f"{_where(file, 'FITTYP')}: found FITTYP = {quoted(kind)}, expected that of MF-Tyre 5.2 (5, 6, 50, 52), "
                "6.1 (60, 61) or 6.2 (62)"
            )
        older = ["FITTYP = 60: the file of version 6.0 is evaluated by the formula of 6.1"] if name == "60" else []
        return OF_FITTYP[name], older
    if (version := OF_FORMAT[plain(form)] if form else "") and version != "5.2":
        return version, []
    for name in LATER:
        if file.entry(name, home(name)) and file.number(name, home=home(name)) != AS_BEFORE[name]:
            raise InputError(
                f"{_where(file, name)}: found {name} without FITTYP, a coefficient of Magic Formula 6.0 or later, expected "
                f"FITTYP = 61 or 62, or FITTYP = 5 where {name} has no effect"
            )
    return "5.2", []


def _whole(kind: str) -> str:
    """Return a FITTYP as a whole number without decimals, or as a plain word."""
    try:
        number = float(kind)
    except ValueError:
        return plain(kind)
    return str(int(number)) if number.is_integer() else plain(kind) if number > 0 else kind


def _where(file: PropertyFile, name: str) -> str:
    entry = file.entry(name, home(name))
    return f"{file.source}, line {entry.line}" if entry else file.source


def ranges_of(file: PropertyFile, formula: Version) -> Iterator[tuple[str, tuple[float, float]]]:
    """Yield the valid ranges of the file by channel; a missing limit is infinite."""
    for channel, (least, most, dimension) in RANGES.items():
        if channel == "pressure" and not formula.has_pressure:
            continue
        ends = [file.number(name, dimension) if file.entry(name) else None for name in (least, most)]
        if ends != [None, None]:
            low, high = (-math.inf if ends[0] is None else ends[0]), (math.inf if ends[1] is None else ends[1])
            yield channel, (low, high)


def curve_of(file: PropertyFile, section: str) -> Table | None:
    """Return a curve of load (N) over deflection (m)."""
    rows = file.tables.get(f"[{section}]")
    if rows is None:
        return None
    where = f"{file.source}, line {rows.line}: [{section}]"
    if any(len(row) != 2 for row in rows.numbers):
        raise InputError(f"{where}: found a row without exactly two numbers, expected a deflection and a load")
    length, force = file.factor("length"), file.factor("force")
    try:
        return Table(table=tuple((length * deflection, force * load) for deflection, load in rows.numbers))
    except InputError as error:
        raise InputError(f"{where}: {error}") from None


def bottoming_of(file: PropertyFile, formula: Version) -> Bottoming | None:
    """Return the contact of the rim, or None if the file has no curve or stiffness, or no radius."""
    if formula.has_pressure:
        return _stiff_rim(file)
    if not file.entry("BOTTOMING_RADIUS", "DIMENSION"):
        return None
    load = curve_of(file, "BOTTOMING_CURVE")
    if load is None:
        return None
    width = file.number("WIDTH", "length", "DIMENSION") if file.entry("WIDTH", "DIMENSION") else 0.0
    return Bottoming(radius=file.number("BOTTOMING_RADIUS", "length", "DIMENSION"), width=width, load=load)


def belt_of(file: PropertyFile) -> float:
    """Return the factor of the belt's gyroscopic couple, kg."""
    given = ("QTZ1", ""), ("MBELT", "mass"), ("LGYR", "")
    if not all(any(section.has(name) for section in file.sections.values()) for name in ("QTZ1", "MBELT")):
        return 0.0
    return math.prod(file.number(name, unit, home(name)) for name, unit in given if file.entry(name, home(name)))


def _stiff_rim(file: PropertyFile) -> Bottoming | None:
    """Return the contact of the rim of 6.1 and 6.2 by RIM_RADIUS, BOTTOM_OFFST and BOTTOM_STIFF."""
    stiffness = file.number("BOTTOM_STIFF", "stiffness", "VERTICAL") if file.entry("BOTTOM_STIFF", "VERTICAL") else 0.0
    if stiffness <= 0 or not file.entry("RIM_RADIUS", "DIMENSION"):
        return None
    offset = file.number("BOTTOM_OFFST", "length", "VERTICAL") if file.entry("BOTTOM_OFFST", "VERTICAL") else 0.0
    radius = file.number("RIM_RADIUS", "length", "DIMENSION") + offset
    return Bottoming(radius=radius, load=Table(table=((0.0, 0.0), (DEEP, DEEP * stiffness))))


def mode_of(file: PropertyFile, formula: Version) -> int | None:
    """Return USE_MODE, or None if the file has none."""
    if not file.entry("USE_MODE", "MODEL"):
        return None
    mode = file.number("USE_MODE", home="MODEL")
    if not formula.has_mode(mode):
        raise InputError(f"{_where(file, 'USE_MODE')}: {wrong_mode(mode, formula)}")
    return int(mode)


def wrong_mode(mode: float, formula: Version) -> str:
    """Return a sentence on a USE_MODE that the formula does not have."""
    more = ", 5 and 15 with turn slip" if formula.has_pressure else ""
    return (
        f"found USE_MODE = {mode:g}, expected 0 to 4 for steady slip, 10 to 14 for slip with relaxation lengths{more}, or the "
        "negative of one of these for a mirrored tyre"
    )


REPLACED = {2: "nonlinear transient slip", 3: "rigid ring dynamics"}
"""Dynamics that relaxation lengths replace, by the second digit of USE_MODE."""


def replaced_digits(mode: int, lags: bool) -> Iterator[str]:
    """Yield a sentence for each digit of USE_MODE that is replaced; `lags`: there are relaxation lengths."""
    contact, dynamics, slip = digits(mode)
    if dynamics in REPLACED and lags:
        yield f"USE_MODE = {mode} asks for {REPLACED[dynamics]}: slips lag by relaxation lengths, as with {10 + slip}"
    if contact:
        yield f"USE_MODE = {mode} asks for contact method {contact}: the contact is that of the road and of `envelope`"


def side_of(file: PropertyFile) -> Any:
    """Return TYRESIDE, empty if the file has none."""
    side = file.text("TYRESIDE").lower()
    if side and side not in SIDES:
        raise InputError(
            f"{_where(file, 'TYRESIDE')}: found TYRESIDE = '{quoted(side)}', expected one of {', '.join(SIDES)}"
        )
    return side
