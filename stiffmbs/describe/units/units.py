"""Dimensions, units, and numbers with a dimension."""

from __future__ import annotations

import math
from dataclasses import dataclass

Dimension = tuple[float, float, float]  # exponents of kg, m, s; angles have none

NUMBER: Dimension = (0, 0, 0)
ANY = "value"
DIMENSIONS: dict[str, tuple[Dimension, str]] = {
    ANY: (NUMBER, "SI units"),
    "number": (NUMBER, "1"),
    "angle": (NUMBER, "rad"),
    "length": ((0, 1, 0), "m"),
    "time": ((0, 0, 1), "s"),
    "mass": ((1, 0, 0), "kg"),
    "moment of inertia": ((1, 2, 0), "kg m^2"),
    "velocity": ((0, 1, -1), "m/s"),
    "angular velocity": ((0, 0, -1), "rad/s"),
    "acceleration": ((0, 1, -2), "m/s^2"),
    "angular acceleration": ((0, 0, -2), "rad/s^2"),
    "area": ((0, 2, 0), "m^2"),
    "second moment of area": ((0, 4, 0), "m^4"),
    "force": ((1, 1, -2), "N"),
    "pressure": ((1, -1, -2), "N/m^2"),
    "torque": ((1, 2, -2), "N m"),
    "stiffness": ((1, 0, -2), "N/m"),
    "damping": ((1, 0, -1), "N s/m"),
    "torsional stiffness": ((1, 2, -2), "N m/rad"),
    "torsional damping": ((1, 2, -1), "N m s/rad"),
    "coupling stiffness": ((1, 1, -2), "N/rad"),
    "coupling damping": ((1, 1, -1), "N s/rad"),
}


@dataclass(frozen=True)
class Quantity:
    """Value in SI units with its dimension; a plain number (`dimension` None) fits every dimension."""

    value: float
    dimension: Dimension | None = None


def _units() -> dict[str, Quantity]:
    length, time, mass = (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)
    force, energy, power = (1.0, 1.0, -2.0), (1.0, 2.0, -2.0), (1.0, 2.0, -3.0)
    speed, acceleration, pressure, rate = (0.0, 1.0, -1.0), (0.0, 1.0, -2.0), (1.0, -1.0, -2.0), (0.0, 0.0, -1.0)
    table: dict[Dimension, dict[str, float]] = {
        length: {
            "m": 1, "um": 1e-6, "mm": 1e-3, "cm": 1e-2, "dm": 0.1, "km": 1e3, "inch": 0.0254, "ft": 0.3048, "yd": 0.9144,
            "mile": 1609.344,
        },
        time: {"s": 1, "us": 1e-6, "ms": 1e-3, "min": 60, "h": 3600, "day": 86400},
        mass: {"kg": 1, "g": 1e-3, "mg": 1e-6, "tonne": 1e3, "lb": POUND, "oz": POUND / 16, "slug": POUND * G0 / 0.3048},
        force: {
            "N": 1, "mN": 1e-3, "cN": 1e-2, "daN": 10, "kN": 1e3, "MN": 1e6, "kgf": G0, "lbf": 4.4482216152605,
        },
        energy: {"J": 1, "mJ": 1e-3, "kJ": 1e3, "MJ": 1e6},
        power: {"W": 1, "mW": 1e-3, "kW": 1e3, "MW": 1e6},
        speed: {"mph": 0.44704},
        acceleration: {"g0": G0},
        pressure: {"Pa": 1, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9, "psi": 4.4482216152605 / 0.0254**2},
        NUMBER: {"rad": 1, "mrad": 1e-3, "deg": math.pi / 180, "rev": 2 * math.pi},
        rate: {"rpm": math.pi / 30, "Hz": 1, "kHz": 1e3},
    }  # fmt: skip
    return {name: Quantity(value, dim) for dim, names in table.items() for name, value in names.items()}


POUND, G0 = 0.45359237, 9.80665
"""Pound in kg, and standard gravity, m/s^2."""
UNITS = _units()
NONE = "no unit"
CONSTANTS = {"pi": Quantity(math.pi)}


def one(dimension: str) -> str:
    """Return a value of a dimension for a message: ``a length``, ``an angle``."""
    return f"{'an' if dimension[0] in 'aeio' else 'a'} {dimension}"


def in_units(dimension: Dimension) -> str:
    """Return a dimension as powers of SI units, for messages: ``kg m^2``."""
    powers = [(name, power) for name, power in zip(("kg", "m", "s"), dimension, strict=True) if power]
    return " ".join(name if power == 1 else f"{name}^{power:g}" for name, power in powers) or NONE


def named_unit(dimension: Dimension) -> str:
    """Return the named unit of a dimension for messages: ``N m``; otherwise as `in_units`."""
    if any(dimension):
        for known, unit in DIMENSIONS.values():
            if known == dimension and "/rad" not in unit:
                return unit
    return in_units(dimension)


def in_text(quantity: Quantity) -> float | str:
    """Return a quantity in the form of a scene, in SI units: its number, or text with its unit."""
    if quantity.dimension is None:
        return quantity.value
    return f"{quantity.value!r} {in_units(quantity.dimension) if any(quantity.dimension) else 'rad'}"
