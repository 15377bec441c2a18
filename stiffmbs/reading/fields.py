"""Field types of the description: SI numbers that accept units, and the base class of all descriptions.

A field's type carries its dimension, unit and bounds. The schema, the reference pages and the error messages are
derived from it.
"""

from __future__ import annotations

import operator
import re
import sys
import unicodedata
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, ClassVar

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
from pydantic_core import CoreSchema, ErrorDetails, core_schema

from ..errors import InputError
from .did_you_mean import did_you_mean, instead_of
from .files.quoted import MOST_QUOTED, first_line, listed, quoted, written
from .files.yaml_text import quotes_hint
from .formula.text import FormulaError
from .units.quantity import in_si
from .units.units import DIMENSIONS, one

DOTTED_PATTERN = r"^[^\W\d]\w*(\.[^\W\d]\w*)*$"
"""Pattern of names that may include the names of parts: ``front.left.arm``; letters of any script."""


def is_name(text: object, dotted: bool = False) -> bool:
    """Return True for letters of any script, digits and _, not starting with a digit; `dotted`: with names of parts.

    Names have the form (NFKC) in which Python's parser returns them from formulas; others would not be found there.
    """
    if not isinstance(text, str) or unicodedata.normalize("NFKC", text) != text:
        return False
    return all(part.isidentifier() for part in (text.split(".") if dotted else (text,)))


def other_letters(name: object) -> str:
    """Return a hint for a name whose letters have another form in formulas, such as the micro sign; empty otherwise."""
    usual = unicodedata.normalize("NFKC", name) if isinstance(name, str) else ""
    return f": write '{quoted(usual)}' (NFKC)" if usual != name and is_name(usual, dotted=True) else ""


class _SignatureWhenAsked:
    """Signature of a class whose model is built on first use; reading the signature counts as a use."""

    def __get__(self, instance: object, described: Any) -> Any:
        described.model_rebuild()
        made = vars(described)["__signature__"]
        if made is self:
            raise AttributeError("__signature__")
        return made.__get__(instance, described)


def _evaluate_annotations(namespace: dict[str, Any]) -> None:
    """Replace the annotations of a class by types: pydantic would compile each one again for every derived class.

    They stay texts if a name is unknown as yet, or if names of a function around the class may be meant.
    """
    texts = namespace.get("__annotations__", {})
    is_of_module = "<locals>" not in namespace.get("__qualname__", "<locals>")
    if texts and is_of_module and all(type(text) is str for text in texts.values()):
        with suppress(Exception):  # pydantic reports faults
            types = eval(f"{', '.join(texts.values())},", vars(sys.modules[namespace["__module__"]]), namespace)
            texts.update(zip(texts, types, strict=True))


class _OneSentence(type(BaseModel)):  # type: ignore[misc]
    """Metaclass that reports errors of construction and of class definition as `InputError`."""

    def __new__(mcs, name: str, bases: tuple[type, ...], namespace: dict[str, Any], **options: object) -> Any:
        _evaluate_annotations(namespace)
        try:
            made = super().__new__(mcs, name, bases, namespace, **options)
        except PydanticUserError as error:
            raise InputError(f"{name}: {first_line(error)}") from error
        if not made.__pydantic_complete__:
            made.__signature__ = _SignatureWhenAsked()
        return made

    def __call__(cls, *unnamed: object, **fields: object) -> Any:
        if unnamed:
            names = ", ".join(f"{field.alias or name}=..." for name, field in cls.model_fields.items())
            found = ", ".join(map(repr, unnamed))
            raise InputError(f"{cls.__name__}: found {found} without a name, expected names of fields: {names}")
        try:
            return super().__call__(**fields)
        except PydanticError as error:
            raise InputError(f"{cls.__name__}: {sentence(error)}") from None
        except PydanticUserError as error:  # a type that was unknown when the class was defined
            raise InputError(f"{cls.__name__}: {first_line(error)}") from error


if TYPE_CHECKING:
    _Base = BaseModel
else:

    class _Base(BaseModel, metaclass=_OneSentence):
        """Model whose construction errors are single sentences."""

        model_config = ConfigDict(defer_build=True)

        @classmethod
        def model_rebuild(cls, *, _parent_namespace_depth: int = 2, **options: object) -> bool | None:
            """Build the class on first use; skip the rebuild of a generic class whose type is chosen, as no object of it exists."""
            is_complete = getattr(cls, "__pydantic_fields_complete__", False)  # since pydantic 2.11
            if options.get("_types_namespace") is not None and is_complete:
                return None
            return super().model_rebuild(_parent_namespace_depth=_parent_namespace_depth + 1, **options)


