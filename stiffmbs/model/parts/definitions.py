"""Definitions of parts in a scene and in the package."""

from __future__ import annotations

import copy
import functools
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ...errors import InputError
from ...reading.did_you_mean import did_you_mean, instead_of
from ...reading.fields import located
from ...reading.files.include import read_including
from ...reading.files.quoted import written
from ...reading.files.yaml_text import Content, read_yaml
from ...reading.units.units import Quantity
from .frame import Use
from .options import OPTIONS, choices_of
from .placing import NAMED
from .vectors import Vectors, in_components, parameters_in_components

FOLDER = Path(__file__).parents[1] / "shipped_parts"


@functools.cache
def _files() -> dict[str, Path]:
    """Return the file of each part of the package."""
    return {file.stem: file for pattern in ("*.yaml", "driveline/*.yaml") for file in FOLDER.glob(pattern)}


def shipped_parts() -> tuple[str, ...]:
    """Return the names of all parts of the package."""
    return tuple(sorted(_files()))


def shipped_part(name: str) -> dict[str, object] | None:
    """Return the definition of a part of the package, read-only; None for any other name."""
    return _read(name) if name in shipped_parts() else None


def shipped_text(name: str) -> str:
    """Return the text of the file of a part of the package."""
    return _files()[name].read_text(encoding="utf-8")


def about(name: str) -> str:
    """Return the description of a part of the package, the comment in the first line of its file."""
    return shipped_text(name).partition("\n")[0].removeprefix("# ")


def included_texts(name: str) -> tuple[str, ...]:
    """Return the texts of the files that a part of the package includes."""
    found = read_yaml(shipped_text(name), f"{name}.yaml").get("include") or []
    names = [found] if isinstance(found, str) else found
    return tuple((_files()[name].parent / each).read_text(encoding="utf-8") for each in names)


@functools.cache
def _read(name: str) -> dict[str, object]:
    found: dict[str, object]
    found, _ = read_including(shipped_text(name), f"{name}.yaml", _files()[name])
    return found


KEYS = ("parameters", "limits", "markers", *NAMED, "use", "mounts", OPTIONS)


@dataclass(frozen=True)
class Definitions:
    """Reader of definitions, and of the entries that use them.

    `parts`: definitions of the scene. `kind`: for the plane or space.
    """

    parts: Any
    kind: type[Use]

    def written(self, part: str) -> Any:
        """Return a definition of the scene or of the package, as written."""
        own = self.parts if isinstance(self.parts, dict) else {}
        return own[part] if part in own else shipped_part(part)

    def choices(self, part: str) -> dict[str, Content]:
        """Return the options of a definition."""
        found = self.written(part)
        return choices_of(found, f"parts.{part}.{OPTIONS}") if isinstance(found, dict) else {}

    def use(self, where: str, entry: object, parameters: Mapping[str, Quantity]) -> tuple[Use, Content]:
        """Return an entry of ``use``, and its chosen words."""
        if not isinstance(entry, dict):
            raise InputError(f"{where}: found {written(entry)}, expected a mapping with 'part'")
        choices = self.choices(entry["part"]) if isinstance(entry.get("part"), str) else {}
        words = {name: entry[name] for name in choices if name in entry}
        for name, word in words.items():
            if word not in choices[name]:
                raise InputError(f"{where}.{name}: found {written(word)}{instead_of(word, choices[name])}")
        entry = {key: value for key, value in entry.items() if key not in words}
        keys = (*self.kind.model_fields, *choices)
        for key in entry:
            if key not in keys:
                raise InputError(f"{where}: found the unknown key {written(key)}{instead_of(key, keys)}")
        with located(where):
            use = self.kind.model_validate(entry, context={"parameters": parameters})
        if self.written(use.part) is None:
            own = list(map(str, self.parts)) if isinstance(self.parts, dict) else []
            near = did_you_mean(use.part, (*shipped_parts(), *own))
            raise InputError(
                f"{where}.part: found '{use.part}'{near}, expected one of parts ({', '.join(own) or 'none'}), or of those that come "
                f"with the package ({', '.join(shipped_parts())})"
            )
        return use, words

    def of(self, part: str) -> dict[str, object]:
        """Return a copy of the definition of a part. Raises InputError if it is not a mapping, or has unknown keys."""
        found = self.written(part)
        if not isinstance(found, dict):
            raise InputError(f"parts.{part}: found {written(found)}, expected a mapping with 'bodies'")
        branches = (each for words in self.choices(part).values() for each in words.values())
        for key in (key for sections in (found, *branches) for key in sections or ()):
            if key not in KEYS:
                raise InputError(f"parts.{part}: found the unknown key {written(key)}{instead_of(key, KEYS)}")
        return copy.deepcopy(found)


def definition_in_components(definition: dict[str, object], vectors: Vectors, where: str) -> dict[str, object]:
    """Return a definition with vectors replaced by their components."""
    with located(where):
        parameters = parameters_in_components(definition.get("parameters"), vectors, f"{where}.parameters")
        rest = in_components({key: value for key, value in definition.items() if key != "parameters"}, vectors)
    return {"parameters": parameters, **rest}
