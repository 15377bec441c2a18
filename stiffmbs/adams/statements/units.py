"""Units of a dataset.  MSC Adams/Solver, UNITS statement."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeVar

from ...reading.units.quantity import quantity
from .arguments import Arguments
from .text import Statement

Meaning = TypeVar("Meaning")

_KINDS = {
    "FORCE": {
        "NEWTON": "N", "KNEWTON": "kN", "MEGANEWTON": "MN", "CENTINEWTON": "cN", "MILLINEWTON": "mN",
        "MICRONEWTON": "1e-6 N", "NANONEWTON": "1e-9 N", "DYNE": "1e-5 N", "KILOGRAM_FORCE": "kgf",
        "POUND_FORCE": "lbf", "KPOUND_FORCE": "1e3 lbf", "OUNCE_FORCE": "0.0625 lbf", "POUNDAL": "1 lb*ft/s^2",
    },
    "MASS": {
        "KILOGRAM": "kg", "GRAM": "g", "MILLIGRAM": "mg", "MICROGRAM": "1e-9 kg", "NANOGRAM": "1e-12 kg",
        "TONNE": "tonne", "POUND_MASS": "lb", "KPOUND_MASS": "1e3 lb", "OUNCE_MASS": "oz", "SLUG": "slug",
        "SLINCH": "12 slug", "US_TON": "2e3 lb",
    },
    "LENGTH": {
        "METER": "m", "MILLIMETER": "mm", "CENTIMETER": "cm", "KILOMETER": "km", "MICROMETER": "um",
        "NANOMETER": "1e-9 m", "ANGSTROM": "1e-10 m", "INCH": "inch", "FOOT": "ft", "YARD": "yd", "MILE": "mile",
        "MILS": "1e-3 inch", "MICROINCH": "1e-6 inch",
    },
    "TIME": {
        "SECOND": "s", "MILLISECONDS": "ms", "MICROSECOND": "us", "NANOSECOND": "1e-9 s", "MINUTE": "min", "HOUR": "h",
        "DAY": "day",
    },
}  # fmt: skip
"""Units in those of scenes."""


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
    "MKS": ("N", "kg", "m", "s"),
    "CGS": ("1e-5 N", "g", "cm", "s"),
    "FPS": ("lbf", "lb", "ft", "s"),
    "IPS": ("lbf", "lb", "inch", "s"),
    "NONE": ("N", "kg", "m", "s"),
}


def read_units(statement: Statement) -> Units:
    """Read a UNITS statement. Raises DatasetFault if a unit is unknown, or some of the four are missing."""
    found = Arguments(statement, "UNITS", (*_KINDS, "SYSTEM", "UCF"))
    if found.one_of("SYSTEM", "UCF") == "SYSTEM":
        return Units(*map(_factor, _named(found, "SYSTEM", _SYSTEMS)))
    if "UCF" in found:
        return Units(force=found.positive("UCF") or 1.0)
    missing = [kind for kind in _KINDS if kind not in found]
    if missing:
        raise found.fault(f"found no {', no '.join(missing)}, expected {', '.join(_KINDS)}, or SYSTEM, or UCF")
    return Units(*(_factor(_named(found, kind, units)) for kind, units in _KINDS.items()))


def _factor(text: str) -> float:
    return quantity(text if text[0].isdigit() else f"1 {text}").value


def _named(found: Arguments, kind: str, known: Mapping[str, Meaning]) -> Meaning:
    """Return the value of a possibly abbreviated name."""
    word = (found.text(kind) or "").upper()
    for name, unit in known.items():
        if word and name.startswith(word):
            return unit
    raise found.fault(f"found {kind} = {found.text(kind)}, expected one of {', '.join(known)}", kind)
