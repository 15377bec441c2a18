"""Where a scene says that a part is placed, and what is set in parts from outside."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

from ...errors import InputError
from .definitions import NAMED


def placed_in_use(
    found: dict[str, Any], changes: Sequence[tuple[str, Any]]
) -> tuple[dict[str, Any], Sequence[tuple[str, Any]]]:
    """A scene, and changes of it, with the entries of ``parts`` that place a part under ``use``.

    ``parts: {front: {use: axle}}`` says the same as ``use: {front: {part: axle}}``.

    Raises
    ------
    InputError
        When a name stands in both.
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
    moved = [
        (
            f"use{path.removeprefix('parts')}" if any(path.startswith(f"parts.{name}.") for name in placing) else path,
            value,
        )
        for path, value in changes
    ]
    return {**found, "parts": left, "use": used}, moved


def as_written(message: str, parts: Any) -> str:
    """A message about an entry of ``use`` with the path at which the scene's file has it: ``parts.left`` for ``use.left``."""
    section, *names = message.partition(":")[0].split(".")
    placed = section == "use" and names and isinstance(parts, dict) and _is_placed(parts.get(names[0]))
    return f"parts{message.removeprefix('use')}" if placed else message


def _is_placed(entry: Any) -> bool:
    return isinstance(entry, dict) and isinstance(entry.get("use"), str)


def set_in_instances(path: str, used: Any) -> bool:
    """Whether a path leads to an entry of an instance, which is not written in the scene: ``bodies.front.left.arm.mass``."""
    section, _, rest = path.partition(".")
    if section not in (*NAMED, "markers") or not isinstance(used, dict):
        return False
    return any(re.match(rf"{_any_number(str(name))}\.", rest) for name in used)


def _any_number(name: str) -> str:
    """A name of a repeated entry as a regular expression."""
    return ".+?".join(re.escape(part) for part in re.split(r"\{[^{}]*\}", name))
