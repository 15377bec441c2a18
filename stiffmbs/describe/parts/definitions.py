"""Definitions of parts in a scene and in the package."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import ValidationError as PydanticError

from ...errors import InputError
from ..fields import sentence
from ..files.quoted import written
from ..formula.text import FormulaError
from ..units.units import Quantity
from .library import shipped_part, shipped_parts
from .options import OPTIONS, choices_of
from .use import Use
from .vectors import Vectors, in_components, parameters_in_components

NAMED = ("bodies", "states", "joints", "forces", "requests")
"""Sections of a part whose names formulas and other entries can use."""
KEYS = ("parameters", "markers", *NAMED, "use", "mounts", OPTIONS)


@dataclass(frozen=True)
class Definitions:
    """Reader of definitions, and of the entries that use them.

    Attributes
    ----------
    parts : mapping
        Definitions of the scene.
    kind : type of Use
        For the plane or space.
    """

    parts: Any
    kind: type[Use]

    def written(self, part: str) -> Any:
        """Return a definition of the scene or of the package, as written."""
        own = self.parts if isinstance(self.parts, dict) else {}
        return own[part] if part in own else shipped_part(part)

    def choices(self, part: str) -> dict[str, dict[str, Any]]:
        """Return the options of a definition."""
        found = self.written(part)
        return choices_of(found, f"parts.{part}.{OPTIONS}") if isinstance(found, dict) else {}

    def use(self, where: str, entry: Any, parameters: Mapping[str, Quantity]) -> tuple[Use, dict[str, Any]]:
        """Return an entry of ``use``, and its chosen words."""
        if not isinstance(entry, dict):
            raise InputError(f"{where}: found {written(entry)}, expected a mapping with 'part'")
        choices = self.choices(entry["part"]) if isinstance(entry.get("part"), str) else {}
        words = {name: entry[name] for name in choices if name in entry}
        for name, word in words.items():
            if word not in choices[name]:
                raise InputError(f"{where}.{name}: found {written(word)}, expected one of {', '.join(choices[name])}")
        entry = {key: value for key, value in entry.items() if key not in words}
        keys = (*self.kind.model_fields, *choices)
        for key in entry:
            if key not in keys:
                raise InputError(f"{where}: found the unknown key {written(key)}, expected one of {', '.join(keys)}")
        try:
            use = self.kind.model_validate(entry, context={"parameters": parameters})
        except PydanticError as error:
            message = sentence(error)
            raise InputError(
                f"{where}{'' if message.startswith('found') else '.'}{': ' if message.startswith('found') else ''}{message}"
            ) from None
        if self.written(use.part) is None:
            known = ", ".join(map(str, self.parts)) if isinstance(self.parts, dict) else ""
            raise InputError(
                f"{where}.part: found '{use.part}', expected one of parts ({known or 'none'}), or of those that come with the "
                f"package ({', '.join(shipped_parts())})"
            )
        return use, words

    def of(self, part: str) -> dict[str, Any]:
        """Return a copy of the definition of a part.

        Raises
        ------
        InputError
            If it is not a mapping, or has unknown keys.
        """
        found = self.written(part)
        if not isinstance(found, dict):
            raise InputError(f"parts.{part}: found {written(found)}, expected a mapping with 'bodies'")
        branches = (each for words in self.choices(part).values() for each in words.values())
        for key in (key for sections in (found, *branches) for key in sections or ()):
            if key not in KEYS:
                raise InputError(
                    f"parts.{part}: found the unknown key {written(key)}, expected one of {', '.join(KEYS)}"
                )
        return copy.deepcopy(found)


def definition_in_components(definition: dict[str, Any], vectors: Vectors, where: str) -> dict[str, Any]:
    """Return a definition with vectors replaced by their components."""
    try:
        parameters = parameters_in_components(definition.get("parameters"), vectors, f"{where}.parameters")
        rest = in_components({key: value for key, value in definition.items() if key != "parameters"}, vectors)
    except FormulaError as error:
        raise InputError(f"{where}: {error}") from None
    return {"parameters": parameters, **rest}
