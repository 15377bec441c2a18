"""Fields of a tyre property file that are not single numbers, and checks of its numbers for wrong units and signs."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any, Final

from pydantic import Field

from ...errors import InputError, prefixed
from ...reading.files.quoted import quoted
from ...reading.table import Table
from ..element import Component
from .names import AS_BEFORE, LATER, OF_PAC2002, OF_PRESSURE, PRESSURES, RANGES, home
from .property_file import OF_FITTYP, OF_FORMAT, VERSIONS, PropertyFile, Version, digits, plain

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

    Raises InputError if it is unknown, or 5.2 without FITTYP and with coefficients that neither MF-Tyre 5.2 nor PAC2002
    has.
    """
    form, kind = file.text("PROPERTY_FILE_FORMAT"), file.text("FITTYP", "MODEL")
    if form and plain(form) not in OF_FORMAT:
        raise InputError(
            f"{_where(file, 'PROPERTY_FILE_FORMAT')}: found the format '{quoted(form)}', expected PAC2002, MF-Tyre or Fiala "
            "(PAC2002, MF_05, MF-TYRE, MF_52, MF_61, MF_62, FIALA)"
        )
    of_format = OF_FORMAT[plain(form)] if form else ""
    if kind and of_format != "Fiala":
        name = _whole(kind)
        if name not in OF_FITTYP:
            raise InputError(
                f"{_where(file, 'FITTYP')}: found FITTYP = {quoted(kind)}, expected that of MF-Tyre 5.2 (5, 6, 50, 52), "
                "6.1 (60, 61) or 6.2 (62)"
            )
        older = ["FITTYP = 60: the file of version 6.0 is evaluated by the formula of 6.1"] if name == "60" else []
        return OF_FITTYP[name], older
    if of_format not in ("", "5.2"):
        return of_format, []
    pac2002 = is_pac2002(file)
    own = {*read_names(file, VERSIONS["5.2"])}
    for name in (name for name in LATER if name not in own):
        if file.entry(name, home(name)) and file.number(name, home=home(name)) != AS_BEFORE[name]:
            more = ", or IP_NOM of PAC2002" if pac2002 and name in OF_PRESSURE else ""
            why = " that is not modelled in PAC2002" if pac2002 and not more else ""
            raise InputError(
                f"{_where(file, name)}: found {name} without FITTYP, a coefficient of Magic Formula 6.0 or later{why}, expected "
                f"FITTYP = 61 or 62, or FITTYP = 5 where {name} has no effect{more}"
            )
    return "5.2", []


def is_pac2002(file: PropertyFile) -> bool:
    """Return True for a file of PAC2002 by its format."""
    return plain(file.text("PROPERTY_FILE_FORMAT")) == "PAC2002"


def depends_on_pressure(file: PropertyFile) -> bool:
    """Return True for a file of PAC2002 with a nominal pressure."""
    return is_pac2002(file) and any(section.has("IP_NOM") for section in file.sections.values())


def read_names(file: PropertyFile, formula: Version) -> Iterator[str]:
    """Yield the names of the numbers that are read from a file."""
    unread = {
        *(() if depends_on_pressure(file) else (*OF_PRESSURE, *PRESSURES)),
        *(() if is_pac2002(file) else OF_PAC2002),
    }
    yield from (name for name in formula.numbers if formula.is_6 or name not in unread)


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
        if channel == "pressure" and not formula.is_6:
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
    with prefixed(f"{where}: "):
        return Table(table=tuple((length * deflection, force * load) for deflection, load in rows.numbers))


def bottoming_of(file: PropertyFile, formula: Version) -> Bottoming | None:
    """Return the contact of the rim, or None if the file has no curve or stiffness, or no radius."""
    if formula.is_6:
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
    if not formula.is_magic:
        return f"found USE_MODE = {mode:g}, expected 1 or 2 for steady slip, 11 or 12 for slip with relaxation lengths"
    more = ", 5 and 15 with turn slip" if formula.is_6 else ""
    return (
        f"found USE_MODE = {mode:g}, expected 0 to 4 for steady slip, 10 to 14 for slip with relaxation lengths{more}, or the "
        "negative of one of these for a mirrored tyre"
    )


