"""Parameters and further mounts of an instance of a part."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

from ...errors import InputError
from ...reading.did_you_mean import did_you_mean, instead_of
from ...reading.fields import mapping
from ...reading.files.quoted import written
from ...reading.formula.text import FormulaError
from ...reading.names import GROUND, MOUNT
from ...reading.units.quantity import in_si, quantity
from ...reading.units.units import Quantity
from ..files.expand import read_parameters
from .frame import Use
from .vectors import COMPONENTS

LIMITS = {
    "positive": (lambda value: value > 0, "a value above zero"),
    "nonnegative": (lambda value: value >= 0, "zero or more"),
    "fraction": (lambda value: 0 <= value <= 1, "a value from 0 to 1"),
}
"""Limits that a part can set to a parameter, with what they expect of its SI value."""
COMPONENT_ENDS = tuple(f"_{axis}" for axis in COMPONENTS)


def parameters_of(
    use: Use, where: str, found: object, outside: Mapping[str, Quantity], limits: object = None
) -> dict[str, Quantity]:
    """Return the parameters of an instance: outer ones, its own, and the values set by its use.

    A plain number takes the SI unit of the value that it replaces. `where`: path of the use in the scene. `found`:
    parameters of the definition. `limits`: those of the definition; a value is checked before others follow from it.
    Raises InputError if one is unknown, has a reserved name, is not a number, or is beyond its limit.
    """
    own = mapping({} if found is None else found, f"parts.{use.part}.parameters", "names to numbers")
    for name in use.parameters:
        if name not in own:
            known = [*dict.fromkeys(_vector(each, own) for each in own)]
            raise InputError(
                f"{where}.parameters.{name}: found no such parameter of '{use.part}'{did_you_mean(name, [*known, *own])}, "
                f"expected one of {', '.join(known) or 'none'}"
            )
    names: Mapping[str, Quantity]
    inside, limited = dict(outside), _limits_of(limits, use.part, own)
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
        holds, expected = LIMITS.get(limited.get(name, ""), (None, ""))
        if holds and not holds(value_here.value):
            raise InputError(f"{where}.parameters.{name}: found {value_here.value:g}, expected {expected}")
    return inside


def _limits_of(limits: object, part: str, own: Collection[str]) -> dict[str, str]:
    """Return the limit of each parameter by name, as in ``limits: {ratio: positive, split: fraction}``.

    A limit of a vector is that of its components. `own`: names of the part's parameters.
    """
    place = f"parts.{part}.limits"
    if not isinstance(limits, dict | None):
        raise InputError(f"{place}: found {written(limits)}, expected a mapping of parameters to {', '.join(LIMITS)}")
    known: dict[str, str] = {}
    for name, word in (limits or {}).items():
        found = [each for each in (name, *(f"{name}{end}" for end in COMPONENT_ENDS)) if each in own]
        if not found:
            raise InputError(f"{place}: found {written(name)}, expected a parameter of the part")
        if not isinstance(word, str) or word not in LIMITS:
            raise InputError(f"{place}.{name}: found {written(word)}, expected one of {', '.join(LIMITS)}")
        known |= dict.fromkeys(found, word)
    return known


def _vector(name: object, own: Mapping[object, object]) -> str:
    """Return the name of the vector that a parameter is a component of, or its own name."""
    start, end = str(name)[:-2], str(name)[-2:]
    is_component = end in COMPONENT_ENDS and all(f"{start}{other}" in own for other in COMPONENT_ENDS[:2])
    return start if is_component else str(name)


def _quantity(given: object, names: Mapping[str, Quantity]) -> Quantity:
    return quantity(given, names) if isinstance(given, str) else Quantity(in_si(given, "number"))


def _dimension(given: object, names: Mapping[str, Quantity]) -> Any:
    """Return the dimension of the replaced value; None if it cannot be read."""
    try:
        return _quantity(given, names).dimension
    except FormulaError:
        return None


def mounts_of(found: object, use: Use, where: str) -> dict[str, str]:
    """Return the bodies of the further mounts of a part: the rack of a tie rod, the arm of a strut.

    ``mounts: {rack: mount}`` in a part defines the local name ``rack``, and the part's mount as the default body. A use
    can name another one: ``mounts: {rack: steering.rack}``. Points on it are in the part's frame. `found`: mounts of
    the definition. `where`: path of the use. Raises InputError if the use names a mount that the part does not have.
    """
    mounts = {} if found is None else found
    if not isinstance(mounts, dict) or not all(isinstance(body, str) for body in mounts.values()):
        raise InputError(f"parts.{use.part}.mounts: found {written(found)}, expected a mapping of names to bodies")
    for name in mounts:
        if name in (MOUNT, GROUND) or not str(name).isidentifier():
            raise InputError(f"parts.{use.part}.mounts: found the name {written(name)}, expected another")
    for name in use.mounts:
        if name not in mounts:
            raise InputError(f"{where}.mounts.{name}: found no such mount of '{use.part}'{instead_of(name, mounts)}")
    return {**mounts, **use.mounts}
