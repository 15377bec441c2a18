"""Kinds of joints and forces, of this package and of users.

User classes are registered, or installed with a package under the entry point group `stiffmbs.elements`.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable, Iterator, Mapping
from functools import cached_property
from pathlib import Path
from types import ModuleType
from typing import Annotated, Any

from ..errors import InputError
from .element import Element
from .own_elements import REGISTRY, check_class, dimensions_of
from .read_by import Context, JsonSchema, ReadBy, class_of


class Kinds(Mapping[str, type[Any]]):
    """Planar or spatial joints or forces by kind; files of the package are imported on demand.

    `package`: package that contains the shipped kinds. `base`: `Joint` or `Force`. `dimensions`: 2 or 3.
    """

    def __init__(self, package: ModuleType, base: type[Element], dimensions: int) -> None:
        self.base, self.dimensions, self._package = base, dimensions, package.__name__
        self._folder = Path(package.__path__[0])
        self._files = [module.name for module in pkgutil.iter_modules(package.__path__)]
        self._loaded: dict[str, dict[str, type[Any]]] = {}

    @cached_property
    def shipped(self) -> dict[str, type[Any]]:
        """Kinds of this package. Raises InputError if two classes have the same kind."""
        found: dict[str, type[Any]] = {}
        for file in self._files:
            for kind, element in self._in_file(file).items():
                if found.setdefault(kind, element) is not element:
                    raise InputError(f"two classes of elements have the kind '{kind}'")
        return found

    def _in_file(self, file: str) -> dict[str, type[Any]]:
        """Return the element classes in the namespace of a file, by kind."""
        if file not in self._loaded:
            members = vars(importlib.import_module(f"{self._package}.{file}")).values()
            self._loaded[file] = {member.kind: member for member in members if self._is_kind(member)}
        return self._loaded[file]

    def _is_kind(self, member: object) -> bool:
        return (
            isinstance(member, type) and issubclass(member, self.base) and bool(member.kind) and not _is_generic(member)
        )

    def is_shipped(self, element: type[Element]) -> bool:
        """Return True for a class that is defined in this package."""
        return element.__module__.startswith(f"{self._package}.")

    def own(self) -> dict[str, type[Any]]:
        """Return the kinds of users and other packages."""
        return REGISTRY.kinds(self.base, self.dimensions)

    def __getitem__(self, kind: str) -> type[Any]:
        for file in self._likely_first(kind):
            if kind in self._in_file(file):
                return self._in_file(file)[kind]
        return self.own()[kind]

    def _likely_first(self, kind: str) -> Iterator[str]:
        """Yield all files: imported ones, the one named as the kind, those that contain its name, others."""
        yield from tuple(self._loaded)
        if kind in self._files:
            yield kind
        yield from sorted(self._files, key=lambda file: self._search_rank(file, kind))

    def _search_rank(self, file: str, kind: str) -> int:
        """Return 0 for a file that contains the kind's name in quotes, 1 without quotes, 2 for other files."""
        try:
            text = (self._folder / f"{file}.py").read_text(encoding="utf-8")
        except OSError:  # installed without source
            return 0
        return next((k for k, name in enumerate((f'"{kind}"', kind)) if name in text), 2)

    def __iter__(self) -> Iterator[str]:
        yield from {**self.shipped, **self.own()}

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def fits(self, element: Element) -> bool:
        """Return True if an element is one of these kinds, or a user element of this category."""
        return isinstance(element, self.base) and self.dimensions in dimensions_of(type(element))


def _is_generic(element: type[Element]) -> bool:
    """Return True for a generic class of any markers, or one with its marker; only subclasses are kinds."""
    generic = element.__pydantic_generic_metadata__
    return bool(generic["parameters"] or generic["origin"])


def any_of(kinds: Kinds) -> Any:
    """Return the type of a field that takes an element of some kinds, selected by its ``type``."""

    def read(found: object, context: Context) -> object:
        """Return the element of a mapping, validated by the class of its ``type``."""
        if isinstance(found, Element):
            if not kinds.is_shipped(type(found)):
                check_class(type(found))
            if kinds.fits(found):
                return found
        kind = class_of(found, kinds, more=", or a class registered with stiffmbs.register")
        return kind.model_validate(found, context=context)

    def schema(schema_of: Callable[[type[Element]], JsonSchema]) -> JsonSchema:
        """Return the schema of any of the kinds, discriminated by ``type``."""
        schemas = {kind: schema_of(element) for kind, element in kinds.items()}
        mapping = {kind: each["$ref"] for kind, each in schemas.items()}
        return {"discriminator": {"mapping": mapping, "propertyName": "type"}, "oneOf": list(schemas.values())}

    return Annotated[Any, ReadBy(read, schema)]
