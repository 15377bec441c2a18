"""Fields of files of other programs, with notes on the fields that are not used."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from itertools import islice
from typing import Any, TypeVar

from .quoted import listed, quoted

Value = TypeVar("Value")
MOST_FIELDS = 500
"""Largest number of fields in one note; a file that is not of its kind may have millions."""


class Fields(Mapping[str, Value]):
    """Fields of one element of a file, with a record of the requested ones.

    `kind`: kind of the element, such as ``joint`` or ``[VERTICAL]``. `owner`: name or number of the element; empty if
    the kind occurs once in a file. `values`: fields of the element in the file. `defaults`: values that have the same
    effect as a missing field.
    """

    def __init__(
        self, kind: str, owner: str, values: Mapping[str, Value], defaults: Mapping[str, object] | None = None
    ) -> None:
        self.kind, self.owner = kind, owner
        self._values, self._defaults = values, defaults or {}
        self._requested: set[str] = set()

    def __getitem__(self, name: str) -> Value:
        self._requested.add(name)
        return self._values[name]

    def __contains__(self, name: object) -> bool:
        self._requested.add(str(name))
        return name in self._values

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def has(self, name: str) -> bool:
        """Return True if the field is present, without requesting it."""
        return name in self._values

    def unrecorded(self, name: str) -> Value | None:
        """Return a field without requesting it; None if it is missing."""
        return self._values.get(name)

    def request(self, *names: str) -> None:
        """Record fields that are used without this mapping."""
        self._requested.update(names)

    def unused(self) -> list[str]:
        """Return the names of fields that were never requested and differ from their defaults."""
        return [
            name
            for name, value in self._values.items()
            if name not in self._requested and not (name in self._defaults and _same(value, self._defaults[name]))
        ]


def unused_notes(
    elements: Iterable[Fields[Any]], reasons: Mapping[str, Mapping[str, str]] | None = None, words: str = "not used"
) -> list[str]:
    """Return notes on the fields that were not requested, one for each known reason.

    `reasons`: reasons why a field has no effect, by kind and name; ``*`` matches any kind or name. `words`: what
    happened to these fields.
    """
    owners: dict[str, dict[str, list[str]]] = {}
    for element in elements:
        for name in element.unused():
            reason = _reason(reasons or {}, element.kind, name)
            owners.setdefault(reason, {}).setdefault(f"{element.kind} {name}".strip(), []).append(element.owner)
    return [
        f"{words}{f' ({reason})' if reason else ''}: {_all_listed(fields)}" for reason, fields in sorted(owners.items())
    ]


def _all_listed(fields: Mapping[str, list[str]]) -> str:
    """Return all fields with their owners; the number of further ones for a file with a great many."""
    named = [_listed(field, who) for field, who in islice(fields.items(), MOST_FIELDS)]
    return ", ".join(named) + (f" and {len(fields) - MOST_FIELDS} more" if len(fields) > MOST_FIELDS else "")


def _reason(reasons: Mapping[str, Mapping[str, str]], kind: str, name: str) -> str:
    of_kind, of_any = reasons.get(kind, {}), reasons.get("*", {})
    return next((found[key] for found in (of_kind, of_any) for key in (name, "*") if key in found), "")


def _listed(field: str, owners: list[str]) -> str:
    named = list(dict.fromkeys(owner for owner in owners if owner))
    return f"{quoted(field)} of {quoted(listed(named))}" if named else quoted(field)


def _same(value: object, default: object) -> bool:
    """Return True for two texts of the same number or word, and for equal numbers or sequences."""
    texts = [[str(part).strip().lower() for part in _parts(x)] for x in (value, default)]
    return len(texts[0]) == len(texts[1]) and all(a == b or _equal(a, b) for a, b in zip(*texts, strict=True))


def _parts(x: object) -> list[Any]:
    if isinstance(x, str):
        return x.split()
    return list(x) if hasattr(x, "__iter__") else [x]


def _equal(a: str, b: str) -> bool:
    try:
        return float(a) == float(b) or (a == b == "nan")
    except ValueError:
        return False
