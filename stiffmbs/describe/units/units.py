"""Dimensions, units, and numbers that carry a dimension through arithmetic."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..formula.text import FormulaError

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
    """A value in SI units and its dimension; a bare number (`dimension` None) fits every dimension."""

    value: float
    dimension: Dimension | None = None

    def _sum(self, other: Quantity, sign: float) -> Quantity:
        if None not in (self.dimension, other.dimension) and self.dimension != other.dimension:
            raise FormulaError("found a sum of quantities with different units")
        dimension = self.dimension if self.dimension is not None else other.dimension
        return Quantity(self.value + sign * other.value, dimension)

    def __add__(self, other: Quantity) -> Quantity:
        return self._sum(other, 1.0)

    def __sub__(self, other: Quantity) -> Quantity:
        return self._sum(other, -1.0)

    def _product(self, other: Quantity, value: float, sign: float) -> Quantity:
        if self.dimension is None and other.dimension is None:
            return Quantity(value)
        a, b = self.dimension or NUMBER, other.dimension or NUMBER
        return Quantity(value, (a[0] + sign * b[0], a[1] + sign * b[1], a[2] + sign * b[2]))

    def __mul__(self, other: Quantity) -> Quantity:
        return self._product(other, self.value * other.value, 1.0)

    def __truediv__(self, other: Quantity) -> Quantity:
        return self._product(other, self.value / other.value, -1.0)

    def __pow__(self, other: Quantity) -> Quantity:
        if other.dimension not in (None, NUMBER):
            raise FormulaError("found an exponent with a unit, expected a plain number")
        value = self.value**other.value
        if isinstance(value, complex):
            raise FormulaError("found a fractional power of a negative number")
        if self.dimension is None:
            return Quantity(value)
        a, b, c = self.dimension
        return Quantity(value, (a * other.value, b * other.value, c * other.value))

    def __neg__(self) -> Quantity:
        return Quantity(-self.value, self.dimension)

    def __pos__(self) -> Quantity:
        return self


def _units() -> dict[str, Quantity]:
    length, time, mass = (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)
    force, energy, power = (1.0, 1.0, -2.0), (1.0, 2.0, -2.0), (1.0, 2.0, -3.0)
    table: dict[Dimension, dict[str, float]] = {
        length: {"m": 1, "mm": 1e-3, "cm": 1e-2, "um": 1e-6, "km": 1e3, "inch": 0.0254, "ft": 0.3048},
        time: {"s": 1, "ms": 1e-3, "us": 1e-6, "min": 60, "h": 3600},
        mass: {"kg": 1, "g": 1e-3, "mg": 1e-6, "tonne": 1e3, "lb": 0.45359237},
        force: {"N": 1, "mN": 1e-3, "kN": 1e3, "MN": 1e6, "lbf": 4.4482216152605},
        energy: {"J": 1, "kJ": 1e3},
        power: {"W": 1, "kW": 1e3},
        NUMBER: {"rad": 1, "deg": math.pi / 180, "rev": 2 * math.pi},
        (0.0, 0.0, -1.0): {"rpm": math.pi / 30},
    }
    return {name: Quantity(value, dim) for dim, names in table.items() for name, value in names.items()}


UNITS = _units()
CONSTANTS = {"pi": Quantity(math.pi)}


def one(dimension: str) -> str:
    """A value of a dimension in a sentence: ``a length``, ``an angle``."""
    return f"{'an' if dimension[0] in 'aeio' else 'a'} {dimension}"


def in_units(dimension: Dimension) -> str:
    """A dimension as powers of SI units, for sentences: ``kg m^2``."""
    powers = [(name, power) for name, power in zip(("kg", "m", "s"), dimension, strict=True) if power]
    return " ".join(name if power == 1 else f"{name}^{power:g}" for name, power in powers) or "no unit"
