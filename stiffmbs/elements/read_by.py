"""Fields whose entries functions read."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import BaseModel, GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo
from pydantic_core import CoreSchema, core_schema

from ..errors import InputError, prefixed
from ..reading.did_you_mean import did_you_mean
from ..reading.files.files_read import file_beside
from ..reading.files.quoted import written

Context = Mapping[str, Any] | None
JsonSchema = dict[str, object]


@dataclass(frozen=True)
class ReadBy:
    """Marker of a field with a reader of its own: ``Annotated[Road, ReadBy(read_road, schema_of_roads)]``.

    `read`: returns the value of an entry, given the entry and the validation context. `schema`: returns the JSON schema
    of the entries, given a function that returns the schema of a class.
    """

    read: Callable[[object, Context], object]
    schema: Callable[[Callable[[type[BaseModel]], JsonSchema]], JsonSchema]

    def __get_pydantic_core_schema__(self, source: object, handler: GetCoreSchemaHandler) -> CoreSchema:
        def read(found: object, info: ValidationInfo) -> object:
            return self.read(found, info.context)

        return core_schema.with_info_plain_validator_function(read)

    def __get_pydantic_json_schema__(self, schema: object, handler: GetJsonSchemaHandler) -> JsonSchema:
        return self.schema(lambda kind: handler(core_schema.definitions_schema(kind.__pydantic_core_schema__, [])))


def of_class(kind: Callable[[], type[BaseModel]]) -> ReadBy:
    """Return the marker of a field that takes entries of a class, which is imported where an entry is read."""
    return ReadBy(
        lambda found, context: kind().model_validate(found, context=context), lambda schema_of: schema_of(kind())
    )


def class_of(
    found: object, kinds: Mapping[str, Any], expected: str = "a mapping of keys to values", more: str = ""
) -> Any:
    """Return the class that the ``type`` of an entry selects.

    `expected`, `more`: what an entry is in place of a mapping, and further types, for messages. Raises ValueError.
    """
    if not isinstance(found, dict):
        raise ValueError(f"found {written(found)}, expected {expected}")
    kind = found.get("type")
    if not isinstance(kind, str) or kind not in kinds:
        shown = "no type" if kind is None else f"the type {written(kind)}{_suggested(kind, kinds)}"
        raise ValueError(f"found {shown}, expected one of {', '.join(map(repr, kinds))}{more}")
    return kinds[kind]


def _suggested(found: object, kinds: Mapping[str, Any]) -> str:
    """Return a question for a message, after an unknown type: the kind that other programs call so, or the nearest name."""
    of_others = (kind for kind, element in kinds.items() if found in getattr(element, "known_as", ()))
    kind = next(of_others, None)
    return f" (did you mean '{kind}'?)" if kind else did_you_mean(found, kinds)


def in_file(kind: type, read: Callable[[Path], object], description: str) -> ReadBy:
    """Return the marker of a field that takes an object, or the name of a file from which it is read."""

    def found_in_file(found: object, context: Context) -> object:
        """Return the object, or that of the named file."""
        if isinstance(found, kind):
            return found
        if not isinstance(found, str | Path):
            raise ValueError(f"found {written(found)}, expected the name of a file")
        with prefixed("", InputError, ValueError):
            return read(file_beside(context or {}, found))

    return ReadBy(found_in_file, lambda _: {"type": "string", "description": description})
