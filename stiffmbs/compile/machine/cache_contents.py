"""Cache contents by kind, and their removal."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from ...cache.entries import PART, SECRET, cache_directory
from ...flexible_bodies.reduced import BODY, folder_of_bodies
from ...model.files.scenes_read_before import SCENE
from ...reading.files.read_before import FILE, folder_of_files
from .cache import FOLDER, KERNEL, RECORD, ROUTINE, own_folder

KINDS = (RECORD, KERNEL, ROUTINE, FILE, SCENE, BODY)
OTHERS = "other"
_ENTRY = re.compile(rf"({'|'.join(KINDS)})-[0-9a-f]{{40}}|{re.escape(PART)}.*|[0-9a-f]{{40}}")
"""Names of entries, of partially written files, and of entries of earlier versions."""
_DIRECTORY = re.compile(rf"({FOLDER}|{folder_of_files().kind}|{folder_of_bodies().kind})-[0-9a-f]{{12}}")


@dataclass(frozen=True)
class Stored:
    """Number of entries, and their size in bytes."""

    entries: int
    size: int


def stored() -> dict[str, Stored]:
    """Return the cache contents by kind; `OTHERS` are entries unused by this version on this machine."""
    folders = (own_folder().path, folder_of_files().path, folder_of_bodies().path)
    sizes: dict[str, list[int]] = {kind: [] for kind in (*KINDS, OTHERS)}
    for path in _files():
        kind = path.name.partition("-")[0]
        own = path.parent in folders and kind in KINDS
        sizes[kind if own else OTHERS].append(_size(path))
    return {kind: Stored(len(found), sum(found)) for kind, found in sizes.items()}


def clear() -> Stored:
    """Remove all entries and their authentication secret; return the removed entries.

    Raises OSError if an entry cannot be removed.
    """
    sizes = []
    for path in list(_files()):
        sizes.append(_size(path))
        path.unlink(missing_ok=True)
    for directory in _directories():
        if not any(directory.iterdir()):
            directory.rmdir()
    if (cache_directory() / SECRET).is_file():
        (cache_directory() / SECRET).unlink(missing_ok=True)
    return Stored(len(sizes), sum(sizes))


def _files() -> Iterator[Path]:
    for directory in (cache_directory(), *_directories()):
        if directory.is_dir():
            yield from (path for path in directory.iterdir() if _ENTRY.fullmatch(path.name) and path.is_file())


def _directories() -> list[Path]:
    root = cache_directory()
    if not root.is_dir():
        return []
    return [path for path in root.iterdir() if _DIRECTORY.fullmatch(path.name) and path.is_dir()]


def _size(path: Path) -> int:
    try:
        return path.stat().st_size
    except OSError:  # removed by another process
        return 0
