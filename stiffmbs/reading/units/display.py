"""Units in which results are shown: deg, mm or kN in place of SI units, chosen by dimension."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache

from ..did_you_mean import instead_of
from ..files.quoted import quoted
from ..formula.text import FormulaError
from .quantity import in_si, quantity
from .units import DIMENSIONS

SI = {
    name: DIMENSIONS[name][1]
    for name in (
        "angle", "length", "mass", "velocity", "angular velocity", "frequency", "acceleration", "angular acceleration", "force", "torque",
        "stiffness", "damping", "torsional stiffness", "torsional damping", "curvature", "pressure",
    )
} | {"energy": "J", "power": "W"}  # fmt: skip
"""SI units of channels by the dimensions that may be shown in other units."""
_SYMBOLS = {SI[name]: name for name in ("angle", "length", "mass", "force")}
"""Dimensions of the symbols within a unit such as ``N m/rad``."""
_UNIT = re.compile(r"[A-Za-z]+(\^\d)?( [A-Za-z]+(\^\d)?)*(/[A-Za-z]+(\^\d)?( [A-Za-z]+(\^\d)?)*)?")


@dataclass(frozen=True)
class DisplayUnits:
    """Units of results by dimension, as in ``units: {angle: deg, force: kN}``; SI units where none is chosen.

    Units of other dimensions follow: with ``length: mm``, a velocity is in mm/s, unless a unit of velocity is chosen.
    """

    chosen: Mapping[str, str] = field(default_factory=dict)

    def of(self, unit: str) -> tuple[str, float]:
        """Return the unit in which a quantity is shown, by its SI unit, and the factor of its SI values."""
        dimension = next((name for name, own in SI.items() if own == unit and name in self.chosen), None)
        if dimension:
            return self.chosen[dimension], 1.0 / _size(self.chosen[dimension])
        parts, factor = unit.split("/"), 1.0
        for k, part in enumerate(parts):
            words = part.split()
            for n, word in enumerate(words):
                symbol, mark, power = word.partition("^")
                other = self.chosen.get(_SYMBOLS.get(symbol, ""), symbol)
                if other != symbol and other.isalpha():  # km/h has no place within another unit
                    words[n] = other + mark + power
                    factor *= _size(other) ** (float(power or 1) * (1 if k else -1))
            parts[k] = " ".join(words)
        return "/".join(parts), factor


SI_UNITS = DisplayUnits()
"""SI units everywhere."""


@cache
def _size(unit: str) -> float:
    """Return a unit in SI units."""
    return quantity(f"1 {unit}").value


def checked_units(found: Mapping[str, str]) -> dict[str, str]:
    """Return units by dimension; a FormulaError names an unknown dimension, or a unit of another one."""
    units = {}
    for name, unit in found.items():
        dimension = name.replace("_", " ")
        if dimension not in SI:
            raise FormulaError(f"found '{quoted(name)}'{instead_of(name, SI)}")
        if not _UNIT.fullmatch(unit):
            raise FormulaError(f"{name}: found '{quoted(unit)}', expected a unit, such as {SI[dimension]}")
        if dimension in DIMENSIONS:
            in_si(f"1 {unit}", dimension)
        elif quantity(f"1 {unit}").dimension != quantity(f"1 {SI[dimension]}").dimension:
            raise FormulaError(f"{name}: found '{unit}', expected a unit of {dimension}, such as {SI[dimension]}")
        units[dimension] = unit
    return units
