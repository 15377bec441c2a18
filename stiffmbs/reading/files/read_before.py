"""Contents of YAML files that were read before.

Each file has one entry, which is replaced when the file changes.
"""

from __future__ import annotations

import json
from contextlib import suppress
from pathlib import Path

from ...cache import entries
from ...cache.installed import installed_version
from .yaml_text import read_yaml

FORMAT = "1"
"""Version of the entries; increase it when the reading of YAML changes."""
LARGEST = 50_000_000
"""Largest size of an entry, bytes: aliases can expand a text."""


def read_yaml_file(text: str, source: str, file: Path | None) -> object:
    """Read the text of a YAML file as `read_yaml`, or its content from the cache; without a file, nothing is cached."""
    if file is None:
        return read_yaml(text, source)
    from ... import __version__

    name = entries.name_of("file", FORMAT, __version__, installed_version("ruamel.yaml"), str(file.resolve()))
    version = entries.digest(text)
    stored = entries.read(name)
    if stored is not None and stored.startswith(version.encode()):
        with suppress(ValueError):  # an entry not written by this package
            return json.loads(stored[len(version) :])
    found = read_yaml(text, source)
    if _is_plain(found) and len(content := json.dumps(found)) <= LARGEST:
        entries.write(name, f"{version}{content}".encode())
    return found


def _is_plain(found: object) -> bool:
    """Return True if JSON preserves a value exactly, unlike dates, sets, and keys that are numbers."""
    if type(found) is dict:
        return all(type(name) is str for name in found) and all(map(_is_plain, found.values()))
    if type(found) is list:
        return all(map(_is_plain, found))
    return found is None or type(found) in (str, int, float, bool)