REPLACED = {2: "nonlinear transient slip", 3: "rigid ring dynamics"}
"""Dynamics that relaxation lengths replace, by the second digit of USE_MODE."""


SMOOTHED: Final = 2
"""Last digit of USE_MODE of a Fiala tyre whose forces rise over the first tenth of a second."""


def replaced_digits(mode: int, lags: bool, formula: Version) -> Iterator[str]:
    """Yield a sentence for each digit of USE_MODE that is replaced; `lags`: there are relaxation lengths."""
    contact, dynamics, slip = digits(mode)
    if not formula.is_magic and slip == SMOOTHED:
        yield f"USE_MODE = {mode} asks for forces that rise at the start of a run: they act in full, as with {mode - 1}"
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


PLAUSIBLE = {
    "UNLOADED_RADIUS": (0.01, 5.0), "FNOMIN": (10.0, 2e6), "LONGVL": (0.1, 200.0), "VERTICAL_DAMPING": (0.0, math.inf),
    **dict.fromkeys(("INFLPRES", "NOMPRES", "IP", "IP_NOM"), (1e4, 5e6)), **dict.fromkeys(("UMAX", "UMIN"), (0.0, 10.0)),
}  # fmt: skip
"""Ranges of numbers in SI units, from tyres of models to those of aircraft and mine trucks; other numbers have wrong units."""
PRESSED = (1e-3, 1.0)
"""Range of the deflection by FNOMIN, unloaded radii: a rim that is nearly rigid, and one that lies on the road."""
RELAXED = (0.01, 10.0)
"""Range of relaxation lengths of a Fiala tyre, unloaded radii; Adams' own files in mm have such of 0.05."""
WIDEST = 5.0
"""Largest width of a Fiala tyre, unloaded radii; that of a drag racing tyre is about 1.2."""
SLIDING = (math.radians(1), math.radians(60))
"""Range of the slip angle from which a Fiala tyre slides at its nominal load, rad; racing tyres slide from 5 deg."""
SLIGHTLY = 0.05
"""Deflection by the nominal load of a tyre without FNOMIN, unloaded radii; of a car's tyre at rest."""
NARROW = math.radians(2)
"""Slip angle, rad, that valid ranges of tyres exceed; radians read as degrees lie within it."""
UNIT_OF = {"": "", "length": "m", "force": "N", "pressure": "Pa", "velocity": "m/s", "damping": "N s/m"}


def check_numbers(file: PropertyFile, formula: Version, found: Mapping[str, float]) -> None:
    """Refuse numbers of a file, in SI units, that follow from wrong units or from the signs of other axes.

    Raises InputError; the message contains the line.
    """
    for name, limits in PLAUSIBLE.items():
        if name in found and not (name == "INFLPRES" and found[name] == 0):  # 0 stands for NOMPRES
            _check_range(file, formula, name, found[name], limits)
    (_check_magic if formula.is_magic else _check_fiala)(file, formula, found)


def _check_range(
    file: PropertyFile, formula: Version, name: str, value: float, limits: tuple[float, float], more: str = ""
) -> None:
    least, most = limits
    if not least <= value <= most:
        unit = f" {UNIT_OF[formula.dimensions.get(name, '')]}".rstrip()
        expected = f"{least:g} to {most:g}{unit}" if math.isfinite(most) else f"{least:g}{unit} or more"
        raise _fault(file, formula, name, f", {value:g}{unit} by [UNITS], expected {expected}{more}")


def _fault(file: PropertyFile, formula: Version, name: str, sentence: str) -> InputError:
    entry = file.entry(name, formula.home(name))
    assert entry is not None
    return InputError(f"{file.source}, line {entry.line}: found {name} = {entry.text}{sentence}")


def _check_magic(file: PropertyFile, formula: Version, found: Mapping[str, float]) -> None:
    deflection = found["FNOMIN"] / found.get("VERTICAL_STIFFNESS", math.nan)
    least, most = (ratio * found["UNLOADED_RADIUS"] for ratio in PRESSED)
    if deflection < least or deflection > most:
        sentence = f", by which FNOMIN deflects the tyre by {deflection:.3g} m, expected {least:.3g} to {most:.3g} m"
        raise _fault(file, formula, "VERTICAL_STIFFNESS", sentence)
    if found["PKX1"] < 0:
        raise _fault(file, formula, "PKX1", ", expected a slip stiffness above zero")
    peak = found.get("PKY4", AS_BEFORE["PKY4"]) * math.atan(1 / found["PKY2"])
    if found["PKY1"] * math.sin(peak) > 0:
        sentence = ", the cornering stiffness of SAE axes, expected the sign of ISO axes, below zero"
        raise _fault(file, formula, "PKY1", sentence)


