"""Numbers of elements of beams: as written, chosen by a tolerance, or changed for a comparison."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo
from pydantic_core import CoreSchema, core_schema

from ...reading.fields import Measured
from ...reading.files.quoted import written

MOST_ELEMENTS = 10_000
FIRST = 4
"""Number of elements with which the search for a tolerance begins."""
AUTOMATIC = 1e-3
"""Tolerance of ``elements: auto``, relative to the length of the beam."""
_NUMBER = Measured("number", at_least=1, at_most=MOST_ELEMENTS)
_LENGTH = Measured("length", above=0)


@dataclass(frozen=True)
class Elements:
    """Wanted number of elements of a beam."""

    number: int = FIRST  # in all, at least one in each interval between ends, corners and stations
    counts: tuple[int, ...] | None = None  # in place of `number`: for each of these intervals
    # tolerance of the positions of its nodes, m, by which analyses change the number; 0 for `AUTOMATIC`
    tolerance: float | None = None
    # names of nodes by their fraction of the length, which replace ``node1``, ``node2``
    names: Mapping[str, float] = field(default_factory=dict)


class ElementsField:
    """Marker of a field that is a number, a number for each interval, ``auto``, or ``{tolerance: 1 mm}``."""

    def read(self, found: object, info: ValidationInfo) -> Elements:
        """Return an entry of a scene; raise a ValueError if it is none of these."""
        match found:
            case Elements():
                return found
            case "auto":
                return Elements(tolerance=0.0)
            case dict():
                if [*found] != ["tolerance"]:
                    raise ValueError(f"found {written(found)}, expected a number, auto, or {{tolerance: 1 mm}}")
                return Elements(tolerance=_LENGTH.read(found["tolerance"], info))
            case list() | tuple():
                return Elements(counts=tuple(_whole(each, info) for each in found))
        return Elements(_whole(found, info))

    def __get_pydantic_core_schema__(self, source: object, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(self, schema: object, handler: GetJsonSchemaHandler) -> dict[str, object]:
        number, length = (kind.__get_pydantic_json_schema__(schema, handler) for kind in (_NUMBER, _LENGTH))
        tolerance = {"type": "object", "properties": {"tolerance": length}, "required": ["tolerance"]}
        return {"anyOf": [number, {"type": "array", "items": number}, {**tolerance, "additionalProperties": False}]}


def _whole(found: object, info: ValidationInfo) -> int:
    number = _NUMBER.read(found, info)
    if number != round(number):
        raise ValueError(f"found {number:g}, expected a whole number of elements")
    return round(number)


@dataclass(frozen=True)
class Divided:
    """Division of a beam of a scene."""

    length: float  # m
    counts: tuple[int, ...]  # elements in each interval between ends, corners and stations
    tolerance: float | None  # of the positions of its nodes, m, if the number is not fixed
    names: Mapping[str, float]  # names of its nodes, without that of the beam, and their fractions of the length

    def times(self, factor: float) -> Elements:
        """Return the elements of the same beam with more or fewer of them; nodes at the same places keep their names."""
        return Elements(counts=tuple(math.ceil(count * factor) for count in self.counts), names=self.names)


@dataclass
class Beams:
    """Beams of a scene by name, those with a tolerance, and the forces that depend on the number of elements."""

    divided: dict[str, Divided] = field(default_factory=dict)
    by_tolerance: list[str] = field(default_factory=list)
    forces: set[str] = field(default_factory=set)


_READ: ContextVar[Beams | None] = ContextVar("beams read", default=None)


@contextmanager
def beams_read() -> Iterator[Beams]:
    """Record the beams that are read in this context."""
    found = Beams()
    token = _READ.set(found)
    try:
        yield found
    finally:
        _READ.reset(token)


def record_beams(divided: Mapping[str, Divided], forces: Iterable[str]) -> None:
    """Add beams by their full names, and their elastic elements, to the open record."""
    record = _READ.get()
    if record is not None:
        record.divided |= divided
        record.by_tolerance += [name for name, beam in divided.items() if beam.tolerance is not None]
        record.forces |= set(forces)
