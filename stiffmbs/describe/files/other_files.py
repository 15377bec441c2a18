"""Files that are read for a scene besides its own: what it includes, and what it names by their files."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

FOLDER, ASKED = "folder", "asked"
"""Keys in the context of a validation: where files are looked for, and who is told of each before it is read."""
Asked = Callable[[Path], None]


def file_beside(context: Mapping[str, Any], name: str | Path) -> Path:
    """The file that a scene names, from the scene's folder on, which is about to be read."""
    file = Path(context.get(FOLDER) or "") / name
    asked: Asked | None = context.get(ASKED)
    if asked is not None:
        asked(file)
    return file


def digest_of_file(file: str | Path) -> str:
    """A name for what stands in a file; empty where it cannot be read."""
    try:
        return hashlib.sha256(Path(file).read_bytes()).hexdigest()
    except (OSError, ValueError):
        return ""
