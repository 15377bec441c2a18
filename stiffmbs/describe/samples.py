"""An element of any class, its fields filled by their types: for compiling ahead, and for tests of all kinds."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping
from typing import Any, get_args, get_origin

from pydantic.fields import FieldInfo

from ..errors import InputError
from .element import Element, Joint
from .fields import Measured
from .formula.field import FormulaOf
from .joint_name import JointName
from .marker import MarkerReference


class Samples:
    """Makes elements for a model.

    Parameters
    ----------
    marker : callable
        The marker, or its body's name, for the k-th field that takes one.
    joints : mapping of str to Joint
        The model's, for fields that name one.

    Attributes
    ----------
    optional : bool
        Whether fields that have a default are filled too.
    """

    optional = False

    def __init__(self, marker: Callable[[int], Any], joints: Mapping[str, Joint]) -> None:
        self.marker, self.joints = marker, joints

    def number(self, mark: Measured) -> float:
        """A number within the bounds of a field."""
        return max(1.0, mark.at_least or 0.0)

    def formula(self, mark: FormulaOf, kind: type[Element]) -> str:
        """A formula that a field may hold."""
        return "1"

    def made(self, kind: type[Element], form: Mapping[str, Any], left_out: frozenset[str] = frozenset()) -> Element:
        """An element of a class.

        Parameters
        ----------
        form : mapping of str to Any
            Fields that are given.
        left_out : set of str
            Fields that are not to be filled.

        Raises
        ------
        InputError
            When no choice of joints fits the class.
        """
        fields, names, bodies = dict(form), [], itertools.count()
        for attribute, field in kind.model_fields.items():
            name, types = field.alias or attribute, list(types_in(field.annotation))
            filled = name not in form and name not in left_out and (field.is_required() or self.optional)
            if _takes_marker(types) and (filled or name in form):
                fields.setdefault(name, self.marker(next(bodies)))
            elif JointName in types and filled:
                names.append(name)
            elif attribute != "type" and filled and (value := self._value(field, kind)) is not None:
                fields[name] = value
        return self._joined(kind, fields, names)

    def _value(self, field: FieldInfo, kind: type[Element]) -> Any:
        """The value of a field of numbers or formulas; None for other types."""
        several = get_origin(field.annotation) is tuple
        count = sum(part is not Ellipsis for part in get_args(field.annotation)) if several else 1
        formulas = [mark for mark in marks_of(field) if isinstance(mark, FormulaOf)]
        numbers = [mark for mark in (marks_of(field) if several else field.metadata) if isinstance(mark, Measured)]
        if formulas:
            return (self.formula(formulas[0], kind),) * count if several else self.formula(formulas[0], kind)
        if several or numbers or field.annotation is float:
            values = tuple(self.number(numbers[0] if numbers else Measured("value")) for _ in range(count))
            return values if several else values[0]
        return None

    def _joined(self, kind: type[Element], fields: dict[str, Any], names: list[str]) -> Element:
        """An element that names joints which fit it."""
        for chosen in itertools.permutations(self.joints, len(names)):
            element = kind(**fields, **dict(zip(names, chosen, strict=True)))
            if not any(True for _ in element.validation_errors(self.joints)):
                return element
        raise InputError(f"{kind.__name__}: found no joints that it fits among {', '.join(self.joints)}")


def types_in(annotation: Any) -> Iterator[Any]:
    """A type and all types that it is made of."""
    yield annotation
    for inner in get_args(annotation):
        yield from types_in(inner)


def _takes_marker(types: list[Any]) -> bool:
    return any(isinstance(part, type) and issubclass(part, MarkerReference) for part in types)


def marks_of(field: FieldInfo) -> list[Any]:
    """The marks of a field, wherever in its type they stand."""
    inside = [mark for part in types_in(field.annotation) for mark in getattr(part, "__metadata__", ())]
    return [*field.metadata, *inside]
