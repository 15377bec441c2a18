"""Changes from outside of entries that a repetition or an instance of a part makes."""

from __future__ import annotations

import copy
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

from ...errors import InputError
from ...reading.did_you_mean import did_you_mean
from ...reading.files.yaml_text import Content
from ...reading.names import beginnings
from ..files.expand import set_value
from .definitions import shipped_part
from .frame import Use
from .options import OPTIONS
from .placing import NAMED
from .vectors import COMPONENTS, Vectors, in_components

REPEATED = ("variables", "states", "bodies", "joints", "forces")
"""Sections of a scene whose entries may be repeated."""
PARAMETERS = "parameters"
KEYS_OF_USE = (*Use.model_fields, "position", "angle", "orientation", "mirror", "for")
"""Keys of an entry of ``use``, in the plane or in space."""
NO_VECTORS: Vectors = MappingProxyType({})
OF_VECTOR = re.compile(r"parameters\.(\w+?)(?:\.(\d)|_([xyz]))?")
"""Path of a vector parameter in a use, or of one of its components: by its place, or by the name of the component."""


def set_now(scene: Content, path: str, value: object) -> None:
    """Set the value of a scene at a path that `set_later` does not defer; errors as for `set_value`."""
    section, _, rest = path.partition(".")
    name = _literal(scene.get(section), rest) if section in ("use", "parts") else None
    if name is not None and len(rest) > len(name):
        _set_parameters(scene[section][name], rest[len(name) + 1 :], value, path)
    else:
        set_value(scene, path, value)


def set_later(path: str, scene: Mapping[str, Any]) -> bool:
    """Return True for the path of an entry that is not in a scene as written, but that a repetition or a part makes.

    Examples are ``bodies.front.left.arm.mass``, ``bodies.link3.mass`` of ``link{k}``, and ``use.axle.left.parameters.L``
    of the use ``left`` within the part of ``axle``.
    """
    section, _, rest = path.partition(".")
    used, entries = scene.get("use"), scene.get(section)
    of_parts = used if section in (*NAMED, "markers") and isinstance(used, dict) else ()
    if any(re.match(rf"{_any_number(str(name))}\.", rest) for name in of_parts):
        return True
    if section == "use":
        name = _literal(entries, rest)
        return _is_made(entries, rest) if name is None else "." in rest[len(name) + 1 :] and not _in_use(rest, name)
    if section == "parts":
        name = _literal(entries, rest)
        inside, _, below = rest[len(name or "") + 1 :].partition(".")
        definition = entries[name] if entries and name is not None else None
        return isinstance(definition, dict) and _is_made(definition.get(inside), below)
    return section in REPEATED and _is_made(entries, rest)


def with_shipped(scene: Content, changes: Sequence[tuple[str, object]]) -> Content:
    """Return a scene with a copy of each part of the package in which a change sets a value."""
    parts = scene.get("parts") or {}
    paths = (path.split(".") for path, _ in changes)
    names = {keys[1] for keys in paths if keys[0] == "parts" and len(keys) > 2 and isinstance(parts, dict)} - {*parts}
    copies = {name: copy.deepcopy(found) for name in sorted(names) if (found := shipped_part(name)) is not None}
    return {**scene, "parts": {**parts, **copies}} if copies else scene


def refuse_unused_of_parts(scene: Mapping[str, Any], changes: Sequence[tuple[str, object]]) -> None:
    """Refuse a change that adds a parameter to a part, which no other change uses. Raises InputError."""
    for path, _ in changes:
        name = _literal(scene.get("parts"), path.removeprefix("parts.")) if path.startswith("parts.") else None
        section, _, key = path[len(f"parts.{name}.") :].partition(".")
        if name is None or section != PARAMETERS or not key:
            continue
        known = _parameters_of(scene["parts"][name])
        vectors = {each for each in known if f"{each}_x" not in known}
        own = key.partition(".")[0]
        if own in known or (own[-2:] in {f"_{axis}" for axis in COMPONENTS} and own[:-2] in vectors):
            continue
        used = any(
            re.search(rf"(?<![\w.]){re.escape(own)}(?![\w.])", str(text)) for other, text in changes if other != path
        )
        if not used:
            raise InputError(
                f"--set {path}: found no such parameter of '{name}'{did_you_mean(own, known)}, expected one of "
                f"{', '.join(known) or 'none'}"
            )


