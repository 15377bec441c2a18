"""Files that a scene is read from: each is read here, within a limit of its size, and its digest is recorded.

A store or a cache whose entries follow from a scene depends on this record: a scene that names a file of another content is
another scene.
"""

from __future__ import annotations

import errno
import hashlib
import os
import stat
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import Any

FOLDER = "folder"
"""Key in the context of a validation: where files are looked for."""
LARGEST = 500_000_000
"""Bytes of a file that is read as a whole, and of standard input."""

Digests = dict[str, str]
"""Digests of files' contents by the files' names; empty for a file that cannot be read."""
_RECORDS: ContextVar[tuple[Digests, ...]] = ContextVar("records", default=())
_SORTS = (
    (stat.S_ISDIR, "a folder"), (stat.S_ISFIFO, "a pipe"), (stat.S_ISCHR, "a device"), (stat.S_ISBLK, "a device"),
    (stat.S_ISSOCK, "a socket"),
)  # fmt: skip


@contextmanager
def recorded() -> Iterator[Digests]:
    """Record the digests of all files that are read within; records may be nested."""
    found: Digests = {}
    token = _RECORDS.set((*_RECORDS.get(), found))
    try:
        yield found
    finally:
        _RECORDS.reset(token)


def record(digests: Mapping[str, str]) -> None:
    """Add files to the records that are open, as where a cache stands for reading them again."""
    for each in _RECORDS.get():
        each.update(digests)


def file_beside(context: Mapping[str, Any], name: str | Path) -> Path:
    """Return the file that a scene names, from the scene's folder on."""
    return Path(context.get(FOLDER) or "") / name


def content_of(path: str | Path, largest: int = LARGEST) -> bytes:
    """Read a regular file, and record its digest.

    Parameters
    ----------
    path : str or Path
        No pipe or device is waited for.
    largest : int
        Bytes from which on a file is refused.

    Raises
    ------
    OSError
        When it cannot be read, is no regular file, or is larger.
    ValueError
        For a name that no file has.
    """
    record({str(path): ""})
    handle = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    with os.fdopen(handle, "rb") as file:
        _check(os.fstat(handle), path, largest)
        content = file.read(largest + 1)
    if len(content) > largest:  # it has grown, or tells no size
        raise _too_large(path, len(content), largest)
    record({str(path): hashlib.sha256(content).hexdigest()})
    return content


def check_regular(path: str | Path) -> None:
    """Refuse what is no regular file, for readers that open it themselves.

    Raises
    ------
    OSError, ValueError
        As `content_of`.
    """
    _check(os.stat(path), path, None)


def digest_of_file(path: str | Path) -> str:
    """Return the digest of a file's content; empty where it cannot be read."""
    try:
        return hashlib.sha256(content_of(path)).hexdigest()
    except (OSError, ValueError):
        return ""


def _check(found: os.stat_result, path: str | Path, largest: int | None) -> None:
    if not stat.S_ISREG(found.st_mode):
        sort = next((name for is_sort, name in _SORTS if is_sort(found.st_mode)), "no file")
        raise OSError(errno.EINVAL, f"it is {sort}, expected a regular file", str(path))
    if largest is not None and found.st_size > largest:
        raise _too_large(path, found.st_size, largest)


def _too_large(path: str | Path, size: int, largest: int) -> OSError:
    return OSError(errno.EFBIG, f"it has {size} bytes or more, expected at most {largest}", str(path))
