"""Sample elements of any class, for compilation in advance and for tests of all kinds."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping
from typing import Any, get_args, get_origin

from pydantic.fields import FieldInfo

from ..errors import InputError
from ..reading.fields import Measured
from ..reading.formula.field import FormulaOf
from ..reading.joint_name import JointName
from ..reading.marker import MarkerReference
from .element import Element, Joint


class Samples:
    """Generator of sample elements for a model.

    `marker`: returns the marker, or the name of its body, for the k-th marker field. `joints`: joints of the model, for
    fields that name one. `optional`: whether fields with a default are filled, too.
    """

    optional = False

    def __init__(self, marker: Callable[[int], object], joints: Mapping[str, Joint]) -> None:
        self.marker, self.joints = marker, joints

    def number(self, mark: Measured) -> float:
        """Return a number within the bounds of a field."""
        return max(1.0, mark.at_least or 0.0)

    def formula(self, mark: FormulaOf, kind: type[Element]) -> str:
        """Return a valid formula for a field."""
        return "1"

    def made(self, kind: type[Element], form: Mapping[str, object], left_out: frozenset[str] = frozenset()) -> Element:
        """Return an element of a class.

        `form`: given fields. `left_out`: fields that are not filled. Raises InputError if no choice of joints fits the
        class.
        """
        fields = {name: value for name, value in form.items() if value is not ...}
        names, bodies = [], itertools.count()
        for attribute, field in kind.model_fields.items():
            name, types = field.alias or attribute, list(types_in(field.annotation))
            wanted = field.is_required() or self.optional or name in form
            filled = wanted and name not in fields and name not in left_out
            if _takes_marker(types) and (filled or name in fields):
                fields.setdefault(name, self.marker(next(bodies)))
            elif JointName in types and filled:
                names.append(name)
            elif attribute != "type" and filled and (value := self._value(field, kind)) is not None:
                fields[name] = value
        return self._joined(kind, fields, names)

    def _value(self, field: FieldInfo, kind: type[Element]) -> Any:
        """Return the value of a field of numbers or formulas; None for other types."""
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

    def _joined(self, kind: type[Element], fields: dict[str, object], names: list[str]) -> Element:
        for chosen in itertools.permutations(self.joints, len(names)):
            element = kind(**fields, **dict(zip(names, chosen, strict=True)))
            if not any(True for _ in element.validation_errors(self.joints)):
                return element
        raise InputError(f"{kind.__name__}: found no joints that it fits among {', '.join(self.joints)}")


def types_in(annotation: object) -> Iterator[object]:
    """Yield a type and all types that it contains."""
    yield annotation
    for inner in get_args(annotation):
        yield from types_in(inner)


def _takes_marker(types: list[object]) -> bool:
    return any(isinstance(part, type) and issubclass(part, MarkerReference) for part in types)


def marks_of(field: FieldInfo) -> list[Any]:
    """Return the markers of a field's type, at any depth."""
    inside = [mark for part in types_in(field.annotation) for mark in getattr(part, "__metadata__", ())]
    return [*field.metadata, *inside]
