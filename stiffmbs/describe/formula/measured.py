"""Dimensions of named quantities in formulas: time, coordinates of bodies, measures between markers."""

from __future__ import annotations

import ast
from collections.abc import Mapping

from ..units.units import DIMENSIONS, Quantity
from .check_dimensions import Columns, dimension_of
from .dimension import UNKNOWN, Known, measured_in
from .text import FormulaError

_COORDINATES = {
    "length": "x y z", "angle": "angle", "number": "q0 q1 q2 q3", "velocity": "vx vy vz", "angular velocity": "omega wx wy wz",
    "acceleration": "ax ay az", "angular acceleration": "alpha wdx wdy wdz",
    "force": "fx fy fz", "torque": "tx ty tz torque",
}  # fmt: skip
"""Coordinates of bodies, and channels of joints and forces for requests."""
_OF_TYRES = {
    "force": "longitudinal lateral load", "torque": "overturning rolling aligning", "number": "slip",
    "angle": "slip_angle camber", "length": "deflection deflection_x deflection_y",
}  # fmt: skip
"""Additional channels of tyres."""
_MEASURES = {
    "length": "dx dy dz dm", "angle": "ax ay az psi theta phi", "number": "q0 q1 q2 q3", "velocity": "vx vy vz vm vr",
    "angular velocity": "wx wy wz wm", "acceleration": "accx accy accz accm",
    "angular acceleration": "wdtx wdty wdtz wdtm", "force": "fx fy fz fm", "torque": "tx ty tz tm",
}  # fmt: skip
"""Measures between markers, and components of joints and forces."""


def _by_name(dimensions: dict[str, str]) -> dict[str, Known]:
    return {name: measured_in(dimension) for dimension, names in dimensions.items() for name in names.split()}


def _units_by_name(dimensions: dict[str, str]) -> dict[str, str]:
    return {
        name: DIMENSIONS[dimension][1] if dimension != "number" else ""
        for dimension, names in dimensions.items()
        for name in names.split()
    }


COORDINATES, MEASURES = {**_by_name(_COORDINATES), **_by_name(_OF_TYRES)}, _by_name(_MEASURES)
_UNITS = {**_units_by_name(_COORDINATES), **_units_by_name(_OF_TYRES)}
_MEASURE_UNITS = _units_by_name(_MEASURES)
TIME = measured_in("time")


def of_coordinate(name: str) -> Known:
    """Return the dimension of ``body.name``."""
    owner, _, coordinate = name.rpartition(".")
    return COORDINATES.get(coordinate, UNKNOWN) if owner else UNKNOWN


def unit_of_coordinate(name: str) -> str:
    """Return the unit of ``body.name``; empty for a dimensionless number or an unknown name."""
    owner, _, coordinate = name.rpartition(".")
    return _UNITS.get(coordinate, "") if owner else ""


def unit_of_measure(function: str) -> str:
    """Return the unit of a measure between markers, or of a component of a joint or force."""
    return _MEASURE_UNITS[function]


def dimension_within(
    tree: ast.expr, used: Mapping[str, Quantity], own: Mapping[str, Known], tables: Mapping[str, Columns]
) -> Known:
    """Return the dimension of a formula's value.

    Parameters
    ----------
    tree : ast.expr
    used : mapping of str to Quantity
        Parameters, units and constants in it.
    own : mapping of str to Known
        Names defined by the formula's field.
    tables : mapping of str to (Known, Known)
        Dimensions of the arguments and values of the tables that it calls.

    Raises
    ------
    FormulaError
        If it contains a unit and its dimensions do not fit. Without a unit it is taken to be in SI units.
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
