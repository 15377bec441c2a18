"""Entries of the cache: written once, read only if they are undamaged and the user's own.

An entry is one file: a message authentication code, then the content. It is written to a temporary file and moved in
one step, so that a crash or a second process leaves no partial entry. The code is an HMAC (RFC 2104) with a secret of
the user. It covers the entry's name, its content, and the dependencies of its folder. An entry that is damaged,
misplaced, or made by someone else does not match, and is made again. Folders and files that others may write are
refused with a note.
"""

from __future__ import annotations

import hashlib
import hmac
import logging
import os
import secrets
import stat
import tempfile
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
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


DIRECTORY_VARIABLE = "STIFFMBS_CACHE"
PART = ".part-"
"""Prefix of the name of a file that is being written."""
SECRET = "secret"
"""File that holds the user's secret."""
SECRET_SIZE = CODE_SIZE = 32
NOWHERE = Path(os.devnull) / "nowhere"
"""Directory in which nothing can be stored."""


def cache_directory() -> Path:
    """Return the cache directory: that of STIFFMBS_CACHE, or the user's cache directory.

    A directory that others may write to is refused with a note, and the user's cache directory is used instead.
    """
    chosen = os.environ.get(DIRECTORY_VARIABLE)
    if chosen and _trusted(Path(chosen), f"{DIRECTORY_VARIABLE}: "):
        return Path(chosen)
    from platformdirs import user_cache_path

    usual = user_cache_path("stiffmbs", appauthor=False)
    return usual if _trusted(usual) else NOWHERE


def _trusted(directory: Path, prefix: str = "") -> bool:
    """Return True if the files in a directory can be trusted; else note the reason."""
    try:
        check_folder(directory)
    except NotOwnError as fault:
        _tell(f"{prefix}the cache {directory} is not used, because {fault}; expected a folder of your own (chmod go-w)")
        return False
    return True


@cache
def _tell(note: str) -> None:
    """Log a note once, by default to standard error."""
    logging.getLogger(__name__).warning("stiffmbs: note: %s", note)


@dataclass(frozen=True)
class Folder:
    """Entries with the same dependencies.

    `kind`: first word of the folder's name. `tag`: digest of the dependencies of its entries apart from their names.
    """

    kind: str
    tag: str

    @property
    def path(self) -> Path:
        """Directory of its entries."""
        return cache_directory() / f"{self.kind}-{self.tag}"

    def read(self, name: str) -> bytes | None:
        """Return the content of an entry, or None if none of this name is undamaged and the user's own."""
        directory = self.path
        if not _trusted(directory) or (secret := _secret(directory.parent)) is None:
            return None
        try:
            stored = read_own(directory / name)
        except NotOwnError as fault:
            _tell(f"the cache's entry {directory / name} is replaced, because {fault}; expected a file of your own")
            return None
        if stored is None:
            return None
        code, content = stored[:CODE_SIZE], stored[CODE_SIZE:]
        return content if hmac.compare_digest(self._code(secret, name, content), code) else None

    def write(self, name: str, content: bytes) -> None:
        """Store an entry; if the directory is not writable, nothing is stored."""
        directory = self.path
        with suppress(OSError):
            directory.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
            directory.mkdir(mode=0o700, exist_ok=True)
            secret = (_secret(directory.parent) or _new_secret(directory.parent)) if _trusted(directory) else None
            if secret is not None:
                _put(directory / name, self._code(secret, name, content) + content)

    def keep_newest(self, most: int, most_bytes: int) -> None:
        """Remove the oldest entries until half the limits remain, if their number or their bytes exceed a limit."""
        with suppress(OSError):
            found = sorted(
                (entry.stat().st_mtime_ns, entry.stat().st_size, entry.path) for entry in os.scandir(self.path)
            )
            count, size = len(found), sum(of_entry for _, of_entry, _ in found)
            if count <= most and size <= most_bytes:
                return
            for _, of_entry, path in found:
                if count <= most // 2 and size <= most_bytes // 2:
                    return
                os.unlink(path)
                count, size = count - 1, size - of_entry

    def _code(self, secret: bytes, name: str, content: bytes) -> bytes:
        return hmac.digest(secret, b"\0".join((self.tag.encode(), name.encode(), content)), "sha256")


def tag_of(*parts: str) -> str:
    """Return a short digest of the dependencies of a folder's entries."""
    return digest(*parts)[:12]


def digest(*parts: str) -> str:
    """Return a digest of some texts, which may contain arbitrary bytes of file names."""
    return hashlib.sha256("\0".join(parts).encode(errors="surrogateescape")).hexdigest()[:40]


def _secret(directory: Path) -> bytes | None:
    """Return the user's secret, or None if there is none that only the user can read."""
    try:
        found = read_own(directory / SECRET, secret=True)
    except NotOwnError as fault:
        _tell(f"the entries of the cache are replaced, because of its file {directory / SECRET} {fault}")
        return None
    return found if found is not None and len(found) == SECRET_SIZE else None


def _new_secret(directory: Path) -> bytes | None:
    """Return a new secret, or that of another process that was faster."""
    with suppress(FileNotFoundError, IsADirectoryError):
        (directory / SECRET).unlink()
    handle, part = tempfile.mkstemp(dir=directory, prefix=PART)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(secrets.token_bytes(SECRET_SIZE))
        with suppress(FileExistsError):
            os.link(part, directory / SECRET)
    finally:
        os.unlink(part)
    return _secret(directory)


def _put(path: Path, content: bytes) -> None:
    """Write a file for the user alone to a temporary place, and move it."""
    handle, part = tempfile.mkstemp(dir=path.parent, prefix=PART)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        os.replace(part, path)
    except BaseException:
        os.unlink(part)
        raise
