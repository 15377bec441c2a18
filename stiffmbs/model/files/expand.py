"""Scene text before validation: parameters, repeated entries and values set from outside.

A repeated entry is copied for each value of its loop variable: ``link{k}: {for: k in 1..N, mass: 1, position: [(k - 0.5)*L, 0]}``. For each k,
``{...}`` in its name and text is replaced by its value (``"link{k-1}"``), and k itself is replaced in its formulas.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from typing import Any

from pydantic import ValidationError as PydanticError

from ...errors import InputError
from ...reading.did_you_mean import did_you_mean
from ...reading.fields import located, named_entries, sentence
from ...reading.files.quoted import written
from ...reading.files.yaml_text import Content
from ...reading.formula.functions import IN_FORMULAS, IN_NUMBERS
from ...reading.formula.names import MEASURES, REACTIONS
from ...reading.formula.nodes import TIME
from ...reading.formula.text import UNIT
from ...reading.names import beginnings
from ...reading.table import Table
from ...reading.units.quantity import in_si, quantity
from ...reading.units.units import CONSTANTS, Quantity

MOST_REPEATS = 100_000
_LOOP = re.compile(r"^\s*([^\W\d]\w*)\s+in\s+(.+?)\s*\.\.\s*(.+?)\s*$")
_BRACES = re.compile(r"\{([^{}]*)\}")


def set_value(scene: Content, path: str, value: object, named: str = "") -> None:
    """Set the value at a path such as ``bodies.cart.mass``, ``run.rtol`` or the bare name of a parameter.

    Raises InputError if the path passes through a value that has no keys; the message has the path, or `named`.
    """
    if path in (scene.get("parameters") or {}):
        path = f"parameters.{path}"
    *parents, last = _keys(scene, path)
    place: object = scene
    for k, parent in enumerate(parents):
        if isinstance(place, dict):
            place = place.setdefault(parent, {})
        elif isinstance(place, list) and parent.isdigit() and int(parent) < len(place):
            place = place[int(parent)]
        else:
            raise InputError(f"--set {named or path}: found no '{'.'.join(parents[: k + 1])}' in the scene")
    if isinstance(place, dict) and last:
        place[last] = value
    elif isinstance(place, list) and last.isdigit() and int(last) < len(place):
        place[int(last)] = value
    else:
        raise InputError(f"--set {named or path}: found no such place in the scene")


def unshared(found: object) -> Any:
    """Return a deep copy in which YAML aliases are independent copies."""
    match found:
        case dict():
            return {key: unshared(value) for key, value in found.items()}
        case list():
            return [unshared(value) for value in found]
    return found


def _keys(place: object, path: str) -> list[str]:
    """Return the keys of a path; a key of a mapping may contain dots."""
    keys: list[str] = []
    rest: str | None = path
    while rest is not None:
        known = (start for start, _ in beginnings(rest) if isinstance(place, dict) and start in place)
        key = next(known, rest.partition(".")[0])
        place = place.get(key) if isinstance(place, dict) else None
        rest = rest[len(key) + 1 :] if len(rest) > len(key) else None
        keys.append(key)
    return keys


def refuse_unused_parameters(scene: Content, changes: Sequence[tuple[str, object]], sections: Collection[str]) -> None:
    """Refuse a change that adds a parameter which no other change uses; a misspelt name would have no effect.

    `sections`: sections that a scene may have. Raises InputError if there is no such parameter; lists the parameters of
    the scene.
    """
    known = scene.get("parameters") or {}
    added = {
        path.partition(".")[2] for path, _ in changes if path.startswith("parameters.")
    }  # which other changes may modify
    for path, _ in changes:
        section, _, name = path.partition(".")
        if not name and not {path} & {*known, *added, *scene, *sections}:
            raise InputError(
                f"{path}: found no such parameter{did_you_mean(path, (*known, *sections))}, expected one of {', '.join(map(str, known)) or 'none'}, or a path such as "
                "forces.spring.stiffness"
            )
        alone = rf"(?<![\w.]){re.escape(name)}(?![\w.])"
        used = any(re.search(alone, str(text)) for other, text in changes if other != path)
        if section == "parameters" and name and name not in known and not used:
            raise InputError(
                f"--set {path}: found no such parameter{did_you_mean(name, known)}, expected one of "
                f"{', '.join(map(str, known)) or 'none'}"
            )


def read_parameters(found: object, replaced: Mapping[str, Quantity] | None = None) -> dict[str, Quantity]:
    """Read the parameters of a scene; each may use the ones above it.

    `replaced`: original values of parameters set from outside: a plain number takes the SI unit of the value that it
    replaces. Raises InputError if a name is not an identifier or is the name of a unit, or a value is not a number.
    """
    parameters: dict[str, Quantity] = {}
    for name, value in named_entries("parameters", found, "numbers"):
        if name in CONSTANTS or name in IN_NUMBERS or name in (TIME, UNIT):
            raise InputError(f"parameters.{name}: found the name of a constant or function, expected another")
        parameters[name] = read_parameter(name, value, parameters, replaced)
    return parameters


def read_parameter(
    name: str, value: object, above: Mapping[str, Quantity], replaced: Mapping[str, Quantity] | None = None
) -> Quantity:
    """Read one parameter, given the ones above it; errors as for `read_parameters`."""
    with located(f"parameters.{name}"):
        found = quantity(value, above) if isinstance(value, str) else Quantity(in_si(value, "number"))
    if replaced and name in replaced and found.dimension is None:
        return Quantity(found.value, replaced[name].dimension)
    return found


def replaced_parameters(scene: dict[str, object], changes: Sequence[tuple[str, object]]) -> dict[str, Quantity]:
    """Return the original values of the parameters that changes replace; none if they cannot be read."""
    changed = {path.removeprefix("parameters.") for path, _ in changes}
    try:
        return {name: value for name, value in read_parameters(scene.get("parameters")).items() if name in changed}
    except InputError:
        return {}


def read_tables(found: object, parameters: Mapping[str, Quantity]) -> dict[str, Table]:
    """Read the tables of a scene, which its formulas can call as functions.

    Raises InputError if a name is not an identifier or has a meaning in formulas, or a table cannot be read.
    """
    tables = {}
    for name, table in named_entries("tables", found, "tables"):
        if name in (*IN_FORMULAS, *MEASURES, *REACTIONS, *parameters):
            raise InputError(f"tables.{name}: found the name of a function or parameter, expected another")
        try:
            tables[name] = Table.model_validate(table, context={"parameters": parameters})
        except PydanticError as error:
            raise InputError(f"tables.{name}: {sentence(error)}") from None
    return tables


def repeat_entries(section: str, entries: object, parameters: Mapping[str, Quantity]) -> Any:
    """Replace each entry with a ``for`` by the entries that it generates.

    Raises InputError if the loop cannot be read, or two entries have the same name.
    """
    if not isinstance(entries, dict):
        return entries
    expanded: dict[object, object] = {}
    for name, entry in entries.items():
        where = f"{section}.{name}"
        if not (isinstance(entry, dict) and "for" in entry):
            if name in expanded:
                raise InputError(f"{where}: found a name that a repeated entry makes too, expected another")
            expanded[name] = _filled(where, entry, parameters)
            continue
        pattern = {key: value for key, value in entry.items() if key != "for"}
        variable, first, last = _loop(where, entry["for"], parameters)
        for k in range(first, last + 1):
            names = {**parameters, variable: Quantity(float(k))}
            repeated = _filled(where, name, names, variable)
            if repeated in expanded:
                raise InputError(f"{where}: found the name '{repeated}' twice, expected a name with {{{variable}}}")
            expanded[repeated] = _filled(where, pattern, names, variable)
    return expanded


def _loop(where: str, text: object, parameters: Mapping[str, Quantity]) -> tuple[str, int, int]:
    match = _LOOP.match(text) if isinstance(text, str) else None
    if match is None:
        raise InputError(f"{where}.for: found {written(text)}, expected a loop such as 'k in 1..N'")
    variable = match[1]
    if variable in parameters or variable in IN_NUMBERS:
        raise InputError(f"{where}.for: found the loop variable '{variable}', which has a meaning already")
    with located(f"{where}.for"):
        first, last = (quantity(bound, parameters).value for bound in (match[2], match[3]))
    if first != round(first) or last != round(last) or last - first > MOST_REPEATS:
        raise InputError(
            f"{where}.for: found {first:g}..{last:g}, expected whole numbers, at most {MOST_REPEATS} apart"
        )
    return variable, round(first), round(last)


def _filled(where: str, value: object, names: Mapping[str, Quantity], variable: str = "") -> object:
    """Return a value with ``{...}`` and the loop variable replaced by numbers."""
    if isinstance(value, dict):
        return {key: _filled(where, item, names, variable) for key, item in value.items()}
    if isinstance(value, list):
        return [_filled(where, item, names, variable) for item in value]
    if not isinstance(value, str):
        return value

    def number(match: re.Match[str]) -> str:
        """Return the value of the expression in braces as text."""
        with located(where):
            result = quantity(match[1], names).value
        return str(round(result)) if result == round(result) else repr(result)

    filled = _BRACES.sub(number, value)
    if not variable:
        return filled
    alone = rf"(?<![\w.]){variable}(?![\w.])"
    return re.sub(alone, f"({round(names[variable].value)})", filled)
