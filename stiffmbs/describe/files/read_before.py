"""Disk cache of the content of YAML files.

Each file has one entry, which is replaced when the file changes. The oldest entries are removed beyond the limits.
"""

from __future__ import annotations

import json
from contextlib import suppress
from pathlib import Path
from typing import Any

from ...cache.entries import digest
from .folder import folder_of_files, keep
from .yaml_text import read_yaml

FILE = "file"
"""Prefix of the names of the entries."""
LARGEST = 1_000_000
"""Largest number of characters of an entry; aliases can expand a text."""


def read_yaml_file(text: str, source: str, file: Path | None) -> Any:
    """Read the text of a YAML file, or its content from the cache; see `read_yaml`.

    Parameters
    ----------
    text : str
    source : str
        Name of the text in messages.
    file : Path or None
        File of the text; without one, nothing is cached.
    """
    if file is None:
        return read_yaml(text, source)
    name, version = f"{FILE}-{digest(str(file.resolve()))}", digest(text)
    stored = folder_of_files().read(name)
    if stored is not None and stored.startswith(version.encode()):
        with suppress(ValueError):  # an entry not written by this package
            return json.loads(stored[len(version) :])
    found = read_yaml(text, source)
    if _is_plain(found) and len(content := json.dumps(found)) <= LARGEST:
        keep(name, f"{version}{content}".encode())
    return found


def _is_plain(found: Any) -> bool:
    """Return True if JSON preserves a value exactly, unlike dates, sets, and keys that are numbers."""
    if type(found) is dict:
        return all(type(name) is str for name in found) and all(map(_is_plain, found.values()))
    if type(found) is list:
        return all(map(_is_plain, found))
    return found is None or type(found) in (str, int, float, bool)
