"""What the package offers and does not load before it is used."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import Any


def loaded(name: str, package: str, elements: Mapping[str, Any], later: Mapping[str, str]) -> Any:
    """An attribute of a module of the package that is not there yet.

    Parameters
    ----------
    name, package : str
        Of the attribute, and of the module.
    elements : mapping of str to type
    later : mapping of str to str
        The module that defines each name, beginning with a dot.

    Raises
    ------
    AttributeError
        When the module does not offer it.
    """
    if name in elements:
        return elements[name]
    if name in later:
        return getattr(import_module(later[name], __package__), name)
    raise AttributeError(f"module '{package}' has no attribute '{name}'")
