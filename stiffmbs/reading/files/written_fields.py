"""Fields of descriptions that a writer of another format wrote, with refusals and notes on the others."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ..fields import Described
from .quoted import listed
from .requested import Fields, unused_notes


class Recorded:
    """Stand-in for a description, which records the fields that a writer reads.

    It passes for the description: attributes, methods and ``isinstance`` are those of the original. Fields that a method
    of the description reads are not recorded; `written` records them.
    """

    def __init__(self, entry: Any, kind: str, owner: str) -> None:
        fields = type(entry).model_fields
        values = {
            name: value
            for name, field in fields.items()
            if name != "type" and (value := getattr(entry, name)) != field.get_default(call_default_factory=True)
        }
        self._entry, self._fields = entry, Fields(kind, owner, values)

    def __getattr__(self, name: str) -> Any:
        self._fields.request(name)
        return getattr(self._entry, name)

    @property
    def __class__(self) -> Any:  # isinstance and single dispatch ask for it
        return type(self._entry)

    @__class__.setter
    def __class__(self, _: object) -> None:
        raise TypeError("found an assignment of a class, expected none")


class Recording:
    """Records of everything that a writer has to write.

    A field that differs from its default and was not read is refused, unless a reason says why it may be left out with a
    note. A field that is added to a description later is therefore refused until the writer reads it.

    `left_out`: reasons why a field may be left out, by kind and name; ``*`` matches any kind or name.
    """

    def __init__(self, left_out: Mapping[str, Mapping[str, str]]) -> None:
        self._left_out = left_out
        self._entries: list[Recorded] = []

    def of(self, entry: Described, kind: str, owner: str = "") -> Any:
        """Return the stand-in of a description of a kind; `owner`: its name."""
        self._entries.append(Recorded(entry, kind, owner))
        return self._entries[-1]

    def section(self, entries: Mapping[str, Any], kind: str) -> dict[str, Any]:
        """Return the stand-ins of all entries of a section by name."""
        return {name: self.of(entry, kind, name) for name, entry in entries.items()}

    def notes(self) -> list[str]:
        """Return notes on the fields that were left out."""
        return unused_notes([entry._fields for entry in self._entries], self._left_out, "not written")

    def refused(self) -> list[tuple[str, str, str]]:
        """Return kind, owner and name of each field that is neither written nor may be left out."""
        return [
            (entry._fields.kind, entry._fields.owner, _written_name(entry, name))
            for entry in self._entries
            for name in entry._fields.unused()
            if not any(
                name in of or "*" in of
                for of in (self._left_out.get(entry._fields.kind, {}), self._left_out.get("*", {}))
            )
        ]

    def refusals(self, remedies: Mapping[str, str]) -> list[str]:
        """Return the words of a message on each refused field. `remedies`: instructions by the name of a field."""
        return [
            f"{f'{kind}.' if kind else ''}{name}{f' of {owner}' if owner else ''}"
            f"{f' ({remedies[name]})' if name in remedies else ''}"
            for kind, owner, name in self.refused()
        ]


def written(entry: Any, *names: str) -> None:
    """Record fields that a writer does not read itself, but through a method; all of them if no names are given."""
    if type(entry) is Recorded:
        entry._fields.request(*(names or entry._fields))


def unwritten(entry: Described, *names: str) -> str:
    """Return the fields of a description that differ from their defaults, except the given ones; empty if there are none."""
    recorded = Recorded(entry, "", "")
    written(recorded, *names)
    return listed(recorded._fields.unused())


def _written_name(entry: Recorded, name: str) -> str:
    return type(entry._entry).model_fields[name].alias or name