class Described(_Base):
    """Base of all descriptions: immutable, without unknown keys, with errors of one sentence.

    Raises
    ------
    InputError
        If a field is missing, unknown, of the wrong type or out of its bounds.
    """

    written_as: ClassVar[Mapping[str, str]] = {}
    """Texts of messages on what to write in place of keys that were renamed, or that other programs have."""

    model_config = ConfigDict(frozen=True, extra="forbid", arbitrary_types_allowed=True, defer_build=True)

    def __repr_args__(self) -> Iterator[tuple[str, object]]:
        """Yield the fields that differ from their defaults, for ``repr``."""
        for name, field in type(self).model_fields.items():
            value = getattr(self, name)
            if name != "type" and value != field.get_default(call_default_factory=True):
                yield field.alias or name, value

    @model_validator(mode="before")
    @classmethod
    def _of_known_keys(cls, found: object) -> object:
        """Refuse unknown keys, and convert NumPy arrays and numbers to Python objects."""
        if not isinstance(found, dict):
            return found
        known = _keys(cls)
        for key in found:
            if key in cls.written_as and key not in known:
                raise ValueError(f"found '{key}', expected {cls.written_as[key]}")
            if key not in known:
                raise ValueError(f"found the unknown key '{quoted(key)}'{instead_of(key, known)}{quotes_hint(key)}")
        return {key: value.tolist() if hasattr(value, "tolist") else value for key, value in found.items()}


@cache
def _keys(described: type[Described]) -> tuple[str, ...]:
    return tuple(field.alias or name for name, field in described.model_fields.items())


