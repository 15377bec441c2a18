"""The instances of parts that a scene's ``use`` asks for, before their entries are validated."""

from __future__ import annotations

import copy
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from pydantic import ValidationError as PydanticError

from ...errors import InputError
from ..body import check_names
from ..fields import sentence
from ..files.expand import repeat_entries, set_value
from ..files.quoted import written
from ..units.units import Quantity
from .names import MOUNT, beginnings
from .parameters import parameters_of
from .use import Use

NAMED = ("bodies", "states", "joints", "forces", "requests")
"""What a part holds by names that formulas and other entries may use."""
REPEATED = ("bodies", "states", "joints", "forces")
KEYS = ("parameters", "markers", *NAMED, "use")
MOST_NESTED = 10
"""Parts within parts."""
MOST_INSTANCES = 10_000
MOST_VALUES = 1_000_000
"""Numbers, texts, lists and mappings in all instances together."""


@dataclass(frozen=True)
class Instance:
    """A part in its place.

    Attributes
    ----------
    name : str
        In full, as ``front.left``.
    part : str
        The name of its definition.
    use : Use
    sections : mapping
        Markers, bodies, joints, forces and requests as they are written, repeated entries written out.
    parameters : mapping of str to Quantity
        The scene's and its own.
    outer : Instance or None
        The instance that it stands in.
    inner : tuple of str
        The names of instances that stand in it, as it calls them.
    """

    name: str
    part: str
    use: Use
    sections: Mapping[str, Any]
    parameters: Mapping[str, Quantity]
    outer: Instance | None = None
    inner: tuple[str, ...] = ()

    @property
    def where(self) -> str:
        """The path of its definition in the scene."""
        return f"parts.{self.part}"

    def names(self, section: str) -> Iterator[str]:
        """The names in a section, in full."""
        yield from (f"{self.name}.{name}" for name in self.sections.get(section) or {})

    def local(self) -> dict[str, str]:
        """Its short names, and the full names that they stand for."""
        named = [*self.inner, *(name for section in NAMED for name in self.sections.get(section) or {})]
        return {name: f"{self.name}.{name}" for name in named}


