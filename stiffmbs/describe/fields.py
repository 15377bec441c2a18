"""Field types of the description: SI numbers that may be written with units, and the base of everything described.

A field's type carries its dimension, unit and bounds, so that the schema, the reference pages and the error
messages all come from the one place where an element names its fields.
"""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationInfo, WithJsonSchema
from pydantic import ValidationError as PydanticError

from ..errors import InputError
from .quantity import DIMENSIONS, in_si

NAME_PATTERN = r"^[A-Za-z_][A-Za-z0-9_]*$"


class _OneSentence(type(BaseModel)):  # type: ignore[misc]
    """Makes a direct construction fail with the package's own error."""

    def __call__(cls, **fields: Any) -> Any:
        try:
            return super().__call__(**fields)
        except PydanticError as error:
            raise InputError(f"{cls.__name__}: {sentence(error)}") from None


class Described(BaseModel, metaclass=_OneSentence):
    """Base of all descriptions: frozen, no unknown keys, and errors of one sentence.

    Raises
    ------
    InputError
        When a field is missing, unknown, of the wrong type or out of its bounds.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", arbitrary_types_allowed=True)


def _numeric(dimension: str) -> BeforeValidator:
    def read(found: object, info: ValidationInfo) -> float:
        return in_si(found, dimension, (info.context or {}).get("parameters"))

    return BeforeValidator(read)


def _schema(dimension: str, **bounds: float) -> WithJsonSchema:
    unit = DIMENSIONS[dimension][1]
    text = {"type": "string", "description": f"a formula with units that converts to {unit}"}
    return WithJsonSchema({"anyOf": [{"type": "number", **bounds}, text], "description": f"{dimension}, {unit}"})


def measured(dimension: str) -> Any:
    """A finite number of the given dimension in SI units, or text with units that converts to it."""
    return Annotated[float, _numeric(dimension), _schema(dimension)]


def positive(dimension: str) -> Any:
    """As `measured`, greater than zero."""
    return Annotated[float, _numeric(dimension), Field(gt=0), _schema(dimension, exclusiveMinimum=0)]


def not_negative(dimension: str) -> Any:
    """As `measured`, zero or more."""
    return Annotated[float, _numeric(dimension), Field(ge=0), _schema(dimension, minimum=0)]


def pair(dimension: str) -> Any:
    """Two numbers of one dimension, x and y."""
    return Annotated[tuple[measured(dimension), measured(dimension)], Field()]


def sentence(error: PydanticError) -> str:
    """The first fault of a validation as one sentence: where, what was found, what was expected."""
    faults = error.errors(include_url=False)
    fault = min(faults, key=_rank)
    where = location(fault["loc"])
    others = {location(other["loc"]) for other in faults} - {where}
    more = f" (and {len(others)} more)" if others else ""
    return f"{where}{': ' if where else ''}{_reason(fault)}{more}"


def _rank(fault: Any) -> int:
    """Unknown keys first: a misspelt field is also a missing one."""
    return 0 if fault["type"] == "extra_forbidden" else 1


def location(parts: tuple[Any, ...]) -> str:
    """A fault's place as it is written with ``--set``: ``bodies.cart.mass``, without the kinds that validation adds."""
    named = [str(part) for part in parts]
    if named[:1] in (["joints"], ["forces"]) and len(named) > 2:
        del named[2]  # the element's type
    while named and ("[" in named[-1] or named[-1] in ("int", "float", "str")):
        named.pop()  # the branch of a union
    return ".".join(named)


def _reason(fault: Any) -> str:
    found, context = fault.get("input"), fault.get("ctx", {})
    match fault["type"]:
        case "value_error":
            return str(context["error"])
        case "extra_forbidden":
            return f"found the unknown key '{fault['loc'][-1]}', expected one that the schema lists (stiffmbs schema)"
        case "missing":
            return "found nothing, expected a value (the key is required)"
        case "greater_than":
            return f"found {found}, expected a value greater than {context['gt']:g}"
        case "greater_than_equal":
            return f"found {found}, expected {context['ge']:g} or more"
        case "less_than_equal":
            return f"found {found}, expected {context['le']:g} or less"
        case "too_short" | "too_long":
            limit = context.get("min_length", context.get("max_length"))
            return f"found {context['actual_length']} values, expected {limit}"
        case "union_tag_not_found":
            return "found no 'type', expected one that the schema lists (stiffmbs schema)"
        case "union_tag_invalid":
            return f"found the type '{context['tag']}', expected one of {context['expected_tags']}"
        case "string_pattern_mismatch":
            return f"found '{found}', expected a name of letters, digits and _ that does not start with a digit"
        case "literal_error" | "enum":
            return f"found {found!r}, expected {context['expected']}"
        case "tuple_type" | "list_type":
            return f"found {found!r}, expected a list of numbers in brackets"
        case "dict_type" | "model_type" | "model_attributes_type":
            return f"found {found!r}, expected a mapping of keys to values"
        case _:
            return f"found {found!r}, expected {fault['msg'].removeprefix('Input should be ')}"
