"""Library: entries that come with a wheel of the package, in an archive next to its modules.

The command ``.ci/library`` of the repository makes it. Installations from source have none. Names of entries are digests of
all sources that their content follows from, so that a changed source never meets an old entry.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from zipfile import ZipFile

FILE = Path(__file__).parents[1] / "library.zip"


def read(name: str) -> bytes | None:
    """Return the content of an entry; None if the library does not have it, or cannot be read."""
    archive = _opened(FILE)
    if archive is None:
        return None
    from zipfile import BadZipFile
    from zlib import error as DamagedError

    try:
        return archive.read(name)
    except (KeyError, OSError, ValueError, RuntimeError, BadZipFile, DamagedError):
        return None


@cache
def _opened(file: Path) -> ZipFile | None:
    if not file.is_file():
        return None
    from zipfile import BadZipFile, ZipFile

    try:
        return ZipFile(file)
    except (BadZipFile, OSError):
        return None
