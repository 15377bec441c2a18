"""Contents of a cache directory: entries by kind, eviction of those long unused, and removal of all."""

from __future__ import annotations

import os
import re
import time
from collections.abc import Iterable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Literal, NamedTuple, get_args

Kind = Literal["record", "kernel", "routine", "draft", "object", "file", "scene", "start", "body"]
"""Derived kinds of elements, their machine code, that of solvers, drafts of both, and both for shared libraries. Contents of YAML files, scenes, starts of runs, and reduced
flexible bodies."""
KINDS: tuple[Kind, ...] = get_args(Kind)
OTHER = "other"
ENTRIES, SECRET, TENDED, FINISHING = "entries", "secret", "tended", "finishing"
"""Names in a cache directory: folder of the entries, the user's secret, a file whose time is that of the last eviction, and one
that the process that finishes drafts locks."""
PART = ".part-"
"""Prefix of the name of a file that is being written."""
MOST_BYTES = 2_000_000_000
"""Size of all entries, bytes, beyond which the longest unused ones are removed until half of it remains."""
MOST_AGE = 90 * 86400.0
"""Time, s, after which an unused entry is removed."""
STALE = 86400.0
"""Age, s, at which an unfinished entry is removed, and the time of an entry in use is set again."""
INTERVAL = 60.0
"""Least time between two evictions, s: the scan takes some milliseconds, and a first run writes a hundred entries."""

_ENTRY = re.compile(rf"[a-z]+-[0-9a-f]{{40}}|{re.escape(PART)}.*")
_FORMER = re.compile(r"(entries|files|bodies)-[0-9a-f]{12}")
"""Folders of earlier versions, each with the entries of one version on one machine."""
_OLDEST = re.compile(rf"[0-9a-f]{{40}}|{re.escape(PART)}.*")
"""Entries of the earliest versions, and parts of a secret, in the directory itself."""


class Stored(NamedTuple):
    """Number of entries, and their size in bytes."""

    entries: int
    size: int


class _File(NamedTuple):
    used: float
    size: int
    path: str


def stored(root: Path) -> dict[str, Stored]:
    """Return the contents by kind; `OTHER` are unfinished entries and those of earlier versions in folders of their own."""
    sizes: dict[str, list[int]] = {kind: [] for kind in (*KINDS, OTHER)}
    for folder, entries in ((root, _OLDEST), *_folders(root)):
        for file in _files(folder, entries):
            kind = os.path.basename(file.path).partition("-")[0]
            sizes[kind if folder.name == ENTRIES and kind in KINDS else OTHER].append(file.size)
    return {kind: Stored(len(found), sum(found)) for kind, found in sizes.items()}


def clear(root: Path) -> Stored:
    """Remove all entries, and the secret that authenticates them; return the removed entries.

    Raises OSError if an entry cannot be removed.
    """
    folders = [(root, _OLDEST), *_folders(root)]
    found = [file for folder, entries in folders for file in _files(folder, entries)]
    for path in (*(Path(file.path) for file in found), root / TENDED, root / FINISHING, root / SECRET):
        if not path.is_dir():
            path.unlink(missing_ok=True)
    _remove_empty(folder for folder, _ in folders[1:])
    return Stored(len(found), sum(file.size for file in found))


def tend(root: Path) -> None:
    """Remove entries that are long unused, and the longest unused ones of too many bytes; once a minute at most.

    Entries of other versions are never used again, so that they go first. Several processes may do so at once.
    """
    now, tended = time.time(), root / TENDED
    with suppress(OSError):
        if 0 <= now - tended.stat().st_mtime < INTERVAL:
            return
    with suppress(OSError):
        tended.touch(mode=0o600)
    folders = _folders(root)
    found = sorted(file for folder, entries in folders for file in _files(folder, entries))
    size = sum(file.size for file in found)
    enough = MOST_BYTES / 2 if size > MOST_BYTES else size
    for file in found:
        is_part = os.path.basename(file.path).startswith(PART)  # left by a process that ended while it wrote
        if size > enough or now - file.used > (STALE if is_part else MOST_AGE):
            with suppress(OSError):
                os.unlink(file.path)
            size -= file.size
    _remove_empty(folder for folder, _ in folders if folder.name != ENTRIES)  # an entry is about to be written there


def mark_used(path: Path) -> None:
    """Set the time of an entry to now, if it was set long ago."""
    with suppress(OSError):
        if time.time() - path.stat().st_mtime > STALE:
            os.utime(path)


def _folders(root: Path) -> list[tuple[Path, re.Pattern[str]]]:
    with suppress(OSError):
        former = [entry.name for entry in os.scandir(root) if _FORMER.fullmatch(entry.name)]
        return [(root / name, _ENTRY) for name in (ENTRIES, *former)]
    return []


def _files(folder: Path, entries: re.Pattern[str]) -> Iterator[_File]:
    with suppress(OSError), os.scandir(folder) as listed:
        for entry in listed:
            if entries.fullmatch(entry.name) and entry.is_file(follow_symlinks=False):
                with suppress(OSError):  # removed by another process
                    state = entry.stat(follow_symlinks=False)
                    yield _File(state.st_mtime, state.st_size, entry.path)


def _remove_empty(folders: Iterable[Path]) -> None:
    for folder in folders:
        with suppress(OSError):  # not empty, or in use
            folder.rmdir()