@dataclass
class Later:
    """Changes of entries that a repetition or a part makes; each is set when its entry has been made."""

    changes: Sequence[tuple[str, object]] = ()
    done: set[str] = field(default_factory=set)  # paths of those that are set

    def set(
        self, place: str, entries: object, names: Collection[str] | None = None, vectors: Vectors = NO_VECTORS
    ) -> None:
        """Set the changes of entries, whose paths begin with a place such as ``bodies``.

        `names`: entries that may be set; all by default. `vectors`: those that formulas in the changes may use. Raises
        InputError if the path leads to no value.
        """
        for path, value in self.changes if isinstance(entries, dict) else ():
            rest = path.removeprefix(f"{place}.")
            name = _literal(entries, rest) if rest != path else None
            if name is not None and (names is None or name in names):
                set_value({"": entries}, f".{rest}", in_components(value, vectors), path)
                self.done.add(path)

    def set_in_use(self, place: str, entry: Any) -> None:
        """Set the changes of an entry of ``use``, whose paths begin with a place such as ``use.front.left``."""
        for path, value in self.changes if isinstance(entry, dict) else ():
            rest = path.removeprefix(f"{place}.")
            if path == place and isinstance(value, dict):
                entry.clear()
                entry.update(copy.deepcopy(value))
            elif rest == path or not ("." not in rest or _in_use(f".{rest}", "")):
                continue
            else:
                _set_parameters(entry, rest, value, path)
            self.done.add(path)

    def unused(self) -> Iterator[str]:
        """Yield the paths for which no entry was made."""
        yield from (path for path, _ in self.changes if path not in self.done)


def _set_parameters(entry: object, rest: str, value: object, path: str) -> None:
    """Set a value in an entry of ``use`` or ``parts``; of a vector parameter, also one component.

    The entry may give a vector as a list or by its components; after the change, it gives each component once.
    """
    given = entry.get(PARAMETERS) if isinstance(entry, dict) else None
    match = OF_VECTOR.fullmatch(rest)
    if match and isinstance(given, dict | None):
        vector, place, axis = match.groups()
        number = int(place) if place else COMPONENTS.find(axis) if axis else None
        as_list = (given or {}).get(vector)
        if number is None:
            for each in COMPONENTS:
                if isinstance(value, list):
                    (given or {}).pop(f"{vector}_{each}", None)
        elif isinstance(as_list, list):
            rest = f"{PARAMETERS}.{vector}.{number}"
        elif number < len(COMPONENTS):
            rest = f"{PARAMETERS}.{vector}_{COMPONENTS[number]}"
    set_value({"": entry}, f".{rest}", value, path)


def _in_use(rest: str, name: str) -> bool:
    """Return True if the key after a name in a path is one of an entry of ``use``, which has no name of a nested part."""
    return rest[len(name) + 1 :].partition(".")[0] in KEYS_OF_USE


def _parameters_of(definition: object) -> list[str]:
    """Return the names of the parameters of a definition, with those of all its options."""
    if not isinstance(definition, dict):
        return []
    options = definition.get(OPTIONS)
    words = [each for each in options.values() if isinstance(each, dict)] if isinstance(options, dict) else []
    branches = [definition, *(branch for each in words for branch in each.values() if isinstance(branch, dict))]
    return [str(name) for branch in branches for name in branch.get(PARAMETERS) or ()]


def _literal(entries: object, rest: str) -> str | None:
    """Return the entry with whose name the rest of a path begins, as written; None if there is none."""
    return next((start for start, _ in beginnings(rest) if isinstance(entries, dict) and start in entries), None)


def _is_made(entries: object, rest: str) -> bool:
    """Return True if a path begins with the name of an entry that a repeated one may make."""
    if not isinstance(entries, dict) or _literal(entries, rest) is not None:
        return False
    patterns = (str(name) for name, entry in entries.items() if isinstance(entry, dict) and "for" in entry)
    return any(re.match(rf"{_any_number(name)}(\.|$)", rest) for name in patterns)


def _any_number(name: str) -> str:
    """Return a regular expression for the name of a repeated entry."""
    return r"\d+".join(re.escape(part) for part in re.split(r"\{[^{}]*\}", name))