@dataclass
class Instances:
    """Reads the instances of a scene, each before those that stand in it.

    Attributes
    ----------
    parts : mapping
        The definitions.
    kind : type of Use
        Of the plane or of space.
    changes : list of (path, value)
        What is set in instances from outside; what is found is taken out of the list.
    """

    parts: Any
    kind: type[Use]
    changes: list[tuple[str, Any]]
    values: int = 0
    found: list[Instance] = field(default_factory=list)

    def read(
        self, used: Any, parameters: Mapping[str, Quantity], outer: Instance | None = None, depth: int = 0
    ) -> None:
        """Add the instances of a ``use`` and all that stand in them.

        Raises
        ------
        InputError
            For a part that is not there, that uses itself, or that cannot be read.
        """
        where = f"{outer.where}.use" if outer else "use"
        if not isinstance(used, dict):
            raise InputError(f"{where}: found {written(used)}, expected a mapping of names to parts")
        for name, entry in repeat_entries(where, used, parameters).items():
            _check_name(where, name)
            use = self._use(f"{where}.{name}", entry, parameters)
            above = [*_above(outer)]
            if use.part in (one.part for one in above):
                raise InputError(f"{where}.{name}: found '{use.part}', which it stands in, expected another part")
            if depth >= MOST_NESTED:
                raise InputError(f"{where}.{name}: found parts nested deeper than {MOST_NESTED}, expected fewer")
            self._add(f"{outer.name}.{name}" if outer else name, use, f"{where}.{name}", parameters, outer, depth)

    def _use(self, where: str, entry: Any, parameters: Mapping[str, Quantity]) -> Use:
        if not isinstance(entry, dict):
            raise InputError(f"{where}: found {written(entry)}, expected a mapping with 'part'")
        try:
            use = self.kind.model_validate(entry, context={"parameters": parameters})
        except PydanticError as error:
            message = sentence(error)
            raise InputError(
                f"{where}{'' if message.startswith('found') else '.'}{': ' if message.startswith('found') else ''}{message}"
            ) from None
        if not isinstance(self.parts, dict) or use.part not in self.parts:
            known = ", ".join(map(str, self.parts)) if isinstance(self.parts, dict) else ""
            raise InputError(f"{where}.part: found '{use.part}', expected one of parts ({known or 'none'})")
        return use

    def _add(
        self, name: str, use: Use, where: str, parameters: Mapping[str, Quantity], outer: Instance | None, depth: int
    ) -> None:
        if len(self.found) >= MOST_INSTANCES:
            raise InputError(f"{where}: found more than {MOST_INSTANCES} parts in their places, expected fewer")
        definition = self._definition(use.part)
        own = parameters_of(use, where, definition.get("parameters"), parameters)
        self._set(name, definition)
        sections = {
            section: repeat_entries(f"parts.{use.part}.{section}", definition[section], own) if section in REPEATED else definition[section]
            for section in (*NAMED, "markers") if definition.get(section) is not None
        }  # fmt: skip
        used = definition.get("use") or {}
        inner = tuple(repeat_entries(f"parts.{use.part}.use", used, own)) if isinstance(used, dict) else ()
        _check_sections(use.part, sections, inner)
        self._count(where, sections)
        instance = Instance(name, use.part, use, sections, own, outer, inner)
        self.found.append(instance)
        if used:
            self.read(used, own, instance, depth + 1)

    def _definition(self, part: str) -> dict[str, Any]:
        found = self.parts[part]
        if not isinstance(found, dict):
            raise InputError(f"parts.{part}: found {written(found)}, expected a mapping with 'bodies'")
        for key in found:
            if key not in KEYS:
                raise InputError(
                    f"parts.{part}: found the unknown key {written(key)}, expected one of {', '.join(KEYS)}"
                )
        self._count(f"parts.{part}", found)
        return copy.deepcopy(found)

    def _count(self, where: str, found: Any) -> None:
        self.values += _size(found, MOST_VALUES)
        if self.values > MOST_VALUES:
            raise InputError(f"{where}: found parts of more than {MOST_VALUES} values in all, expected fewer")

    def _set(self, instance: str, definition: dict[str, Any]) -> None:
        """Put what is set from outside in place of what the definition has."""
        for change in list(self.changes):
            path, value = change
            section, _, rest = path.partition(".")
            entries = definition.get(section)
            own = rest.removeprefix(f"{instance}.")
            if isinstance(entries, dict) and own != rest and any(start in entries for start, _ in beginnings(own)):
                set_value(definition, f"{section}.{own}", value)
                self.changes.remove(change)


def set_in_instances(path: str, used: Any) -> bool:
    """Whether a path leads to an entry of an instance, which is not written in the scene: ``bodies.front.left.arm.mass``."""
    section, _, rest = path.partition(".")
    if section not in (*NAMED, "markers") or not isinstance(used, dict):
        return False
    return any(re.match(rf"{_any_number(str(name))}\.", rest) for name in used)


def _any_number(name: str) -> str:
    """A name of a repeated entry as a regular expression."""
    return ".+?".join(re.escape(part) for part in re.split(r"\{[^{}]*\}", name))


def _above(instance: Instance | None) -> Iterator[Instance]:
    while instance is not None:
        yield instance
        instance = instance.outer


def _check_name(where: str, name: Any) -> None:
    try:
        check_names([name], "a part")
    except ValueError as error:
        raise InputError(f"{where}: {error}") from None
    if name.partition(".")[0] == MOUNT:
        raise InputError(f"{where}.{name}: found the name of what a part is placed on, expected another")


def _check_sections(part: str, sections: Mapping[str, Any], inner: Sequence[str]) -> None:
    seen = dict.fromkeys(inner, "use")
    for section, entries in sections.items():
        where = f"parts.{part}.{section}"
        if not isinstance(entries, dict):
            raise InputError(f"{where}: found {written(entries)}, expected a mapping of names to entries")
        for name in entries:
            _check_name(where, name)
            if section in NAMED and name in seen:
                raise InputError(f"{where}.{name}: found a name that {seen[name]}.{name} has too, expected another")
            if section in NAMED:
                seen[name] = section


def _size(found: Any, most: int) -> int:
    """How many values there are, aliases counted as what they stand for; no more than one above `most`."""
    count, waiting = 0, [found]
    while waiting and count <= most:
        value = waiting.pop()
        count += 1
        if isinstance(value, dict):
            waiting += value.values()
        elif isinstance(value, list):
            waiting += value
    return count
