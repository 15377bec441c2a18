"""Field types of the description: SI numbers that may be written with units, and the base of everything described.

A field's type carries its dimension, unit and bounds, so that the schema, the reference pages and the error
messages all come from the one place where an element names its fields.
"""

from __future__ import annotations

import operator
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

from pydantic import (
    BaseModel,
    ConfigDict,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    PydanticUserError,
    ValidationInfo,
    model_validator,
)
from pydantic import ValidationError as PydanticError
from pydantic_core import core_schema

from ..errors import InputError
from .files.followed import FOLLOWED
from .files.quoted import quoted, written
from .formula.text import FormulaError
from .units.quantity import in_si
from .units.units import DIMENSIONS, Quantity, one

NAME_PATTERN = r"^[A-Za-z_][A-Za-z0-9_]*$"
DOTTED_PATTERN = r"^[A-Za-z_][A-Za-z0-9_]*(\.[A-Za-z_][A-Za-z0-9_]*)*$"
"""Of what may stand in a part: ``front.left.arm``."""


class _SignatureWhenAsked:
    """The signature of a class that is built when it is used: being asked for it is a use."""

    def __get__(self, instance: object, described: Any) -> Any:
        described.model_rebuild()
        made = vars(described)["__signature__"]
        if made is self:
            raise AttributeError("__signature__")
        return made.__get__(instance, described)


class _OneSentence(type(BaseModel)):  # type: ignore[misc]
    """Makes a direct construction, and a class that cannot be made, fail with the package's own error."""

    def __new__(mcs, name: str, *arguments: Any, **options: Any) -> Any:
        try:
            made = super().__new__(mcs, name, *arguments, **options)
        except PydanticUserError as error:
            raise InputError(f"{name}: {_first_line(error)}") from error
        if not made.__pydantic_complete__:
            made.__signature__ = _SignatureWhenAsked()
        return made

    def __call__(cls, *unnamed: Any, **fields: Any) -> Any:
        if unnamed:
            names = ", ".join(f"{field.alias or name}=..." for name, field in cls.model_fields.items())
            found = ", ".join(map(repr, unnamed))
            raise InputError(f"{cls.__name__}: found {found} without a name, expected names of fields: {names}")
        try:
            return super().__call__(**fields)
        except PydanticError as error:
            raise InputError(f"{cls.__name__}: {sentence(error)}") from None
        except PydanticUserError as error:  # a type that was not known where the class was made
            raise InputError(f"{cls.__name__}: {_first_line(error)}") from error


def _first_line(error: Exception) -> str:
    return str(error).splitlines()[0]


if TYPE_CHECKING:
    _Base = BaseModel
else:

    class _Base(BaseModel, metaclass=_OneSentence):
        """A model whose construction fails in one sentence."""


