"""Entries that are kept on disk: written once, read back where they are whole and the user's own.

An entry is one file: a message authentication code, then the content.  It is written beside its place and moved there in
one step, so that a crash or a second process can leave no half of it.  The code is an HMAC (RFC 2104) under a secret of the
user's.  It covers the entry's name, its content, and what all entries of its folder depend on.  An entry that is damaged,
stands in another's place, or was made by someone else does not match, and is made again.  Folders and files that others may
write are refused with a note.
"""

from __future__ import annotations

import hashlib
import hmac
import logging
import os
import secrets
import tempfile
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from .own_files import NotOwnError, check_folder, read_own

DIRECTORY_VARIABLE = "STIFFMBS_CACHE"
PART = ".part-"
"""How the name of a file begins that is still being written."""
SECRET = "secret"
"""The file that holds the user's secret."""
SECRET_SIZE = CODE_SIZE = 32
NOWHERE = Path(os.devnull) / "nowhere"
"""A directory in which nothing can be kept."""


def cache_directory() -> Path:
    """Where all entries are kept: the variable STIFFMBS_CACHE, or the user's cache directory.

    A directory that others may write to is refused with a note, and the user's cache directory serves in its place.
    """
    chosen = os.environ.get(DIRECTORY_VARIABLE)
    if chosen:
        if not (fault := _fault(Path(chosen))):
            return Path(chosen)
        _tell(
            f"{DIRECTORY_VARIABLE}: the cache {chosen} is not used, as {fault}; expected a folder of your own (chmod go-w)"
        )
    from platformdirs import user_cache_path

    usual = user_cache_path("stiffmbs", appauthor=False)
    if not (fault := _fault(usual)):
        return usual
    _tell(f"the cache {usual} is not used, as {fault}; expected a folder of your own (chmod go-w)")
    return NOWHERE


def _fault(directory: Path) -> str:
    """Why the files in a directory cannot be trusted; nothing where they can."""
    try:
        check_folder(directory)
    except NotOwnError as fault:
        return str(fault)
    return ""


@cache
def _tell(note: str) -> None:
    """Say once, on standard error where the caller has set up no logging, why something is compiled anew."""
    logging.getLogger(__name__).warning("stiffmbs: note: %s", note)


@dataclass(frozen=True)
class Folder:
    """Entries that depend on the same.

    Attributes
    ----------
    kind : str
        The first word of the folder's name.
    tag : str
        What stands for all that its entries depend on besides their names.
    """

    kind: str
    tag: str

    @property
    def path(self) -> Path:
        """Where its entries are."""
        return cache_directory() / f"{self.kind}-{self.tag}"

    def read(self, name: str) -> bytes | None:
        """The content of an entry, or None where there is none that is whole, the user's own, and of this name."""
        directory = self.path
        if (fault := _fault(directory)) or (secret := _secret(directory.parent)) is None:
            if fault:
                _tell(f"the cache {directory} is not used, as {fault}; expected a folder of your own (chmod go-w)")
            return None
        try:
            stored = read_own(directory / name)
        except NotOwnError as fault:
            _tell(f"the cache's entry {directory / name} is made anew, as {fault}; expected a file of your own")
            return None
        if stored is None:
            return None
        code, content = stored[:CODE_SIZE], stored[CODE_SIZE:]
        return content if hmac.compare_digest(self._code(secret, name, content), code) else None

    def write(self, name: str, content: bytes) -> None:
        """Keep an entry; a directory that cannot be written to costs the work once more at the next run, and nothing else."""
        directory = self.path
        with suppress(OSError):
            directory.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
            directory.mkdir(mode=0o700, exist_ok=True)
            secret = None if _fault(directory) else _secret(directory.parent) or _new_secret(directory.parent)
            if secret is not None:
                _put(directory / name, self._code(secret, name, content) + content)

    def keep_newest(self, most: int, most_bytes: int) -> None:
        """Where there are more entries, or more bytes in them, remove those that were written first until half as much is left."""
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
    """A short name for what the entries of a folder depend on."""
    return digest(*parts)[:12]


def digest(*parts: str) -> str:
    """A name for some texts, which may be names of files in any bytes."""
    return hashlib.sha256("\0".join(parts).encode(errors="surrogateescape")).hexdigest()[:40]


def _secret(directory: Path) -> bytes | None:
    """The user's secret; None where there is none that only the user can read."""
    try:
        found = read_own(directory / SECRET, secret=True)
    except NotOwnError as fault:
        _tell(f"the entries of the cache are made anew, as of its file {directory / SECRET} {fault}")
        return None
    return found if found is not None and len(found) == SECRET_SIZE else None


def _new_secret(directory: Path) -> bytes | None:
    """A new secret, or that of another process which was faster."""
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
    """Write a file beside its place, for the user alone, and move it there."""
    handle, part = tempfile.mkstemp(dir=path.parent, prefix=PART)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        os.replace(part, path)
    except BaseException:
        os.unlink(part)
        raise
