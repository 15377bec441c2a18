"""Names of files in the entries of scenes: those of an included file start from its folder."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

PLACES = (
    ("bodies", "*", "mesh"),
    ("bodies", "*", "matrices"),
    *(("bodies", "*", "matrices", key) for key in ("stiffness", "mass", "nodes", "rows")),
    ("bodies", "*", "geometry", "file"),
    ("bodies", "*", "geometry", "*", "file"),
    ("forces", "*", "properties"),
    ("forces", "*", "road", "file"),
    ("roads", "*", "file"),
)
"""Paths of the names of files in a scene; a star is any name, or any place in a list."""
SECTIONS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {"parts": ("*",), "options": ("*", "*"), "stages": ("*", "change")}
)
"""Paths of further sections, in the sections that have them."""


def from_folder(found: Any, folder: Path) -> Any:
    """Return the sections of a file with names of files that start from another folder, from which its own has this path.

    The sections are not modified, because YAML aliases may share them.
    """
    if folder == Path() or not isinstance(found, dict):
        return found

    def moved(name: object) -> object:
        """Return the name of a file from the other folder; Python objects and mappings as they are."""
        return (folder / name).as_posix() if isinstance(name, str) else name

    for path in PLACES:
        found = _replaced(found, path, moved)
    for section, path in SECTIONS.items():
        found = _replaced(found, (section, *path), lambda inner: from_folder(inner, folder))
    return found


def _replaced(found: Any, path: tuple[str, ...], change: Callable[[Any], object]) -> Any:
    """Return content with the values at a path changed."""
    if not path:
        return change(found)
    first, *rest = path
    inner = tuple(rest)
    if isinstance(found, list) and first == "*":
        return [_replaced(part, inner, change) for part in found]
    if isinstance(found, dict):
        return {key: _replaced(part, inner, change) if first in (key, "*") else part for key, part in found.items()}
    return found
