"""YAML files that were read before: their content is kept on disk, as reading it takes longer than much else of a short run.

There is one entry for a file, which a change of the file replaces.  Where there are many, those that were written first go.
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
"""How the names of the entries begin."""
LARGEST = 1_000_000
"""Characters of what is kept of a file: aliases can stand for much."""


def read_yaml_file(text: str, source: str, file: Path | None) -> Any:
    """What stands in the text of a file; see `read_yaml`.

    Parameters
    ----------
    text : str
    source : str
        What messages call it.
    file : Path or None
        Nothing is kept of a text that is of no file.
    """
    if file is None:
        return read_yaml(text, source)
    name, version = f"{FILE}-{digest(str(file.resolve()))}", digest(text)
    stored = folder_of_files().read(name)
    if stored is not None and stored.startswith(version.encode()):
        with suppress(ValueError):  # of an entry that something else has written
            return json.loads(stored[len(version) :])
    found = read_yaml(text, source)
    if _is_plain(found) and len(content := json.dumps(found)) <= LARGEST:
        keep(name, f"{version}{content}".encode())
    return found


def _is_plain(found: Any) -> bool:
    """Whether JSON gives back exactly what was found: not so for dates, sets, and names that are numbers."""
    if type(found) is dict:
        return all(type(name) is str for name in found) and all(map(_is_plain, found.values()))
    if type(found) is list:
        return all(map(_is_plain, found))
    return found is None or type(found) in (str, int, float, bool)
