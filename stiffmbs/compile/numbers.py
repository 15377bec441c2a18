"""Other numbers for an element of a compiled system: in place, as kernels do not depend on them."""

from __future__ import annotations

from ..describe.element import Element
from ..errors import InputError
from .kind import Compilable, sorted_out
from .system import System


def write_numbers(system: System, name: str, element: Element, model: Compilable) -> None:
    """Give an element of a compiled system the numbers of a changed one.

    Parameters
    ----------
    system : System
        Its numbers are overwritten.
    name : str
        Of the element.
    element : Element
        The changed one, as it is drawn.
    model : Compilable
        That the element belongs to.

    Raises
    ------
    InputError
        When the changed element has other equations, so that the model must be compiled anew.
    """
    kind, data = sorted_out(element, model)
    group = next(group for group in system.groups if name in group.names)
    if kind != group.kind:
        raise InputError(f"{name}: found a change of its equations, expected one of its numbers alone")
    first = int(group.index[group.names.index(name), 2 * kind.n_bodies])
    numbers = data.flat()
    group.numbers[first : first + len(numbers)] = numbers
