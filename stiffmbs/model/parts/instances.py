"""Instances of parts requested by ``use``, before validation of their entries."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from ...elements.body import check_names, is_flexible, is_surface_load
from ...errors import InputError
from ...reading.fields import located, mapping
from ...reading.files.files_read import Context
from ...reading.files.quoted import quoted
from ...reading.files.yaml_text import Content
from ...reading.names import MOUNT
from ...reading.units.units import Quantity
from ..beams.entries import with_beams
from ..files.expand import repeat_entries
from .changes import REPEATED, Later
from .definitions import Definitions, definition_in_components
from .frame import Use
from .hard_points import WHEEL, check_hard_points
from .options import OPTIONS, refuse_unknown_choices, with_chosen
from .parameters import mounts_of, parameters_of
from .placing import NAMED
from .vectors import Vectors, parameters_in_components, vectors_of

MOST_NESTED = 10
"""Largest number of nested parts."""
MOST_INSTANCES = 10_000
MOST_VALUES = 1_000_000
"""Largest number of numbers, texts, lists and mappings in all instances."""


@dataclass(frozen=True)
class Instance:
    """Instance of a part."""

    name: str  # full name, such as ``front.left``
    part: str  # name of its definition
    use: Use
    # markers, bodies, joints, forces and requests as written, with repeated entries expanded
    sections: Content
    parameters: Mapping[str, Quantity]  # parameters of the scene and of the part
    outer: Instance | None = None  # enclosing instance
    inner: tuple[str, ...] = ()  # local names of nested instances
    mounts: Mapping[str, str] = field(default_factory=dict)  # further bodies that it connects to, by local name
    words: Mapping[str, str] = field(default_factory=dict)  # chosen words for it and for nested parts, by choice
    flexible: Mapping[str, Any] = field(default_factory=dict)  # descriptions of its flexible bodies by local name
    made: Mapping[str, Sequence[str]] = field(default_factory=dict)  # local names of their bodies and joints by section
    wheel: tuple[float, ...] | None = None  # centre of the wheel of a suspension in the part's frame, m
    own: frozenset[str] = frozenset()  # names of the parameters of the part
    vectors: Vectors = field(default_factory=dict)  # its vectors

    @property
    def where(self) -> str:
        """Path of its definition in the scene."""
        return f"parts.{self.part}"

    def names(self, section: str) -> Iterator[str]:
        """Yield the full names in a section."""
        yield from (f"{self.name}.{name}" for name in self._local(section))

    def local(self) -> dict[str, str]:
        """Return full names by local name."""
        named = [*self.inner, *(name for section in NAMED for name in self._local(section))]
        return {name: f"{self.name}.{name}" for name in named}

    def _local(self, section: str) -> Iterator[str]:
        yield from self.sections.get(section) or {}
        yield from self.made.get(section) or ()


@dataclass
class Instances:
    """Reader of the instances of a scene, in order from outer to inner.

    `context`: parameters, tables and folder of the scene. `later`: values set in instances from outside. `words`: choices of the scene. `dimensions`: 2 or 3.
    `names`: those of variables, states and inputs of the scene.
    """

    context: Context
    definitions: Definitions
    later: Later
    words: Mapping[str, str]
    dimensions: int
    names: Collection[str]
    values: int = 0
    found: list[Instance] = field(default_factory=list)

    def read(
        self, used: object, parameters: Mapping[str, Quantity], outer: Instance | None = None, depth: int = 0
    ) -> None:
        """Add the instances of ``use`` and all nested ones.

        Raises InputError for a part that does not exist, uses itself, or cannot be read.
        """
        where = f"{outer.where}.use" if outer else "use"
        written = mapping(used, where, "names to parts")
        for name, entry in repeat_entries(where, written, parameters).items():
            _check_name(where, name)
            full = f"{outer.name}.{name}" if outer else name
            if outer and name not in written:
                self.later.set_in_use(f"{where}.{name}", entry)
            self.later.set_in_use(f"use.{full}", entry)
            use, own = self.definitions.use(f"{where}.{name}", entry, parameters)
            above = [*_above(outer)]
            if use.part in (one.part for one in above):
                raise InputError(f"{where}.{name}: found '{use.part}', which it stands in, expected another part")
            if depth >= MOST_NESTED:
                raise InputError(f"{where}.{name}: found parts nested deeper than {MOST_NESTED}, expected fewer")
            words = {**(outer.words if outer else self.words), **own}
            self._add(full, use, words, f"{where}.{name}", parameters, outer, depth)

    def refuse_unknown_choices(self, known: Iterable[str]) -> None:
        """Refuse choices of the scene that neither it nor any part in it has."""
        of_parts = {choice for one in self.found for choice in self.definitions.choices(one.part)}
        refuse_unknown_choices(self.words, of_parts | set(known))

    def _add(
        self, name: str, use: Use, words: Content, where: str, parameters: Mapping[str, Quantity],
        outer: Instance | None, depth: int,
    ) -> None:  # fmt: skip
        if len(self.found) >= MOST_INSTANCES:
            raise InputError(f"{where}: found more than {MOST_INSTANCES} parts in their places, expected fewer")
        found = self.definitions.of(use.part)
        self._count(where, found)
        definition = with_chosen(found, words, f"parts.{use.part}.{OPTIONS}")
        for section in (*NAMED, "markers"):
            self.later.set(f"{section}.{name}", definition.get(section))
        vectors = vectors_of(definition.get("parameters"), f"parts.{use.part}.parameters")
        use = use.model_copy(
            update={"parameters": parameters_in_components(use.parameters, vectors, f"{where}.parameters")}
        )
        definition = definition_in_components(definition, vectors, f"parts.{use.part}")
        try:
            own = parameters_of(use, where, definition.get("parameters"), parameters, definition.get("limits"))
        except InputError as error:
            raise InputError(f"{error} (in {name})" if outer else str(error)) from None
        default = own
        if f"{WHEEL}_y" in use.parameters:
            default = parameters_of(
                use.model_copy(update={"parameters": {}}), where, definition["parameters"], parameters
            )
        wheel = check_hard_points(use, where, vectors, own, default)
        sections = {
            section: repeat_entries(f"parts.{use.part}.{section}", definition[section], own) if section in REPEATED else definition[section]
            for section in (*NAMED, "markers") if definition.get(section) is not None
        }  # fmt: skip
        for section, entries in sections.items():
            repeated = set(entries) - set(mapping(definition[section], section)) if isinstance(entries, dict) else set()
            self.later.set(f"parts.{use.part}.{section}", entries, repeated, vectors)
            self.later.set(f"{section}.{name}", entries, repeated, vectors)
        for each, entry in mapping(sections.get("forces") or {}, f"parts.{use.part}.forces").items():
            if is_surface_load(entry):
                raise InputError(
                    f"parts.{use.part}.forces.{each}: found a surface load in a part, expected it among the forces of the scene, "
                    f"with the name that the body has there: {name}.{quoted(str(entry.get('body')))}"
                )
        sections = with_beams(sections, own, self.names, self.dimensions, f"parts.{use.part}.", f"{name}.")
        try:
            sections, flexible, made = self._without_flexible(sections, f"parts.{use.part}.bodies", own)
        except InputError as error:
            raise InputError(f"{error} (in {name})") from None
        used = definition.get("use") or {}
        inner = tuple(repeat_entries(f"parts.{use.part}.use", used, own)) if isinstance(used, dict) else ()
        _check_sections(use.part, sections, inner, vectors)
        mounts = mounts_of(definition.get("mounts"), use, where)
        self._count(where, sections)
        names = frozenset(mapping(definition.get("parameters") or {}, f"parts.{use.part}.parameters"))
        instance = Instance(
            name, use.part, use, sections, own, outer, inner, mounts, words, flexible, made, wheel, names, vectors
        )
        self.found.append(instance)
        if used:
            self.read(used, own, instance, depth + 1)

    def _without_flexible(
        self, sections: Content, where: str, parameters: Mapping[str, Quantity]
    ) -> tuple[Content, dict[str, Any], dict[str, list[str]]]:
        """Return the sections without flexible bodies, their descriptions, and the names of their bodies and joints."""
        bodies, made = sections.get("bodies"), {"bodies": list[str](), "joints": list[str]()}
        flexible: dict[str, Any] = {}
        if not isinstance(bodies, dict) or not any(is_flexible(entry) for entry in bodies.values()):
            return sections, {}, {}
        from ..flexible import bodies_and_joints, described

        if self.dimensions != 3:
            raise InputError(f"{where}: found a flexible body, expected dimensions: 3")
        context = {**self.context, "parameters": parameters}
        for name, entry in bodies.items():
            if is_flexible(entry):
                flexible[name] = described(entry, f"{where}.{name}", context)
                own_bodies, own_joints = bodies_and_joints(name, flexible[name], context, f"{where}.{name}")
                made["bodies"] += own_bodies
                made["joints"] += own_joints
        left = {name: entry for name, entry in bodies.items() if name not in flexible}
        return {**sections, "bodies": left}, flexible, made

    def _count(self, where: str, found: object) -> None:
        self.values += _size(found, MOST_VALUES)
        if self.values > MOST_VALUES:
            raise InputError(f"{where}: found parts of more than {MOST_VALUES} values in all, expected fewer")


def _above(instance: Instance | None) -> Iterator[Instance]:
    while instance is not None:
        yield instance
        instance = instance.outer


def _check_name(where: str, name: Any) -> None:
    with located(where):
        check_names([name], "a part")
    if name.partition(".")[0] == MOUNT:
        raise InputError(f"{where}.{name}: found the name of what a part is placed on, expected another")


def _check_sections(part: str, sections: Mapping[str, object], inner: Sequence[str], vectors: Vectors) -> None:
    seen = {**dict.fromkeys(inner, "use"), **dict.fromkeys(vectors, "parameters")}
    for section, entries in sections.items():
        where = f"parts.{part}.{section}"
        for name in mapping(entries, where):
            _check_name(where, name)
            if section in NAMED and name in seen:
                raise InputError(f"{where}.{name}: found a name that {seen[name]}.{name} has too, expected another")
            if section in NAMED:
                seen[name] = section


def _size(found: object, most: int) -> int:
    """Return the number of values with aliases expanded, limited to one above `most`."""
    count, waiting = 0, [found]
    while waiting and count <= most:
        value = waiting.pop()
        count += 1
        if isinstance(value, dict):
            waiting += value.values()
        elif isinstance(value, list):
            waiting += value
    return count
