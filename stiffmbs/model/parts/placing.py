"""Parts placed in the section ``parts``."""

from __future__ import annotations

from collections.abc import Sequence

from ...errors import InputError
from ...reading.files.yaml_text import Content

NAMED = ("bodies", "states", "joints", "forces", "requests")
"""Sections of a part whose names formulas and other entries can use."""


def placed_in_use(
    found: Content, changes: Sequence[tuple[str, object]]
) -> tuple[dict[str, object], Sequence[tuple[str, object]]]:
    """Return a scene and its changes, with the entries of ``parts`` that place a part moved to ``use``.

    ``parts: {front: {use: axle}}`` is equivalent to ``use: {front: {part: axle}}``. Raises InputError if a name occurs
    in both sections.
    """
    parts = found.get("parts")
    entries = parts if isinstance(parts, dict) else {}
    placing = {name: each for name, each in entries.items() if _is_placed(each)}
    if not placing:
        return found, changes
    used = dict(found.get("use") or {})
    for name, entry in placing.items():
        if name in used:
            raise InputError(f"use.{name}: found a name that stands in parts too, expected it once")
        used[name] = {"part": entry["use"], **{key: value for key, value in entry.items() if key != "use"}}
    left = {name: entry for name, entry in entries.items() if name not in placing}
    placed = tuple(f"parts.{name}." for name in placing)
    moved = [
        (f"use{path.removeprefix('parts')}" if path.startswith(placed) else path, value) for path, value in changes
    ]
    return {**found, "parts": left, "use": used}, moved


def as_written(message: str, parts: object) -> str:
    """Return a message with the path of an entry of ``use`` as in the file: ``parts.left`` for ``use.left``."""
    path = message.partition(":")[0]
    entries = parts.items() if isinstance(parts, dict) else ()
    placed = any(_is_placed(entry) and f"{path}.".startswith(f"use.{name}.") for name, entry in entries)
    return f"parts{message.removeprefix('use')}" if placed else message


def _is_placed(entry: object) -> bool:
    return isinstance(entry, dict) and isinstance(entry.get("use"), str)
