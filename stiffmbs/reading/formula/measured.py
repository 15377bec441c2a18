"""Dimension of a formula, derived from the dimensions of its parts."""

from __future__ import annotations

import ast
from collections.abc import Callable, Mapping
from typing import Any

from ..joint_name import FREE_COORDINATES, ORDERS
from ..units.units import ANY, DIMENSIONS, Quantity, in_its_unit, one
from .dimension import PLAIN, UNKNOWN, Known, alike, known_of, measured_in, power, product
from .functions import FUNCTIONS
from .text import OF_NUMBERS, FormulaError, evaluate

Named = Callable[[str], Quantity | Known]
"""Function from a name, such as ``L``, ``unit.kg`` or ``cart.x``, to its value or known dimension."""

Columns = tuple[Known, Known]
NONE: Mapping[str, Any] = {}


def dimension_of(
    tree: ast.expr, named: Named, measures: Mapping[str, Known] = NONE, tables: Mapping[str, Columns] = NONE
) -> Known:
    """Return the dimension of a checked syntax tree with functions of markers and tables of these dimensions.

    Raises FormulaError for a sum of different dimensions, and for an argument of the wrong dimension.
    """

    def of(node: ast.expr) -> Known:
        return dimension_of(node, named, measures, tables)

    match tree:
        case ast.Name(name):
            return _known(named(name))
        case ast.Attribute(ast.Name(owner), name):
            return _known(named(f"{owner}.{name}"))
        case ast.UnaryOp(_, operand):
            return of(operand)
        case ast.BinOp(left, ast.Add() | ast.Sub(), right):
            return alike(((of(left), left), (of(right), right)), tree)
        case ast.BinOp(left, ast.Pow(), right):
            return power(of(left), (of(right), right), _value(right, named))
        case ast.BinOp(left, op, right):
            return product(of(left), of(right), -1 if isinstance(op, ast.Div) else 1)
        case ast.Call(ast.Name(name), arguments):
            if name in measures:
                return measures[name]
            given = [(of(part), part) for part in arguments]
            if name in tables:
                argument, value = tables[name]
                alike((*given, (argument, tree)), tree)
                return value
            return FUNCTIONS[name].dimension(given, tree)
    return PLAIN


def _known(found: Quantity | Known) -> Known:
    return known_of(found) if isinstance(found, Quantity) else found


def _value(node: ast.expr, named: Named) -> float | None:
    """Return the value of an exponent; None if it is not constant."""

    def value(name: str) -> float:
        found = named(name)
        if isinstance(found, Known):
            raise FormulaError(f"found '{name}', expected a number")
        return found.value

    try:
        result: float = evaluate(node, value, {name: f.value for name, f in FUNCTIONS.items()}, float, OF_NUMBERS)
    except (ArithmeticError, ValueError):
        return None
    return result


def check_dimension(what: str, found: Known, dimension: str) -> None:
    """Raise a FormulaError for a value with a unit of the wrong dimension; the message calls it `what`."""
    if dimension != ANY and not found.is_of(dimension):
        assert found.exponents is not None
        raise FormulaError(
            f"found {what} {in_its_unit(found.exponents)}, expected {one(dimension)} in {DIMENSIONS[dimension][1]}"
        )


def _by_name(names: Mapping[str, str]) -> dict[str, str]:
    return {name: dimension for dimension, listed in names.items() for name in listed.split()}


OF_JOINTS = {
    "angle": ("angle", "angular velocity", "angular acceleration"), "displacement": ("length", "velocity", "acceleration"),
}  # fmt: skip
"""Dimensions of a joint coordinate, its rate and its acceleration, by the beginning of its name."""
CHANNELS = _by_name({
    "length": "x y z deflection deflection_x deflection_y", "angle": "angle slip_angle camber", "number": "q0 q1 q2 q3 slip",
    "velocity": "vx vy vz", "angular velocity": "omega wx wy wz", "acceleration": "ax ay az",
    "angular acceleration": "alpha wdx wdy wdz", "force": "fx fy fz longitudinal lateral load",
    "torque": "tx ty tz torque overturning rolling aligning",
}) | {
    coordinate + order: dimension
    for coordinate in FREE_COORDINATES
    for order, dimension in zip(ORDERS, OF_JOINTS[coordinate.partition("_")[0]], strict=True)
}  # fmt: skip
"""Dimensions of the coordinates of bodies and joints, and of the channels of joints, forces and tyres."""
_MEASURES = _by_name({
    "length": "dx dy dz dm", "angle": "ax ay az psi theta phi", "number": "q0 q1 q2 q3", "velocity": "vx vy vz vm vr",
    "angular velocity": "wx wy wz wm", "acceleration": "accx accy accz accm",
    "angular acceleration": "wdtx wdty wdtz wdtm", "force": "fx fy fz fm", "torque": "tx ty tz tm",
})  # fmt: skip
"""Dimensions of measures between markers, and of components of joints and forces."""
COORDINATES, MEASURES = ({name: measured_in(of) for name, of in table.items()} for table in (CHANNELS, _MEASURES))
TIME = measured_in("time")


def of_coordinate(name: str) -> Known:
    """Return the dimension of ``body.name``."""
    owner, _, coordinate = name.rpartition(".")
    return COORDINATES.get(coordinate, UNKNOWN) if owner else UNKNOWN


def unit_of_coordinate(name: str) -> str:
    """Return the unit of ``body.name``; empty for a dimensionless number or an unknown name."""
    owner, _, coordinate = name.rpartition(".")
    return unit_of(CHANNELS.get(coordinate, "number") if owner else "number")


def unit_of_measure(function: str) -> str:
    """Return the unit of a measure between markers, or of a component of a joint or force."""
    return unit_of(_MEASURES[function])


def unit_of(dimension: str) -> str:
    """Return the unit of a dimension; empty for a number."""
    return "" if dimension == "number" else DIMENSIONS[dimension][1]


def dimension_within(
    tree: ast.expr, used: Mapping[str, Quantity], own: Mapping[str, Known], tables: Mapping[str, Columns]
) -> Known:
    """Return the dimension of a formula's value; without a unit it is taken to be in SI units.

    `used`: parameters, units and constants in it. `own`: names defined by the formula's field. `tables`: dimensions of
    the arguments and values of the tables that it calls. Raises FormulaError if it contains a unit and its dimensions
    do not fit.
    """
    names: dict[str, Quantity | Known] = {"t": TIME, **own, **used}
    try:
        return dimension_of(tree, lambda name: names.get(name) or of_coordinate(name), MEASURES, tables)
    except FormulaError:
        if any(quantity.dimension is not None for quantity in used.values()):
            raise
        if any(column.stated for columns in tables.values() for column in columns):
            raise
        return UNKNOWN
