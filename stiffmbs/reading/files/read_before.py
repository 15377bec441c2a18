"""Cache folder of file contents that were read before, and the content of YAML files in it.

Each file has one entry, which is replaced when the file changes. The oldest entries are removed beyond the limits.
"""

from __future__ import annotations

import json
from contextlib import suppress
from functools import cache
from pathlib import Path

from ...cache.entries import Folder, digest, tag_of
from ...cache.installed import installed_version
from .yaml_text import read_yaml

FORMAT = "1"
"""Version of the entries; increase it when the reading of YAML changes."""
MOST_FILES, MOST_BYTES = 1000, 50_000_000
"""Limits on the number of entries and on their total size in bytes."""
FILE = "file"
"""Prefix of the names of the entries."""


@cache
def folder_of_files() -> Folder:
    """Return the folder for this version of the package and of the YAML reader."""
    from ... import __version__

    return Folder("files", tag_of(FORMAT, __version__, installed_version("ruamel.yaml")))


def keep(name: str, content: bytes) -> None:
    """Write an entry, and remove the oldest entries beyond the limits."""
    folder_of_files().write(name, content)
    folder_of_files().keep_newest(MOST_FILES, MOST_BYTES)


def read_yaml_file(text: str, source: str, file: Path | None) -> object:
    """Read the text of a YAML file as `read_yaml`, or its content from the cache; without a file, nothing is cached."""
    if file is None:
        return read_yaml(text, source)
    name, version = f"{FILE}-{digest(str(file.resolve()))}", digest(text)
    stored = folder_of_files().read(name)
    if stored is not None and stored.startswith(version.encode()):
        with suppress(ValueError):  # an entry not written by this package
            return json.loads(stored[len(version) :])
    found = read_yaml(text, source)
    if _is_plain(found) and len(content := json.dumps(found)) <= MOST_BYTES:  # aliases can expand a text
        keep(name, f"{version}{content}".encode())
    return found


def _is_plain(found: object) -> bool:
    """Return True if JSON preserves a value exactly, unlike dates, sets, and keys that are numbers."""
    if type(found) is dict:
        return all(type(name) is str for name in found) and all(map(_is_plain, found.values()))
    if type(found) is list:
        return all(map(_is_plain, found))
    return found is None or type(found) in (str, int, float, bool)
