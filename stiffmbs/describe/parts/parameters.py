"""Parameters of an instance of a part."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ...errors import InputError
from ..files.expand import read_parameters
from ..files.quoted import written
from ..formula.text import FormulaError
from ..units.quantity import in_si, quantity
from ..units.units import Quantity
from .use import Use


def parameters_of(use: Use, where: str, found: Any, outside: Mapping[str, Quantity]) -> dict[str, Quantity]:
    """Return the parameters of an instance: outer ones, its own, and the values set by its use.

    A plain number takes the SI unit of the value that it replaces.

    Parameters
    ----------
    use : Use
    where : str
        Path of the use in the scene.
    found : mapping of str to number or text
        Parameters of the definition.
    outside : mapping of str to Quantity

    Raises
    ------
    InputError
        If one is unknown, has a reserved name, or is not a number.
    """
    own = {} if found is None else found
    if not isinstance(own, dict):
        raise InputError(f"parts.{use.part}.parameters: found {written(own)}, expected a mapping of names to numbers")
    for name in use.parameters:
        if name not in own:
            known = ", ".join(map(str, own)) or "none"
            raise InputError(
                f"{where}.parameters.{name}: found no such parameter of '{use.part}', expected one of {known}"
            )
    names: Mapping[str, Quantity]
    inside = dict(outside)
    for name, value in own.items():
        place = f"parts.{use.part}."
        try:
            read_parameters({name: 0.0})  # validate the name
            given, names = (use.parameters[name], outside) if name in use.parameters else (value, inside)
            place = f"{where}." if name in use.parameters else place
            value_here = _quantity(given, names)
            if name in use.parameters and value_here.dimension is None:
                value_here = Quantity(value_here.value, _dimension(value, inside))
            inside[name] = value_here
        except FormulaError as error:
            raise InputError(f"{place}parameters.{name}: {error}") from None
        except InputError as error:
            raise InputError(f"{place}{error}") from None
    return inside


def _quantity(given: Any, names: Mapping[str, Quantity]) -> Quantity:
    return quantity(given, names) if isinstance(given, str) else Quantity(in_si(given, "number"))


def _dimension(given: Any, names: Mapping[str, Quantity]) -> Any:
    """Return the dimension of the replaced value; None if it cannot be read."""
    try:
        return _quantity(given, names).dimension
    except FormulaError:
        return None
