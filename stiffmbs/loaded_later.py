"""Lazy loading of the names that the package offers."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import Any


def elements_of(kinds: str) -> dict[str, type[Any]]:
    """Return the classes of shipped elements by name.

    Parameters
    ----------
    kinds : str
        Module of the package that holds ``JOINTS`` and ``FORCES``, beginning with a dot.
    """
    found = import_module(kinds, __package__)
    return {element.__name__: element for some in (found.JOINTS, found.FORCES) for element in some.shipped.values()}


def loaded(name: str, package: str, kinds: str, later: Mapping[str, str]) -> Any:
    """Import an attribute of a module on first use.

    Parameters
    ----------
    name, package : str
        Names of the attribute and of the module.
    kinds : str
        Module with the elements that are offered (`elements_of`).
    later : mapping of str to str
        Module that defines each name, beginning with a dot; a different name in that module follows a colon.

    Raises
    ------
    AttributeError
        If the module does not offer the name.
    """
    if name in later:
        module, _, own_name = later[name].partition(":")
        return getattr(import_module(module, __package__), own_name or name)
    elements = {} if name.startswith("_") else elements_of(kinds)
    if name in elements:
        return elements[name]
    raise AttributeError(f"module '{package}' has no attribute '{name}'")