def nominal_load(numbers: Mapping[str, float]) -> float:
    """Return FNOMIN, N, or the load at a usual deflection of a tyre without it."""
    return numbers.get("FNOMIN") or SLIGHTLY * numbers["UNLOADED_RADIUS"] * numbers["VERTICAL_STIFFNESS"]


def _check_fiala(file: PropertyFile, formula: Version, found: Mapping[str, float]) -> None:
    load, (least, most) = nominal_load(found), PLAUSIBLE["FNOMIN"]
    if not least <= load <= most:
        sentence = f", by which {load:.3g} N deflect the tyre by {SLIGHTLY:g} radii, expected {least:g} to {most:g} N"
        raise _fault(file, formula, "VERTICAL_STIFFNESS", sentence)
    if found["UMIN"] > found["UMAX"]:
        raise _fault(file, formula, "UMIN", f", expected at most UMAX = {found['UMAX']:g}")
    sliding, (least, most) = math.atan(3 * found["UMAX"] * load / found["CALPHA"]), SLIDING
    if not least <= sliding <= most:
        sentence = f", by which the tyre slides from {math.degrees(sliding):.2g} deg, expected {math.degrees(least):g} to {math.degrees(most):g} deg"
        raise _fault(file, formula, "CALPHA", f"{sentence}: it is a force per angle of [UNITS]")
    radius = found["UNLOADED_RADIUS"]
    for name, most in (("WIDTH", WIDEST * radius), ("ROLLING_RESISTANCE", radius)):
        if name in found:
            _check_range(file, formula, name, found[name], (0.0, most))


def relaxation_of(
    file: PropertyFile, formula: Version, found: Mapping[str, float], mode: int | None
) -> Iterator[tuple[str, float, str]]:
    """Yield relaxation lengths of a Fiala tyre, m, with a note on those that are left out.

    The lengths are in the unit of the file. A file in mm may have them in m: such lengths are left out if USE_MODE
    does not ask for them.

    Raises InputError for lengths in a wrong unit, or below zero.
    """
    least, most = (part * found["UNLOADED_RADIUS"] for part in RELAXED)
    for name in ("RELAX_LENGTH_X", "RELAX_LENGTH_Y"):
        key = name if file.entry(name, formula.home(name)) else "RELAXATION_LENGTH"
        entry = file.entry(key, formula.vertical)
        if entry is None:
            continue
        length = file.number(key, "length", formula.vertical)
        if length == 0 or least <= length <= most:
            yield name, length, ""
        elif mode is None or digits(mode)[1]:
            _check_range(file, formula, key, length, (least, most), ", or USE_MODE = 1 of steady slip")
        else:
            wrong = f"{key} = {entry.text} is {length:g} m by [UNITS], outside {least:.3g} to {most:.3g} m"
            yield name, 0.0, f"{wrong}: steady slip does without it"


def doubts(file: PropertyFile, formula: Version, found: Mapping[str, object]) -> Iterator[str]:
    """Yield notes on sections that the file does not have, and on valid slip angles that may have another unit."""
    for name in RANGES["slip_angle"][:2]:
        entry, angle = file.entry(name), file.number(name, "angle") if file.entry(name) else math.inf
        if entry and abs(angle) < NARROW:
            yield (
                f"line {entry.line}: {name} = {entry.text} is {math.degrees(angle):.3g} deg by [UNITS], a narrow range of slip "
                "angles: its unit may be another one"
            )
    if "UNITS" not in file.sections:
        yield "there is no [UNITS]: numbers are taken as SI units"
    if formula.is_magic and "ALIGNING_COEFFICIENTS" not in {home(name) for name in found}:
        yield "there are no [ALIGNING_COEFFICIENTS]: the aligning torque is zero"
