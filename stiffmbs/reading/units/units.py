"""Dimensions, units, and numbers with a dimension."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

Dimension = tuple[float, ...]
"""Exponents of kg, m and s; angles have none."""
BASE = ("kg", "m", "s")
ANY = "value"


@dataclass(frozen=True)
class Quantity:
    """Value in SI units with its dimension; a plain number (`dimension` None) fits every dimension."""

    value: float
    dimension: Dimension | None = None


def _exponents(unit: str, known: Mapping[str, Quantity]) -> Dimension:
    """Return the dimension of a unit such as ``kg m/s^2``, in base units and units that are known."""
    found = [0.0] * len(BASE)
    for sign, part in zip((1.0, -1.0), unit.split("/"), strict=False):
        for word in part.split():
            name, _, power = word.partition("^")
            of_name = known[name].dimension if name in known else [float(name == base) for base in BASE]
            for k, exponent in enumerate(of_name or ()):
                found[k] += sign * float(power or 1) * exponent
    return tuple(found)


def _units() -> dict[str, Quantity]:
    table: dict[str, dict[str, float]] = {
        "m": {
            "m": 1, "um": 1e-6, "mm": 1e-3, "cm": 1e-2, "dm": 0.1, "km": 1e3, "inch": 0.0254, "ft": 0.3048, "yd": 0.9144,
            "mile": 1609.344,
        },
        "s": {"s": 1, "us": 1e-6, "ms": 1e-3, "min": 60, "h": 3600, "day": 86400},
        "kg": {"kg": 1, "g": 1e-3, "mg": 1e-6, "tonne": 1e3, "lb": POUND, "oz": POUND / 16, "slug": POUND * G0 / 0.3048},
        "kg m/s^2": {
            "N": 1, "mN": 1e-3, "cN": 1e-2, "daN": 10, "kN": 1e3, "MN": 1e6, "kgf": G0, "lbf": 4.4482216152605,
        },
        "kg m^2/s^2": {"J": 1, "mJ": 1e-3, "kJ": 1e3, "MJ": 1e6},
        "kg m^2/s^3": {"W": 1, "mW": 1e-3, "kW": 1e3, "MW": 1e6},
        "m/s": {"mph": 0.44704},
        "m/s^2": {"g0": G0},
        "kg/m s^2": {"Pa": 1, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9, "bar": 1e5, "psi": 4.4482216152605 / 0.0254**2},
        "1": {"rad": 1, "mrad": 1e-3, "deg": math.pi / 180, "rev": 2 * math.pi},
        "1/s": {"rpm": math.pi / 30, "Hz": 1, "kHz": 1e3},
    }  # fmt: skip
    return {
        name: Quantity(value, _exponents(unit, {})) for unit, names in table.items() for name, value in names.items()
    }


POUND: Final = 0.45359237
"""Pound, kg."""
G0: Final = 9.80665
"""Standard gravity, m/s^2."""
UNITS = _units()
NONE = "no unit"
CONSTANTS = {"pi": Quantity(math.pi)}
NUMBER = _exponents("1", UNITS)
DIMENSIONS: dict[str, tuple[Dimension, str]] = {
    name: (_exponents(unit, UNITS), unit)
    for name, unit in {
        ANY: "SI units", "number": "1", "angle": "rad", "length": "m", "time": "s", "mass": "kg", "moment of inertia": "kg m^2",
        "velocity": "m/s", "angular velocity": "rad/s", "frequency": "Hz", "acceleration": "m/s^2", "angular acceleration": "rad/s^2",
        "area": "m^2", "second moment of area": "m^4", "density": "kg/m^3", "curvature": "rad/m", "bending stiffness": "N m^2",
        "mass per length": "kg/m", "inertia per length": "kg m", "force": "N", "pressure": "N/m^2", "torque": "N m", "stiffness": "N/m",
        "damping": "N s/m", "torsional stiffness": "N m/rad", "torsional damping": "N m s/rad", "coupling stiffness": "N/rad",
        "coupling damping": "N s/rad",
    }.items()
}  # fmt: skip
"""Dimension and unit of the fields of elements, by name."""


SPELLED = {
    "t": "tonne", "lbs": "lb", "sec": "s", "second": "s", "hr": "h", "hour": "h", "degree": "deg", "radian": "rad", "meter": "m", "metre": "m",
    "newton": "N", "\u03bcm": "um", "kph": "km/h", "kmh": "km/h", "revs": "rev",
}  # fmt: skip
"""Units as scenes write them, by other spellings in the singular."""


def unit_of_spelling(name: str) -> str:
    """Return a unit as scenes write it, by another spelling such as ``Nm``, ``mm2`` or ``degrees``; empty if unknown."""
    lower = name.casefold()
    for each in (lower, lower.removesuffix("s")):
        if each in SPELLED:
            return SPELLED[each]
    power = re.fullmatch(r"(.+)([2-4])", name)
    if power and power[1] in UNITS:
        return f"{power[1]}^{power[2]}"
    products = (f"{name[:k]} {name[k:]}" for k in range(1, len(name)) if name[:k] in UNITS and name[k:] in UNITS)
    return next(products, "")


def one(dimension: str) -> str:
    """Return a value of a dimension for a message: ``a length``, ``an angle``."""
    return f"{'an' if dimension[0] in 'aeio' else 'a'} {dimension}"


def in_units(dimension: Dimension) -> str:
    """Return a dimension as powers of SI units, for messages: ``kg m^2``."""
    powers = [(name, power) for name, power in zip(BASE, dimension, strict=True) if power]
    return " ".join(name if power == 1 else f"{name}^{power:g}" for name, power in powers) or NONE


def named_unit(dimension: Dimension) -> str:
    """Return the named unit of a dimension for messages: ``N m``; otherwise as `in_units`."""
    if any(dimension):
        for known, unit in DIMENSIONS.values():
            if known == dimension and "/rad" not in unit:
                return unit
    return in_units(dimension)


def in_its_unit(dimension: Dimension) -> str:
    """Return the adverbial of a found value in a message: ``in N m``, or ``without a unit``."""
    return f"in {named_unit(dimension)}" if any(dimension) else "without a unit"


def in_text(quantity: Quantity) -> float | str:
    """Return a quantity in the form of a scene, in SI units: its number, or text with its unit."""
    if quantity.dimension is None:
        return quantity.value
    return f"{quantity.value!r} {in_units(quantity.dimension) if any(quantity.dimension) else 'rad'}"
