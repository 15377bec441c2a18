"""What the package offers and does not load before it is used."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .describe.kinds import Kinds


def elements_of(*kinds: Kinds) -> dict[str, type[Any]]:
    """The classes of shipped elements by their names."""
    return {element.__name__: element for some in kinds for element in some.shipped.values()}


def loaded(name: str, package: str, kinds: tuple[Kinds, ...], later: Mapping[str, str]) -> Any:
    """An attribute of a module of the package that is not there yet.

    Parameters
    ----------
    name, package : str
        Of the attribute, and of the module.
    kinds : tuple of Kinds
        The elements that it offers.
    later : mapping of str to str
        The module that defines each name, beginning with a dot.

    Raises
    ------
    AttributeError
        When the module does not offer it.
    """
    if name in later:
        return getattr(import_module(later[name], __package__), name)
    elements = {} if name.startswith("_") else elements_of(*kinds)
    if name in elements:
        return elements[name]
    raise AttributeError(f"module '{package}' has no attribute '{name}'")
