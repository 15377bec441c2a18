"""Read the files of a scene, with a limit on their size, and record their digests.

Stores and caches depend on this record: a scene is different if a file that it names has different content.
"""

from __future__ import annotations

import errno
import os
import stat
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import Any, TypeAlias

FOLDER = "folder"
"""Key in the validation context: the folder of relative file names."""
LARGEST = 500_000_000
"""Largest size of a file or of standard input, bytes."""

Digests = dict[str, str]
"""Digests of file contents by file name; empty for a file that cannot be read."""
_RECORDS: ContextVar[tuple[Digests, ...]] = ContextVar("records", default=())
_SORTS = (
    (stat.S_ISDIR, "a folder"), (stat.S_ISFIFO, "a pipe"), (stat.S_ISCHR, "a device"), (stat.S_ISBLK, "a device"),
    (stat.S_ISSOCK, "a socket"),
)  # fmt: skip

Context: TypeAlias = Mapping[str, Any]
"""Context of a validation: what readers of fields need of the scene, such as its parameters, names and folder."""


@contextmanager
def recorded() -> Iterator[Digests]:
    """Record the digests of all files that are read in this context; records may be nested."""
    found: Digests = {}
    token = _RECORDS.set((*_RECORDS.get(), found))
    try:
        yield found
    finally:
        _RECORDS.reset(token)


def record(digests: Mapping[str, str]) -> None:
    """Add files to the open records, for example if a cache replaces reading them."""
    for each in _RECORDS.get():
        each.update(digests)


def file_beside(context: Context, name: str | Path) -> Path:
    """Return the path of a file that a scene names; names in included files are already seen from the folder of the scene."""
    return Path(context.get(FOLDER) or "") / name


def content_of(path: str | Path, largest: int = LARGEST) -> bytes:
    """Read a regular file of at most `largest` bytes, and record its digest; pipes and devices are refused.

    Raises OSError, ValueError if it cannot be read, is not a regular file, is larger, or has an invalid name.
    """
    record({str(path): ""})
    handle = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    with os.fdopen(handle, "rb") as file:
        _check(os.fstat(handle), path, largest)
        content = file.read(largest + 1)
    if len(content) > largest:  # the file has grown, or has no size
        raise _too_large(path, len(content), largest)
    record({str(path): _digest(content)})
    return content


def check_regular(path: str | Path) -> None:
    """Refuse anything except a regular file, for readers that open the file themselves; errors as for `content_of`."""
    _check(os.stat(path), path, None)


def digest_of_file(path: str | Path) -> str:
    """Return the digest of a file's content, or an empty string if it cannot be read."""
    try:
        return _digest(content_of(path))
    except (OSError, ValueError):
        return ""


def _digest(content: bytes) -> str:
    import hashlib  # it loads OpenSSL, which --help does not need

    return hashlib.sha256(content).hexdigest()


def _check(found: os.stat_result, path: str | Path, largest: int | None) -> None:
    if not stat.S_ISREG(found.st_mode):
        sort = next((name for is_sort, name in _SORTS if is_sort(found.st_mode)), "no file")
        raise OSError(errno.EINVAL, f"it is {sort}, expected a regular file", str(path))
    if largest is not None and found.st_size > largest:
        raise _too_large(path, found.st_size, largest)


def _too_large(path: str | Path, size: int, largest: int) -> OSError:
    return OSError(errno.EFBIG, f"it has {size} bytes or more, expected at most {largest}", str(path))
