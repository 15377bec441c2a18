"""Numbers with units: ``125 mm``, ``20 deg``, ``0.6/2``, all turned to SI with their dimension checked."""

from __future__ import annotations

import ast
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from .formula import UNIT, FormulaError, evaluate, parse

Dimension = tuple[float, float, float]  # exponents of kg, m, s; angles have none

NUMBER: Dimension = (0, 0, 0)
ANY = "value"
LARGEST = 1e100
"""In SI units; products of three such numbers overflow."""
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


def _of_number(function: Callable[..., float]) -> Callable[..., Quantity]:
    def call(*arguments: Quantity) -> Quantity:
        if any(a.dimension not in (None, NUMBER) for a in arguments):
            raise FormulaError(
                f"found {function.__name__} of a quantity with a unit, expected a plain number or an angle"
            )
        return Quantity(function(*(a.value for a in arguments)))

    return call


def _sqrt(a: Quantity) -> Quantity:
    return a ** Quantity(0.5)


def _of_same(choose: Callable[..., float]) -> Callable[..., Quantity]:
    def call(first: Quantity, *others: Quantity) -> Quantity:
        total = first
        for other in others:
            total = total + other  # refuses mixed units
        return Quantity(choose(*(a.value for a in (first, *others))), total.dimension)

    return call


def _atan2(y: Quantity, x: Quantity) -> Quantity:
    return Quantity(math.atan2(y.value, x.value), (y - x).dimension and NUMBER)


_PLAIN = (
    math.sin,
    math.cos,
    math.tan,
    math.asin,
    math.acos,
    math.atan,
    math.sinh,
    math.cosh,
    math.tanh,
    math.exp,
    math.log,
)
FUNCTIONS: dict[str, Callable[..., Quantity]] = {
    **{f.__name__: _of_number(f) for f in _PLAIN},
    "sqrt": _sqrt,
    "atan2": _atan2,
    "abs": _of_same(lambda *values: abs(values[0])),
    "min": _of_same(lambda *values: min(values)),
    "max": _of_same(lambda *values: max(values)),
}


def quantity(text: str, parameters: Mapping[str, Quantity] | None = None) -> Quantity:
    """Evaluate arithmetic with units.

    Parameters
    ----------
    text : str
        Such as ``"125 mm"``, ``"0.6/2"``, ``"2*sin(20 deg)"``.
    parameters : mapping, optional
        The scene's own names.

    Raises
    ------
    FormulaError
        For an unknown name or function, mixed units, or a value that is not finite.
    """
    known = parameters or {}
    tree = parse(text)
    with_units = any(isinstance(node, ast.Attribute) for node in ast.walk(tree))

    def names(name: str) -> Quantity:
        owner, _, unit = name.rpartition(".")
        if owner == UNIT and unit in UNITS:
            return UNITS[unit]
        name = unit if owner == UNIT else name
        if name in known and name in UNITS and with_units:
            raise FormulaError(
                f"found '{name}' in '{text}', which is a unit and a parameter of the scene, expected one or the other"
            )
        for table in (known, UNITS, CONSTANTS):
            if name in table:
                return table[name]
        listed = ", ".join(known) if known else "none"
        raise FormulaError(
            f"found the unknown name '{name}', expected a unit, pi or a parameter of the scene ({listed})"
        )

    try:
        result: Quantity = evaluate(tree, names, FUNCTIONS, lambda value: Quantity(float(value)))
    except ArithmeticError:
        raise FormulaError(f"found '{text}', which divides by zero or overflows") from None
    except ValueError as error:
        if isinstance(error, FormulaError):
            raise
        raise FormulaError(f"found '{text}', which has no real value") from None
    if not math.isfinite(result.value):
        raise FormulaError(f"found '{text}', which is not a finite number")
    return result


def in_si(found: object, dimension: str, parameters: Mapping[str, Quantity] | None = None) -> float:
    """Turn what stands in a scene (a number or text) into a finite SI value of the named dimension."""
    expected, unit = DIMENSIONS[dimension]
    if isinstance(found, str):
        result = quantity(found, parameters)
        if dimension != ANY and result.dimension is not None and result.dimension != expected:
            raise FormulaError(
                f"found '{found}', which is in {_unit(result.dimension)}, expected {one(dimension)} in {unit}"
            )
        return _of_ordinary_size(result.value, dimension)
    if isinstance(found, bool) or not hasattr(found, "__float__") or getattr(found, "ndim", False):
        raise FormulaError(f"found {_shown(found)}, expected {one(dimension)} in {unit}")
    value = float(found)
    if not math.isfinite(value):
        raise FormulaError(f"found {value}, expected a finite {dimension} in {unit}")
    return _of_ordinary_size(value, dimension)


def one(dimension: str) -> str:
    """A value of a dimension in a sentence: ``a length``, ``an angle``."""
    return f"{'an' if dimension[0] in 'aeio' else 'a'} {dimension}"


def _of_ordinary_size(value: float, dimension: str) -> float:
    """The value, if its square and its products with others are still numbers."""
    if abs(value) > LARGEST:
        raise FormulaError(
            f"found {value:g}, expected {one(dimension)} below {LARGEST:g} {DIMENSIONS[dimension][1]}".rstrip()
        )
    return value


def _unit(dimension: Dimension) -> str:
    powers = [(name, power) for name, power in zip(("kg", "m", "s"), dimension, strict=True) if power]
    return " ".join(name if power == 1 else f"{name}^{power:g}" for name, power in powers) or "no unit"


def _shown(found: object) -> str:
    if found is None:
        return "nothing"
    if isinstance(found, bool):
        return "yes or no (a truth value)"
    if isinstance(found, dict):
        return "a mapping"
    return "a list" if isinstance(found, list | tuple) or hasattr(found, "ndim") else repr(found)