class Described(_Base):
    """Base of all descriptions: frozen, no unknown keys, and errors of one sentence.

    Raises
    ------
    InputError
        When a field is missing, unknown, of the wrong type or out of its bounds.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", arbitrary_types_allowed=True, defer_build=True)

    def __repr_args__(self) -> Iterator[tuple[str, Any]]:
        """The fields that do not have their defaults, for ``repr``."""
        for name, field in type(self).model_fields.items():
            value = getattr(self, name)
            if name != "type" and value != field.get_default(call_default_factory=True):
                yield field.alias or name, value

    @model_validator(mode="before")
    @classmethod
    def _no_unknown_key(cls, found: Any) -> Any:
        if isinstance(found, dict):
            known = _keys(cls)
            for key in found:
                if key not in known:
                    raise ValueError(f"found the unknown key '{quoted(key)}', expected one of {', '.join(known)}")
        return found

    @model_validator(mode="before")
    @classmethod
    def _arrays_as_lists(cls, found: Any) -> Any:
        """NumPy's arrays and numbers as Python's, so that no field has to know both."""
        if not isinstance(found, dict):
            return found
        return {key: value.tolist() if hasattr(value, "tolist") else value for key, value in found.items()}


@cache
def _keys(described: type[Described]) -> tuple[str, ...]:
    """The keys that the fields of a class have in scenes."""
    return tuple(field.alias or name for name, field in described.model_fields.items())


@dataclass(frozen=True)
class Measured:
    """Marks a field as a finite number of a dimension: ``mass: Annotated[float, Measured("mass", above=0)]``.

    Written in SI units, or as text with units that converts to them.

    Parameters
    ----------
    dimension : str
        One of `stiffmbs.describe.units.units.DIMENSIONS`.
    above, at_least, at_most, other_than : float, optional
        Bounds, and a number that is none of them, in SI units.
    """

    dimension: str
    above: float | None = None
    at_least: float | None = None
    at_most: float | None = None
    other_than: float | None = None

    def read(self, found: object, info: ValidationInfo) -> Any:
        """The SI value of what stands in the scene, or what follows it through other values (`stiffmbs.describe.files.followed`)."""
        context = info.context or {}
        record = context.get(FOLLOWED)
        if record is not None and record.follows(found):
            return record.read(self, found)
        return self.si_value(found, context.get("parameters"))

    def si_value(self, found: object, parameters: Mapping[str, Quantity] | None) -> float:
        """The SI value of what stands in the scene.

        Raises
        ------
        FormulaError
            When it is no number of the dimension, or out of its bounds.
        """
        value = in_si(found, self.dimension, parameters)
        unit = DIMENSIONS[self.dimension][1].removeprefix("1").removeprefix("SI units")
        for bound, holds, words in (
            (self.above, operator.gt, "greater than {}"),
            (self.at_least, operator.ge, "of {} or more"),
            (self.at_most, operator.le, "of {} or less"),
            (self.other_than, operator.ne, "other than {}"),
        ):
            if bound is not None and not holds(value, bound):
                limit = f"{bound:g} {unit}".strip()
                raise FormulaError(f"found {quoted(found)}, expected {one(self.dimension)} {words.format(limit)}")
        return value

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> Any:
        return core_schema.with_info_plain_validator_function(
            self.read, serialization=core_schema.plain_serializer_function_ser_schema(lambda value: value)
        )

    def __get_pydantic_json_schema__(self, schema: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        bounds = {"exclusiveMinimum": self.above, "minimum": self.at_least, "maximum": self.at_most}
        number: dict[str, Any] = {name: bound for name, bound in bounds.items() if bound is not None}
        excluded = {} if self.other_than is None else {"not": {"const": self.other_than}}
        unit = DIMENSIONS[self.dimension][1]
        text = {"type": "string", "description": f"a formula with units that converts to {unit}"}
        return {"anyOf": [{"type": "number", **number, **excluded}, text], "description": f"{self.dimension}, {unit}"}


def sentence(error: PydanticError) -> str:
    """The first fault of a validation as one sentence: where, what was found, what was expected."""
    faults = error.errors(include_url=False)
    fault = faults[0]
    where = location(fault["loc"])
    others = {location(other["loc"]) for other in faults} - {where}
    more = f" (and {len(others)} more)" if others else ""
    return f"{where}{': ' if where else ''}{_reason(fault)}{more}"


def location(parts: tuple[Any, ...]) -> str:
    """A fault's place as it is written with ``--set``: ``bodies.cart.mass``, without the branches that validation adds."""
    named = [str(part) for part in parts]
    while named and ("[" in named[-1] or named[-1] in ("int", "float", "str")):
        named.pop()  # the branch of a union
    return ".".join(named)


def _reason(fault: Any) -> str:
    found, context = fault.get("input"), fault.get("ctx", {})
    match fault["type"]:
        case "value_error":
            return str(context["error"])
        case "missing":
            return "found nothing, expected a value (the key is required)"
        case "too_short" | "too_long":
            limit = context.get("min_length", context.get("max_length"))
            return f"found {context['actual_length']} values, expected {limit}"
        case "string_pattern_mismatch":
            return f"found '{quoted(found)}', expected a name of letters, digits and _ that does not start with a digit"
        case "literal_error" | "enum":
            return f"found {written(found)}, expected {context['expected']}"
        case "tuple_type" | "list_type":
            return f"found {written(found)}, expected a list in brackets"
        case "dict_type" | "model_type" | "model_attributes_type":
            return f"found {written(found)}, expected a mapping of keys to values"
        case _:
            return f"found {written(found)}, expected {fault['msg'].removeprefix('Input should be ')}"


def typed(kind: str, found: Any) -> Any:
    """An entry as it was found, its type filled in.

    Raises
    ------
    ValueError
        When it has another type than this kind.
    """
    if not isinstance(found, dict):
        return found
    if found.get("type", kind) != kind:
        raise ValueError(f"found the type '{quoted(found['type'])}', expected '{kind}'")
    return {**found, "type": kind}
