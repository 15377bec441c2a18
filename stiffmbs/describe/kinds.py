"""The kinds of joints and forces that models and scenes know: those of this package, and users' own.

A user's own class is registered, or installed with its package under the entry point group `stiffmbs.elements`.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import ModuleType
from typing import Annotated, Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo
from pydantic_core import core_schema

from ..errors import InputError
from .element import Element
from .files.quoted import quoted, written
from .own_elements import REGISTRY, check_class, dimensions_of


class Kinds(Mapping[str, type[Any]]):
    """The joints, or the forces, of the plane or of space, by kind.

    Parameters
    ----------
    package : module
        Whose files hold the shipped ones.
    base : type
        `Joint` or `Force`.
    dimensions : int
        2 or 3.
    """

    def __init__(self, package: ModuleType, base: type[Element], dimensions: int) -> None:
        self.base, self.dimensions = base, dimensions
        self.shipped = _shipped(package, base)

    def own(self) -> dict[str, type[Any]]:
        """Those from outside of this package."""
        return REGISTRY.kinds(self.base, self.dimensions)

    def __getitem__(self, kind: str) -> type[Any]:
        return self.shipped[kind] if kind in self.shipped else self.own()[kind]

    def __iter__(self) -> Iterator[str]:
        yield from {**self.shipped, **self.own()}

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def fits(self, element: Element) -> bool:
        """Whether an element is one of these, or a user's own that could be registered among them."""
        return isinstance(element, self.base) and self.dimensions in dimensions_of(type(element))


def _shipped(package: ModuleType, base: type[Element]) -> dict[str, type[Any]]:
    """The element classes found in the files of a package, by kind."""
    found: dict[str, type[Any]] = {}
    for module in pkgutil.iter_modules(package.__path__):
        members = vars(importlib.import_module(f"{package.__name__}.{module.name}")).values()
        for member in members:
            named = isinstance(member, type) and issubclass(member, base) and member.kind and not _is_generic(member)
            if named and found.setdefault(member.kind, member) is not member:
                raise InputError(f"two classes of elements have the kind '{member.kind}'")
    return found


def _is_generic(element: type[Element]) -> bool:
    """Whether the class is for markers of any family, or one such with its marker: those of the plane and of space are subclasses."""
    generic = element.__pydantic_generic_metadata__
    return bool(generic["parameters"] or generic["origin"])


@dataclass(frozen=True)
class _OneOf:
    """Marks a field that takes an element of any of some kinds, told apart by its ``type``."""

    kinds: Kinds

    def read(self, found: object, info: ValidationInfo) -> Any:
        """The element that stands in the scene."""
        if isinstance(found, Element):
            if type(found) not in self.kinds.shipped.values():
                check_class(type(found))
            if self.kinds.fits(found):
                return found
        if not isinstance(found, dict):
            raise ValueError(f"found {written(found)}, expected a mapping of keys to values")
        if "type" not in found:
            raise ValueError("found no 'type', expected one that the schema lists (stiffmbs schema)")
        kind = found["type"]
        if not isinstance(kind, str) or kind not in self.kinds:
            expected = ", ".join(f"'{known}'" for known in self.kinds)
            raise ValueError(
                f"found the type '{quoted(kind)}', expected one of {expected}, or one of your own that stiffmbs.register has made known"
            )
        return self.kinds[kind].model_validate(found, context=info.context)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> Any:
        return core_schema.with_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(self, schema: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        ways = {
            kind: handler(core_schema.definitions_schema(element.__pydantic_core_schema__, []))
            for kind, element in self.kinds.items()
        }
        mapping = {kind: way["$ref"] for kind, way in ways.items()}
        return {"discriminator": {"mapping": mapping, "propertyName": "type"}, "oneOf": list(ways.values())}


def any_of(kinds: Kinds) -> Any:
    """The type of a field that takes an element of any of some kinds."""
    return Annotated[Any, _OneOf(kinds)]
