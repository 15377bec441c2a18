"""Files and folders that nobody but the user can have written."""

from __future__ import annotations

import os
import stat
from pathlib import Path

OTHERS_WRITE = stat.S_IWGRP | stat.S_IWOTH
OTHERS = stat.S_IRWXG | stat.S_IRWXO


class NotOwnError(Exception):
    """File or folder that another user made or could have put there; the message names the reason."""


def check_folder(path: Path) -> None:
    """Refuse a folder in which another user may replace files.

    `path`: a nonexistent one is not refused. Raises NotOwnError.
    """
    try:
        found = path.stat()
    except OSError:
        return
    if not stat.S_ISDIR(found.st_mode):
        return
    if not _mine(found):
        raise NotOwnError(f"it belongs to the user with number {found.st_uid}")
    # In a sticky folder others may add files, but not replace the owner's.
    if found.st_mode & OTHERS_WRITE and not found.st_mode & stat.S_ISVTX:
        raise NotOwnError(f"others may write to it (mode {stat.S_IMODE(found.st_mode):o})")


def read_own(path: Path, secret: bool = False) -> bytes | None:
    """Return the content of a regular file of the user; None if it does not exist or cannot be read.

    `path`: symbolic links are not followed; pipes and devices do not block. `secret`: whether to refuse files that
    others may read. Raises NotOwnError when it is not a regular file, or others may have written it.
    """
    flags = os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_CLOEXEC", 0)
    try:
        handle = os.open(path, flags)
    except OSError:
        if path.is_symlink():
            raise NotOwnError("it is a symbolic link") from None
        return None
    try:
        _check_file(os.fstat(handle), secret)
        with os.fdopen(os.dup(handle), "rb") as file:
            return file.read()
    except OSError:
        return None
    finally:
        os.close(handle)


def _check_file(found: os.stat_result, secret: bool) -> None:
    if not stat.S_ISREG(found.st_mode):
        raise NotOwnError("it is not a regular file")
    if not _mine(found):
        raise NotOwnError(f"it belongs to the user with number {found.st_uid}")
    if found.st_mode & (OTHERS if secret else OTHERS_WRITE):
        raise NotOwnError(f"others may {'read' if secret else 'write'} it (mode {stat.S_IMODE(found.st_mode):o})")


def _mine(found: os.stat_result) -> bool:
    return not hasattr(os, "geteuid") or found.st_uid == os.geteuid()
