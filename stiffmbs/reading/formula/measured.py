"""Dimensions of named quantities in formulas: time, coordinates of bodies, measures between markers."""

from __future__ import annotations

import ast
from collections.abc import Mapping

from ..joint_name import FREE_COORDINATES, ORDERS
from ..units.units import DIMENSIONS, Quantity
from .check_dimensions import Columns, dimension_of
from .dimension import UNKNOWN, Known, measured_in
from .text import FormulaError


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
