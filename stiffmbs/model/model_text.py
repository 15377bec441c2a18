"""Text of a scene file from a model."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

from ..elements.states.amount import Amount
from ..elements.states.linear_system import PID
from ..errors import InputError
from ..reading.fields import Described
from ..reading.files.yaml_text import Content, scene_text
from ..reading.formula.dimension import Known
from ..reading.joint_name import JointName
from ..reading.marker import MarkerReference
from ..reading.python_function import PythonFunction
from ..reading.table import Table
from ..reading.units.units import Quantity, in_text
from .model_data import ModelData

PLAIN = ("name", "dimensions", "gravity")
SECTIONS = ("markers", "bodies", "states", "inputs", "joints", "forces", "requests")


def model_text(data: ModelData) -> str:
    """Return the text of a scene file of a model; errors as for `model_content`."""
    return scene_text(model_content(data))


def model_content(data: ModelData) -> Content:
    """Return the content of a scene file of a model, with the parameters and tables that its formulas use.

    Raises InputError if two formulas have different values of a parameter, or different tables of the same name, or if
    a body is flexible.
    """
    for name, body in data.bodies.items():
        if not body.rigid:
            raise InputError(
                f"bodies.{name}: found a flexible body, expected rigid ones: only its own scene file describes it"
            )
    parts = {name: written(getattr(data, name)) for name in (*PLAIN, *SECTIONS)}
    formulas = list(_formulas([getattr(data, section) for section in SECTIONS]))
    parts["parameters"] = _agreed(
        (name, in_text(value)) for formula in formulas for name, value in formula.parameters.items()
    )
    parts["tables"] = _agreed((name, written(table)) for formula in formulas for name, table in formula.tables.items())
    order = ("name", "dimensions", "parameters", "tables", "gravity", *SECTIONS)
    return {name: parts[name] for name in order if parts[name]}


def written(
    value: object,
    marker: Callable[[MarkerReference], object] | None = None,
    formula: Callable[[object], object] | None = None,
) -> Any:
    """Return a value in the form of a scene file.

    `marker`, `formula`: forms of markers and of formulas; by default those that they have.
    """
    again = partial(written, marker=marker, formula=formula)
    match value:
        case MarkerReference():
            return (marker or _marker)(value)
        case Amount():
            return in_text(value.written())
        case Table():
            rows = [[_quantity(*entry) for entry in zip(row, value.dimensions, strict=True)] for row in value.table]
            return {**dict(value.__repr_args__()), "table": rows}
        case Described():
            kind = {"type": getattr(value, "type", "")} if "type" in type(value).model_fields else {}
            fields = kind | {name: again(part) for name, part in value.__repr_args__()}
            return {"pid": fields} if isinstance(value, PID) else fields
        case JointName():
            return str(value)
        case PythonFunction():
            raise InputError(f"found {value!r}, expected a formula: a scene file cannot hold a Python function")
        case dict():
            return {name: again(part) for name, part in value.items()}
        case tuple():
            return [again(part) for part in value]
    return (formula or _formula)(value) if hasattr(value, "expanded") else value


def _formula(formula: Any) -> str | float:
    """Return a formula's text with the scene's variables substituted, or its number."""
    text = str(formula.text)
    try:
        return float(text) if repr(float(text)) == text else text
    except ValueError:
        return formula.expanded or text


def _marker(found: MarkerReference) -> Any:
    fields = {name: written(value) for name, value in found.__repr_args__()}
    return found.label if fields.keys() <= {"body", "marker"} else fields


def _formulas(value: object) -> Iterator[Any]:
    """Yield the formulas in a value, also nested ones."""
    if hasattr(value, "expanded"):
        yield value
    elif isinstance(value, Described):
        for name in type(value).model_fields:
            yield from _formulas(getattr(value, name))
    elif isinstance(value, dict | list | tuple):
        for part in value.values() if isinstance(value, dict) else value:
            yield from _formulas(part)


def _quantity(value: float, known: Known) -> float | str:
    """Return a number of a table, with a unit if the table has one."""
    return in_text(Quantity(value, known.exponents)) if known.stated else value


def _agreed(pairs: Iterator[tuple[str, object]]) -> dict[str, object]:
    found: dict[str, object] = {}
    for name, value in pairs:
        if found.setdefault(name, value) != value:
            raise InputError(
                f"{name}: found {found[name]!r} in one formula and {value!r} in another, expected one value"
            )
    return found