@dataclass(frozen=True)
class Measured:
    """Marker of a field as a finite number of a dimension: ``mass: Annotated[float, Measured("mass", above=0)]``.

    Values are in SI units or text with units, as are the bounds and the excluded value.
    """

    dimension: str  # one of `stiffmbs.reading.units.units.DIMENSIONS`
    above: float | None = None
    at_least: float | None = None
    at_most: float | None = None
    other_than: float | None = None

    def read(self, found: object, info: ValidationInfo) -> float:
        """Return the SI value of an entry of a scene.

        Raise a FormulaError if it is not a number of the dimension within the bounds.
        """
        value = in_si(found, self.dimension, (info.context or {}).get("parameters"))
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

    def __get_pydantic_core_schema__(self, source: object, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_plain_validator_function(
            self.read, serialization=core_schema.plain_serializer_function_ser_schema(lambda value: value)
        )

    def __get_pydantic_json_schema__(self, schema: object, handler: GetJsonSchemaHandler) -> dict[str, object]:
        bounds = {"exclusiveMinimum": self.above, "minimum": self.at_least, "maximum": self.at_most}
        number: dict[str, object] = {name: bound for name, bound in bounds.items() if bound is not None}
        excluded = {} if self.other_than is None else {"not": {"const": self.other_than}}
        unit = DIMENSIONS[self.dimension][1]
        text = {"type": "string", "description": f"a formula with units that converts to {unit}"}
        return {"anyOf": [{"type": "number", **number, **excluded}, text], "description": f"{self.dimension}, {unit}"}


def mapping(found: object, where: str, of: str = "names to entries") -> dict[Any, Any]:
    """Return a mapping as written. Raises InputError for anything else; `of` are its contents, for the message."""
    if not isinstance(found, dict):
        raise InputError(f"{where}: found {written(found)}, expected a mapping of {of}")
    return found


def named_entries(section: str, found: object, values: str) -> Iterator[tuple[str, object]]:
    """Yield the entries of a section of a scene.

    `found`: the section as written. `values`: kind of the entries, for messages. Raises InputError if the section is
    not a mapping, or a name is not an identifier.
    """
    for name, entry in mapping({} if found is None else found, section, f"names to {values}").items():
        if not is_name(name):
            raise InputError(
                f"{section}: found the name {written(name)}, expected letters, digits and _{quotes_hint(name)}{other_letters(name)}"
            )
        yield name, entry


def sentence(error: PydanticError) -> str:
    """Return the first fault of a validation as one sentence: location, found, expected."""
    faults = error.errors(include_url=False)
    fault = faults[0]
    where = location(fault["loc"])
    others = [place for place in dict.fromkeys(location(other["loc"]) for other in faults) if place != where]
    more = f" (and {len(others)} more: {listed(others)})" if others else ""
    return f"{where}{': ' if where else ''}{_reason(fault)}{more}"


@contextmanager
def located(where: str) -> Iterator[None]:
    """Raise an `InputError` with its place in a scene for a fault of a field, a formula or another value."""
    try:
        yield
    except ValueError as error:  # FormulaError and ValidationError are such errors
        message = sentence(error) if isinstance(error, PydanticError) else str(error)
        begins_with_field = isinstance(error, PydanticError) and " " not in message.partition(":")[0]
        raise InputError(f"{where}{'.' if begins_with_field else ': '}{message}") from None


def is_valid(described: type[Described], found: object, context: Mapping[str, object]) -> bool:
    """Return True if an entry can be read as a description."""
    try:
        described.model_validate(found, context=dict(context))
    except PydanticError:
        return False
    return True


def location(parts: tuple[object, ...]) -> str:
    """Return the path of a fault in the form of ``--set``: ``bodies.cart.mass``, without the branches of unions."""
    named = [str(part) for part in parts]
    while named and ("[" in named[-1] or named[-1] in ("int", "float", "str")):
        named.pop()  # the branch of a union
    return ".".join(named)


def _reason(fault: ErrorDetails) -> str:
    found, context = fault.get("input"), fault.get("ctx", {})
    match fault["type"]:
        case "value_error":
            return str(context["error"])
        case "missing":
            return "found nothing, expected a value (the key is required)"
        case "too_short" | "too_long":
            limit = context.get("min_length", context.get("max_length"))
            return f"found {context['actual_length']} values, expected {limit}{_divided_formula(found)}"
        case "string_pattern_mismatch":
            return f"found '{quoted(found)}', expected a name of letters, digits and _ that does not start with a digit"
        case "literal_error" | "enum":
            near = did_you_mean(found, re.findall("'([^']*)'", context["expected"])) if isinstance(found, str) else ""
            return f"found {written(found)}{near}, expected {context['expected']}"
        case "tuple_type" | "list_type":
            example = _as_list(found, of_gravity="gravity" in fault["loc"])
            like = isinstance(found, str | int | float) and len(example) <= MOST_QUOTED
            return f"found {written(found)}, expected a list in brackets{f': {example}' if like else ''}"
        case "dict_type" | "model_type" | "model_attributes_type":
            return f"found {written(found)}, expected a mapping of keys to values"
        case _:
            return f"found {written(found)}, expected {fault['msg'].removeprefix('Input should be ')}"


def _divided_formula(found: object) -> str:
    """Return a hint if a list has a formula that YAML has divided at its commas."""
    texts = [part for part in found if isinstance(part, str)] if isinstance(found, list | tuple) else []
    is_divided = any(part.count("(") != part.count(")") for part in texts)
    return """; a formula with a comma needs quotes in a list, as in [0, "max(x, 0)"]""" if is_divided else ""


def _as_list(found: object, of_gravity: bool) -> str:
    """Return a list in brackets with an entry that was given without them; numbers and formulas are parts of vectors."""
    if of_gravity and isinstance(found, int | float):
        return f"[0, {found}], or [0, 0, {found}] in space"
    is_name = isinstance(found, str) and all(part.isidentifier() for part in found.split("."))
    return f"[{found}]" if is_name else f"[{found}, ...]"


def typed(kind: str, found: object) -> object:
    """Return an entry with its type filled in; raise a ValueError if it has another type than this kind."""
    if not isinstance(found, dict):
        return found
    if found.get("type", kind) != kind:
        raise ValueError(f"found the type '{quoted(found['type'])}', expected '{kind}'")
    return {**found, "type": kind}


def exactly_one(first: tuple[str, object], second: tuple[str, object]) -> None:
    """Raise a ValueError with the message of an input error if both or neither of two fields, (name, value), are given."""
    names = f"'{first[0]}' and '{second[0]}'"
    given = sum(value is not None for _, value in (first, second))
    if given != 1:
        raise ValueError(f"found {'both' if given else 'neither'} of {names}, expected exactly one of them")
