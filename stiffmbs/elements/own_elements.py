"""User classes of joints and forces: requirements and registry."""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from typing import Any

from ..errors import InputError
from ..reading.fields import is_name
from ..reading.marker import MarkerReference
from .element import Element, Force, Joint
from .samples import types_in

GROUP = "stiffmbs.elements"
"""Entry point group of packages with elements."""


class Registry:
    """Registered classes of users; those of installed packages are loaded on first use."""

    def __init__(self) -> None:
        self._classes: dict[tuple[type, int, str], type[Element]] = {}
        self._installed_are_read = False

    def add(self, element: type[Element]) -> None:
        """Add a class; a class of the same name and module, such as of a notebook cell run again, is replaced.

        Raises InputError if the kind is taken.
        """
        for key in _keys(element):
            known = self._classes.get(key, element)
            if (known.__module__, known.__qualname__) != (element.__module__, element.__qualname__):
                raise InputError(
                    f"{element.__name__}: found the kind '{element.kind}', which {known.__module__}.{known.__qualname__} has, "
                    "expected another"
                )
        self._classes |= dict.fromkeys(_keys(element), element)

    def remove(self, element: type[Element]) -> None:
        """Remove a class."""
        for key in _keys(element):
            self._classes.pop(key, None)

    def kinds(self, base: type[Element], dimensions: int) -> dict[str, type[Element]]:
        """Return the planar or spatial joints or forces by kind."""
        if not self._installed_are_read:
            for element in _installed():
                register(element)
            self._installed_are_read = True
        return {
            kind: found for (sort, space, kind), found in self._classes.items() if (sort, space) == (base, dimensions)
        }


REGISTRY = Registry()
"""Registry of this process."""


def register(element: type[Element]) -> type[Element]:
    """Register a class of joints or forces for scenes under its `kind`; usable as a decorator.

    Models built in Python accept elements of unregistered classes, too.

    Parameters
    ----------
    element : type
        Subclass of `stiffmbs.Joint` or `stiffmbs.Force`.

    Returns
    -------
    type
        The same class.

    Raises
    ------
    InputError
        If the class is incomplete, or its kind is taken; the message names the class.

    Examples
    --------
    >>> import stiffmbs
    >>> @stiffmbs.register
    ... class Level(stiffmbs.Joint):
    ...     kind = "level"
    ...     equations = ("height",)
    ...     i: stiffmbs.Marker
    ...
    ...     @staticmethod
    ...     def position(e):
    ...         return [e.i.point[1]]
    """
    check_class(element)
    for dimensions in dimensions_of(element):
        if element.kind in kinds_of(dimensions, _base(element)).shipped:
            raise InputError(
                f"{element.__name__}: found the kind '{element.kind}', which stiffmbs has, expected another"
            )
    REGISTRY.add(element)
    return element


def check_class(element: object) -> None:
    """Refuse a class that is not a joint or force, or is incomplete.

    Raises InputError: the message names the class.
    """
    for reason in _lacks(element):
        raise InputError(f"{getattr(element, '__name__', repr(element))}: {reason}")


def _lacks(element: object) -> Iterator[str]:
    if not isinstance(element, type) or not issubclass(element, Joint | Force):
        yield "found no subclass of Joint or Force, expected one"
        return
    if not is_name(element.kind):
        found = f"the kind '{element.kind}'" if element.kind else "no kind"
        yield f"found {found}, expected a name for scenes, such as kind = 'my_{_base(element).__name__.lower()}'"
    if not dimensions_of(element):
        yield "found planar and spatial markers, expected either"
    yield from _not_static(element)
    if issubclass(element, Joint):
        if element.position is Joint.position and element.velocity is Joint.velocity:
            yield "found no equations, expected a static method position(e) or velocity(e)"
        if not element.equations and element.equation_names is Joint.equation_names:
            yield "found no names of equations, expected one for each, such as equations = ('x', 'y')"
        for name in element.coordinates:
            if not hasattr(element, name):
                yield f"found the coordinate '{name}' without a function, expected a static method {name}(e)"
    elif element.efforts is Force.efforts and all(_is_inherited(element, law) for law in ("powers", "compiled_terms")):
        yield "found no law, expected a static method efforts(e) or powers(e)"


STATIC = ("position", "velocity", "point", "loads", "efforts", "powers", "potential", "event_functions", "limits")
"""Functions whose only argument is e."""


def _not_static(element: type[Element]) -> Iterator[str]:
    """Yield functions defined as instance methods; equations are derived without an instance."""
    for name in STATIC:
        found = inspect.getattr_static(element, name, None)
        if inspect.isfunction(found) and len(inspect.signature(found).parameters) != 1:
            yield f"found {name}{inspect.signature(found)}, expected a static method {name}(e)"


def _is_inherited(element: type[Element], name: str) -> bool:
    return all(name not in vars(owner) for owner in element.__mro__ if owner is not Force)


def dimensions_of(element: type[Element]) -> tuple[int, ...]:
    """Return the dimensions of the models of a class, 2 for the plane and 3 for space: those of its markers."""
    if element.dimensions:
        return element.dimensions
    found = {
        part.dimensions
        for field in element.model_fields.values()
        for part in types_in(field.annotation)
        if isinstance(part, type) and issubclass(part, MarkerReference)
    } - {None}
    return tuple(family for family in (2, 3) if found <= {family})


def _keys(element: type[Element]) -> list[tuple[type, int, str]]:
    return [(_base(element), dimensions, element.kind) for dimensions in dimensions_of(element)]


def _base(element: type[Element]) -> type[Element]:
    return Joint if issubclass(element, Joint) else Force


def kinds_of(dimensions: int, base: type[Element]) -> Any:
    """Return the planar or spatial joints or forces (`base`) by kind."""
    from importlib import import_module

    kinds = import_module(".planar_kinds" if dimensions == 2 else ".spatial.spatial_kinds", __package__)
    return kinds.JOINTS if base is Joint else kinds.FORCES


def _installed() -> Iterator[type[Element]]:
    from importlib.metadata import entry_points

    for point in entry_points(group=GROUP):
        try:
            yield point.load()
        except Exception as error:
            raise InputError(
                f"found the entry point '{point.name} = {point.value}' of {GROUP}, which does not load "
                f"({type(error).__name__}: {error}), expected a class of joints or forces"
            ) from error
