"""Names of files in the entries of scenes: those of an included file start from its folder."""

from __future__ import annotations

from collections.abc import Callable, Mapping
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


def with_names_of_files(found: Any, change: Callable[[str], str]) -> Any:
    """Return the sections of a file with their names of files changed; Python objects and mappings stay as they are.

    The sections are not modified, because YAML aliases may share them.
    """
    if not isinstance(found, dict):
        return found
    for path in PLACES:
        found = _replaced(found, path, lambda name: change(name) if isinstance(name, str) else name)
    for section, path in SECTIONS.items():
        found = _replaced(found, (section, *path), lambda inner: with_names_of_files(inner, change))
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
