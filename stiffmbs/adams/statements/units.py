"""Units of a dataset.  MSC Adams/Solver, UNITS statement."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .arguments import Arguments
from .text import Statement

POUND, G, FOOT = 0.45359237, 9.80665, 0.3048
_FORCES = {
    "NEWTON": 1.0, "KNEWTON": 1e3, "MEGANEWTON": 1e6, "CENTINEWTON": 1e-2, "MILLINEWTON": 1e-3, "MICRONEWTON": 1e-6,
    "NANONEWTON": 1e-9, "DYNE": 1e-5, "KILOGRAM_FORCE": G, "POUND_FORCE": POUND * G, "KPOUND_FORCE": 1e3 * POUND * G,
    "OUNCE_FORCE": POUND * G / 16, "POUNDAL": POUND * FOOT,
}  # fmt: skip
_MASSES = {
    "KILOGRAM": 1.0, "GRAM": 1e-3, "MILLIGRAM": 1e-6, "MICROGRAM": 1e-9, "NANOGRAM": 1e-12, "TONNE": 1e3,
    "POUND_MASS": POUND, "KPOUND_MASS": 1e3 * POUND, "OUNCE_MASS": POUND / 16, "SLUG": POUND * G / FOOT,
    "SLINCH": 12 * POUND * G / FOOT, "US_TON": 2e3 * POUND,
}  # fmt: skip
_LENGTHS = {
    "METER": 1.0, "MILLIMETER": 1e-3, "CENTIMETER": 1e-2, "KILOMETER": 1e3, "MICROMETER": 1e-6, "NANOMETER": 1e-9,
    "ANGSTROM": 1e-10, "INCH": FOOT / 12, "FOOT": FOOT, "YARD": 3 * FOOT, "MILE": 5280 * FOOT, "MILS": FOOT / 12e3,
    "MICROINCH": FOOT / 12e6,
}  # fmt: skip
_TIMES = {
    "SECOND": 1.0, "MILLISECONDS": 1e-3, "MICROSECOND": 1e-6, "NANOSECOND": 1e-9, "MINUTE": 60.0, "HOUR": 3600.0,
    "DAY": 86400.0,
}  # fmt: skip
_KINDS = {"FORCE": _FORCES, "MASS": _MASSES, "LENGTH": _LENGTHS, "TIME": _TIMES}


@dataclass(frozen=True)
class Units:
    """Factors from a dataset's units to SI."""

    force: float = 1.0
    mass: float = 1.0
    length: float = 1.0
    time: float = 1.0

    def of(self, force: float = 0, mass: float = 0, length: float = 0, time: float = 0) -> float:
        """Return the SI factor of a product of powers; exactly 1 for a dataset in SI."""
        return self.force**force * self.mass**mass * self.length**length * self.time**time


_SYSTEMS = {
    "MKS": Units(),
    "CGS": Units(1e-5, 1e-3, 1e-2, 1.0),
    "FPS": Units(POUND * G, POUND, FOOT, 1.0),
    "IPS": Units(POUND * G, POUND, FOOT / 12, 1.0),
    "NONE": Units(),
}


def read_units(statement: Statement) -> Units:
    """Read a UNITS statement.

    Raises
    ------
    DatasetFault
        If a unit is unknown, or some of the four are missing.
    """
    found = Arguments(statement, "UNITS", (*_KINDS, "SYSTEM", "UCF"))
    if found.one_of("SYSTEM", "UCF") == "SYSTEM":
        return _named(found, "SYSTEM", _SYSTEMS)
    if "UCF" in found:
        factor = found.number("UCF")
        if not factor or factor < 0:
            raise found.fault(f"found UCF = {found.text('UCF')}, expected a number above zero", found.line("UCF"))
        return Units(force=factor)
    missing = [kind for kind in _KINDS if kind not in found]
    if missing:
        raise found.fault(f"found no {', no '.join(missing)}, expected {', '.join(_KINDS)}, or SYSTEM, or UCF")
    force, mass, length, time = (_named(found, kind, units) for kind, units in _KINDS.items())
    return Units(force, mass, length, time)


def _named(found: Arguments, kind: str, known: dict[str, Any]) -> Any:
    """Return the value of a possibly abbreviated name."""
    word = (found.text(kind) or "").upper()
    for name, unit in known.items():
        if word and name.startswith(word):
            return unit
    raise found.fault(f"found {kind} = {found.text(kind)}, expected one of {', '.join(known)}", found.line(kind))
