"""What the package offers and does not load before it is used."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import Any


def elements_of(model: str) -> dict[str, type[Any]]:
    """The classes of shipped elements by their names.

    Parameters
    ----------
    model : str
        The module of the package that holds the ``JOINTS`` and ``FORCES`` of models, beginning with a dot.
    """
    kinds = import_module(model, __package__)
    return {element.__name__: element for some in (kinds.JOINTS, kinds.FORCES) for element in some.shipped.values()}


def loaded(name: str, package: str, model: str, later: Mapping[str, str]) -> Any:
    """An attribute of a module of the package that is not there yet.

    Parameters
    ----------
    name, package : str
        Of the attribute, and of the module.
    model : str
        The module with the elements that it offers (`elements_of`).
    later : mapping of str to str
        The module that defines each name, beginning with a dot; behind a colon its name there, where that is another.

    Raises
    ------
    AttributeError
        When the module does not offer it.
    """
    if name in later:
        module, _, own_name = later[name].partition(":")
        return getattr(import_module(module, __package__), own_name or name)
    elements = {} if name.startswith("_") else elements_of(model)
    if name in elements:
        return elements[name]
    raise AttributeError(f"module '{package}' has no attribute '{name}'")
