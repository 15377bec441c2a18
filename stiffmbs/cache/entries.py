"""Memo on disk: what was derived, compiled, read or found before, by name.

An entry is one file: a message authentication code, then the content. Its name is that of its kind and a digest of what the
content follows from: sources, versions of packages, and the processor, where they matter (`name_of`). An entry of another
version or machine is thus never read; it is removed when it is long unused (`stiffmbs.cache.contents.tend`).

An entry is written to a temporary file and moved in one step, so that a crash or a second process leaves no partial entry.
The code is an HMAC (RFC 2104) with a secret of the user. It covers the entry's name and its content. An entry that is
damaged, misplaced, or made by someone else does not match, and is made again. Folders and files that others may write are
refused with a note.
"""

from __future__ import annotations

import hashlib
import hmac
import logging
import os
from contextlib import suppress
from functools import cache
from pathlib import Path

from .contents import ENTRIES, PART, SECRET, Kind, mark_used, tend
from .ownership import NotOwnError, check_folder, read_own

DIRECTORY_VARIABLE = "STIFFMBS_CACHE"
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


def name_of(kind: Kind, *parts: str) -> str:
    """Return the name of an entry from all that its content follows from."""
    return f"{kind}-{digest(*parts)}"


def folder() -> Path:
    """Return the folder of the entries."""
    return cache_directory() / ENTRIES


def read(name: str) -> bytes | None:
    """Return the content of an entry, or None if none of this name is undamaged and the user's own."""
    path = folder() / name
    if not _trusted(path.parent) or (secret := _secret(path.parents[1])) is None:
        return None
    try:
        stored = read_own(path)
    except NotOwnError as fault:
        _tell(f"the cache's entry {path} is replaced, because {fault}; expected a file of your own")
        return None
    if stored is None:
        return None
    code, content = stored[:CODE_SIZE], stored[CODE_SIZE:]
    if not hmac.compare_digest(_code(secret, name, content), code):
        return None
    mark_used(path)
    return content


def write(name: str, content: bytes) -> bool:
    """Store an entry, and remove long unused ones; return False if the directory is not writable, or is full."""
    place = folder()
    root = place.parent
    with suppress(OSError):
        root.mkdir(mode=0o700, parents=True, exist_ok=True)
        place.mkdir(mode=0o700, exist_ok=True)
        secret = (_secret(root) or _new_secret(root)) if _trusted(place) else None
        if secret is not None:
            tend(root)
            _put(place / name, _code(secret, name, content) + content)
            return True
    return False


def remove(name: str) -> None:
    """Remove an entry, if it exists and the directory is writable."""
    with suppress(OSError):
        (folder() / name).unlink()


def is_writable(directory: Path) -> bool:
    """Return True if entries can be stored in a cache directory, which need not exist yet."""
    there = next((place for place in (directory / ENTRIES, directory, *directory.parents) if place.exists()), directory)
    return directory != NOWHERE and there.is_dir() and os.access(there, os.W_OK)


def _code(secret: bytes, name: str, content: bytes) -> bytes:
    return hmac.digest(secret, name.encode() + b"\0" + content, "sha256")


def digest(*parts: str) -> str:
    """Return a digest of some texts, which may contain arbitrary bytes of file names."""
    return hashlib.sha256("\0".join(parts).encode(errors="surrogatepass")).hexdigest()[:40]


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
    import secrets
    import tempfile

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
    import tempfile

    handle, part = tempfile.mkstemp(dir=path.parent, prefix=PART)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        os.replace(part, path)
    except BaseException:
        os.unlink(part)
        raise
