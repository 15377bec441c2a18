"""Descriptions of flexible bodies in YAML files."""

from __future__ import annotations

from collections.abc import Sequence

from pydantic import ValidationError

from ..errors import InputError
from ..reading.fields import sentence
from ..reading.files.text_file import file_text, source_name
from ..reading.files.yaml_text import line_of, read_yaml
from .description import FlexibleBody


def read_flexible_body(path: str, changes: Sequence[tuple[str, str]] = ()) -> FlexibleBody:
    """Return the description in a file.

    `changes`: paths and values that replace those of the file, such as ``("modes", "10")``. Raises InputError: The
    message names the file and the line.
    """
    text, source = file_text(path, expected="the description of a flexible body"), source_name(path)
    found = read_yaml(text, source)
    if not isinstance(found, dict):
        raise InputError(
            f"{source}: found no mapping, expected the keys of a flexible body: mesh, units, interfaces ..."
        )
    for place, value in changes:
        _set(found, place, read_yaml(value, f"--set {place}"))
    try:
        return FlexibleBody.model_validate(found, context={})
    except ValidationError as error:
        message = sentence(error)
        line = line_of(text, tuple(message.split(":")[0].split(".")))
        raise InputError(f"{source}{f', line {line}, ' if line else ': '}{message}") from None


def _set(found: dict[str, object], path: str, value: object) -> None:
    *parents, key = path.split(".")
    place: object = found
    for parent in parents:
        place = place.setdefault(parent, {}) if isinstance(place, dict) else None
    if not isinstance(place, dict):
        raise InputError(f"--set {path}: found no mapping there, expected a key of the flexible body")
    place[key] = value
