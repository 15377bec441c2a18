"""Entries of a scene that are reused when it is read again with other values.

An entry is unchanged if its text is the same and uses no name whose value has changed.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ...model.scene import Scene
    from .files_read import Context

REUSED = ("bodies", "joints", "forces")
"""Sections whose validated entries can be reused."""
_NAME = re.compile(r"[^\W\d]\w*")


class Unchanged:
    """Validated entries of the first reading of a scene.

    `scene`: none before the first reading. `context`: validation context of its entries.
    """

    def __init__(self) -> None:
        self.scene: Scene | None = None
        self.context: Context = {}
        self._raw: Mapping[str, Any] = {}

    def __eq__(self, other: object) -> bool:
        """Treat all records as equal, so that the comparison of scenes ignores them."""
        return isinstance(other, Unchanged)

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[type[Unchanged], tuple[()]]:
        """Copy as an empty record, because the scene of a copy is another object."""
        return Unchanged, ()

    def keep(self, raw: Mapping[str, object], context: Context, scene: Scene) -> None:
        """Record a scene with its entries before validation; only the first call has an effect."""
        if self.scene is not None:
            return
        self.scene, self._raw, self.context = scene, raw, context

    @cached_property
    def _names(self) -> dict[tuple[str, str], frozenset[str]]:
        return {
            (section, name): names_in(entry)
            for section in (*REUSED, "variables")
            for name, entry in (self._raw.get(section) or {}).items()
        }

    def put_into(self, raw: Mapping[str, Any], context: Context) -> dict[str, object]:
        """Return the entries of another reading, with unchanged ones in validated form."""
        scene = self.scene
        if scene is None or context["names"] != self.context["names"] or raw.get("dimensions") != self._raw.get("dimensions"):  # fmt: skip
            return dict(raw)
        changed = self._changed_names(raw, context)
        found = dict(raw)
        for section in REUSED:
            if isinstance(raw.get(section), dict):
                found[section] = {
                    name: getattr(scene, section)[name] if self._same(section, name, entry, changed) else entry
                    for name, entry in raw[section].items()
                }
        return found

    def _same(self, section: str, name: str, entry: object, changed: set[str]) -> bool:
        names = self._names.get((section, name))
        if names is None or names & changed:
            return False
        before = self._raw[section][name]
        return isinstance(entry, dict) and bool(entry == before)

    def _changed_names(self, raw: Mapping[str, Any], context: Context) -> set[str]:
        """Return the changed parameters, tables, roads and variables, and the variables that depend on them."""
        changed: set[str] = set()
        for kind in ("parameters", "tables", "roads"):
            new, old = context[kind], self.context[kind]
            changed |= {name for name in {*new, *old} if name not in new or name not in old or new[name] != old[name]}
        new, old = (found.get("variables") or {} for found in (raw, self._raw))
        changed |= {name for name in {*new, *old} if new.get(name) != old.get(name)}
        while True:
            more = {name for name in new if name not in changed and self._names["variables", name] & changed}
            if not more:
                return changed
            changed |= more


def names_in(entry: object) -> frozenset[str]:
    """Return the words in the texts of an entry."""
    return frozenset(_names(entry))


def _names(entry: object) -> Iterator[str]:
    """Yield every word in the texts of an entry."""
    match entry:
        case str():
            yield from _NAME.findall(entry)
        case dict():
            for key, value in entry.items():
                yield from _names(key)
                yield from _names(value)
        case list() | tuple():
            for value in entry:
                yield from _names(value)
