"""Source files of the package on which cache entries depend, and their digests."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable, Iterator
from pathlib import Path

PYTHON = ".py"
NOT_READ = "__pycache__"


def digest_of(files: Iterable[Path]) -> str:
    """Return a digest of the contents of some files, in their order."""
    found = hashlib.sha256()
    for file in files:
        found.update(file.read_bytes() + b"\0")
    return found.hexdigest()


def python_files(folder: Path) -> list[Path]:
    """Return the modules in a folder, sorted by name."""
    return [folder / name for name in sorted(os.listdir(folder)) if name.endswith(PYTHON)]


def files_within(package: Path) -> Iterator[Path]:
    """Yield all files of a package, sorted by name."""
    for place, folders, names in os.walk(package):
        folders[:] = sorted(set(folders) - {NOT_READ})
        yield from (Path(place, name) for name in sorted(names))


def versions_within(folder: str) -> Iterator[tuple[str, int, int]]:
    """Yield the path, size and modification time of all files of a package, sorted by name within each folder."""
    with os.scandir(folder) as found:  # three times as fast as paths of `files_within`
        entries = sorted(found, key=lambda entry: entry.name)
    for entry in entries:
        if not entry.is_dir():
            state = entry.stat()
            yield entry.path, state.st_size, state.st_mtime_ns
        elif entry.name != NOT_READ:
            yield from versions_within(entry.path)


def modules_within(package: Path, folder: str) -> Iterator[Path]:
    """Yield the modules in all folders of a name within a package, and in their subfolders, sorted by name."""
    for place, folders, names in os.walk(package):
        folders[:] = sorted(set(folders) - {NOT_READ})
        if folder in place[len(str(package)) :].split(os.sep):
            yield from (Path(place, name) for name in sorted(names) if name.endswith(PYTHON))
